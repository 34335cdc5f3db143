#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Walks the #include lines of daemon/ and clients/ and fails on every edge that HOUSE does not allow.

    include_edges.py edges ROOT     the walk
    include_edges.py rules ROOT     what else is true of every file: length, licence line, README

Each finding is one line: file:line: what is wrong. Exit status 0: nothing found, 1: findings, 2: wrong use.
"""

import pathlib
import re
import sys

# The architecture. A row says what files below its path may include: rooms of ours (always also their own), and headers
# of third parties, by prefix. Rows add up: daemon/device/sim may do what daemon/device may, and more. A new edge or a new
# third party is a decision: it needs a line here and one in the README of the room saying why.
#
#    path                        rooms                                                    third party
HOUSE = [
    ("daemon/core",              [],                                                      []),
    ("daemon/core/log.cpp",      [],                                                      ["spdlog/"]),
    ("daemon/core/result.h",     [],                                                      ["tl/expected.hpp"]),
    ("daemon/physics",           ["core"],                                                ["Eigen/"]),
    ("daemon/classifier",        ["core"],                                                []),
    ("daemon/posturography",     ["core"],                                                []),
    ("daemon/events",            ["core", "posturography", "proto"],                      ["google/protobuf/"]),
    ("daemon/posturography/fourier", [],                                                  ["kissfft/"]),
    ("daemon/files",             ["core", "physics", "classifier", "pipeline"],                         ["toml++/"]),
    ("daemon/files/protocol_file", ["session"],                                           []),
    ("daemon/files/trunk_model_text", ["record"],                                         []),
    ("daemon/device",            ["core"],                                                []),
    ("daemon/device/registry",   ["physics"],                                             []),
    ("daemon/device/sim",        ["physics"],                                             []),
    ("daemon/device/replay",     ["record", "proto"],                                     []),
    ("daemon/device/usb",        [],                                                      ["libusb-1.0/"]),
    ("daemon/pipeline",          ["core", "physics", "classifier", "posturography"],      []),
    ("daemon/record",            ["core", "events", "proto"],                             ["nlohmann/"]),
    ("daemon/record/sha256.cpp", [],                                                      ["sodium.h"]),
    ("daemon/record/xdf",        [],                                                      ["boost/crc.hpp", "pugixml.hpp", "sodium.h"]),
    ("daemon/record/catalogue",  [],                                                      ["sodium.h", "sqlite3.h"]),
    ("daemon/session",           ["core", "device", "pipeline", "classifier", "record",
                                  "physics", "posturography", "events", "proto"],                       ["google/protobuf/"]),
    ("daemon/access",            ["core", "files", "proto"],                              ["zmq.h", "zmq.hpp"]),
    ("daemon/ipc",               ["core", "access", "events", "session", "record", "proto"], ["zmq.h", "zmq.hpp", "google/protobuf/"]),
    ("daemon/app",               ["core", "physics", "files", "classifier", "device", "pipeline",
                                  "record", "session", "access", "ipc", "proto"],         ["toml++/", "systemd/"]),
    ("daemon/app/daemon.cpp",    [],                                                      ["zmq.hpp"]),
    ("daemon/app/sockets",       [],                                                      ["zmq.hpp"]),
    ("daemon/app/main.cpp",      [],                                                      ["CLI/", "google/protobuf/"]),
    ("clients/libdts",           ["proto"],                                               ["zmq.h", "zmq.hpp", "google/protobuf/",
                                                                                           "tl/expected.hpp"]),
    ("clients/libdts/key.cpp",   [],                                                      ["toml++/"]),
    ("clients/cli",              ["core"],                                                  ["CLI/", "nlohmann/"]),
    ("clients/ctl",              ["cli", "libdts", "proto"],                              ["CLI/", "google/protobuf/"]),
    ("clients/ctl/system_facts", ["core"],                                                []),
    ("clients/ctl/calibrate",    ["core", "physics", "files"],                            []),
    ("clients/ctl/sessions",     ["core", "record", "report"],                            []),
    ("clients/report",           ["core", "posturography", "record", "session", "proto"], ["kainjow/", "pugixml.hpp"]),
    ("clients/report/recorded_definitions", ["files"],                                    []),
    ("clients/lab",              ["cli", "core", "physics", "files", "classifier",
                                  "pipeline", "posturography", "record", "device",
                                  "session", "events", "proto"],                                            ["CLI/", "Eigen/"]),
    ("clients/lab/training/onnx_schema.h", [],                                             ["onnx/"]),
    ("clients/gateway",          ["cli", "libdts", "proto"],                              ["boost/", "google/protobuf/", "CLI/"]),
    ("clients/gateway/gateway.cpp", [],                                                    ["systemd/"]),
    ("clients/gateway/access",   [],                                                      ["sodium.h", "nlohmann/"]),
    ("clients/gateway/archive",  ["core", "record", "report"],                            ["archive.h", "archive_entry.h"]),
    ("clients/gateway/metrics",  [],                                                      ["prometheus/"]),
]

# What the system offers, allowed everywhere. C headers that have a C++ name (stdint.h) are missing on purpose.
STANDARD_CPP = re.compile(r"[a-z_0-9]+")
POSIX = {
    "dirent.h", "dlfcn.h", "fcntl.h", "glob.h", "grp.h", "netdb.h", "poll.h", "pthread.h", "pwd.h", "sched.h", "signal.h",
    "spawn.h", "termios.h", "unistd.h",
}
POSIX_FOLDERS = ("arpa/", "linux/", "netinet/", "sys/")

ROOTS = ("daemon", "clients")
CODE = {".h", ".hpp", ".cpp", ".cc", ".c"}
WITH_LICENCE = CODE | {".py", ".proto", ".cmake", ".sh"}
SKIPPED_FOLDERS = {"build", "dist", "node_modules", "__pycache__", ".git"}
GENERATED = "_pb2.py"  # by protoc, not committed
MAX_FILE_LINES = 400
MAX_README_LINES = 60
INCLUDE = re.compile(r"\s*#\s*include\b\s*(.*)")
HEADER = re.compile(r'[<"]([^>"]+)[>"]')


def files_below(root, folders, suffixes):
    """Relative paths, sorted, of the files with one of the suffixes; CMakeLists.txt counts as .cmake."""
    found = []
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            relative = path.relative_to(root)
            suffix = ".cmake" if path.name == "CMakeLists.txt" else path.suffix
            if path.name.endswith(GENERATED) or SKIPPED_FOLDERS & set(relative.parts):
                continue
            if path.is_file() and suffix in suffixes:
                found.append(relative)
    return found


def lines_of(path):
    return path.read_text(encoding="utf-8", errors="replace").splitlines()


def room_of(relative):
    """daemon/device/sim/x.cpp lives in the room "device"."""
    return relative.parts[1]


def known_rooms():
    return {path.split("/")[1] for path, _, _ in HOUSE} | {"proto"}


def applies(row_path, relative):
    """A row is meant for a folder, for one file, or for the files of one name (registry: registry.h, registry.cpp)."""
    name = relative.as_posix()
    return name == row_path or name.startswith(row_path + "/") or name.startswith(row_path + ".")


def allowed_by_house(relative):
    rooms, third_party, is_listed = {room_of(relative)}, [], False
    for row_path, row_rooms, row_third_party in HOUSE:
        if applies(row_path, relative):
            is_listed = True
            rooms.update(row_rooms)
            third_party.extend(row_third_party)
    return rooms, third_party, is_listed


def target_room(root, relative, header):
    """The room of ours that an include leads to, or None when it leads out of the house."""
    first = header.split("/")[0]
    if header.startswith(("dts/v1/", "dts/wire/")):
        return "proto"
    if first == "dts":
        return "libdts"
    if "/" in header and first in known_rooms():
        return first
    if (root / relative.parent / header).is_file():
        return room_of(relative)
    return None


def is_allowed_outside(header, third_party):
    if STANDARD_CPP.fullmatch(header) or header in POSIX or header.startswith(POSIX_FOLDERS):
        return True
    return any(header == entry or (entry.endswith("/") and header.startswith(entry)) for entry in third_party)


def fault_of_include(root, relative, text):
    """What is wrong with an include, given what stands after #include; None when nothing is."""
    match = HEADER.match(text)
    if not match:
        return "computed include: name the header"
    header = match.group(1)
    if ".." in pathlib.PurePosixPath(header).parts:
        return f"{header}: write the path from the top of daemon/ or clients/"
    rooms, third_party, is_listed = allowed_by_house(relative)
    if not is_listed:
        return f"{relative.parent} is not in the table of allowed includes"
    room = target_room(root, relative, header)
    if room is None and not is_allowed_outside(header, third_party):
        return f"{header}: third party that this file may not include"
    if room is not None and room not in rooms:
        return f"{header}: {room_of(relative)} may not include {room}, only {', '.join(sorted(rooms))}"
    return None


def forbidden_edges(root):
    findings = []
    for relative in files_below(root, ROOTS, CODE):
        if len(relative.parts) < 3:
            findings.append(f"{relative}:1: code outside of a room")
            continue
        for number, line in enumerate(lines_of(root / relative), start=1):
            match = INCLUDE.match(line)
            fault = fault_of_include(root, relative, match.group(1)) if match else None
            if fault:
                findings.append(f"{relative}:{number}: {fault}")
    return findings


def faults_of_files(root):
    findings = []
    for relative in files_below(root, (*ROOTS, "proto", "tests", "cmake", "scripts"), WITH_LICENCE):
        lines = lines_of(root / relative)
        if len(lines) > MAX_FILE_LINES:
            findings.append(f"{relative}:{MAX_FILE_LINES + 1}: {len(lines)} lines, allowed are {MAX_FILE_LINES}: split it by subject")
        if not any("SPDX-License-Identifier: Apache-2.0" in line for line in lines[:2]):
            findings.append(f"{relative}:1: no SPDX-License-Identifier: Apache-2.0 at the top")
    return findings


def faults_of_readmes(root):
    findings = []
    for room in sorted({pathlib.Path(*file.parts[:2]) for file in files_below(root, ROOTS, CODE) if len(file.parts) > 2}):
        readme = root / room / "README.md"
        if not readme.is_file():
            findings.append(f"{room}:1: no README.md")
        elif len(lines_of(readme)) > MAX_README_LINES:
            findings.append(f"{room}/README.md:{MAX_README_LINES + 1}: more than {MAX_README_LINES} lines")
    return findings


def main(arguments):
    checks = {"edges": [forbidden_edges], "rules": [faults_of_files, faults_of_readmes]}
    if len(arguments) != 2 or arguments[0] not in checks:
        print(__doc__, file=sys.stderr)
        return 2
    root = pathlib.Path(arguments[1])
    if not files_below(root, ROOTS, CODE):
        print(f"{root}: no code found below {' or '.join(ROOTS)}: nothing was checked", file=sys.stderr)
        return 2
    findings = [finding for check in checks[arguments[0]] for finding in check(root)]
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
