#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Walks the #include lines of daemon/ and clients/ and fails on every edge that HOUSE does not allow.

    include_edges.py edges ROOT     the walk; HOUSE has no arrow up; daemon/README.md and clients/README.md say the same
    include_edges.py rules ROOT     what else is true of every file: licence line, README
    include_edges.py table ROOT     prints the rooms and their edges as the READMEs must have them

Each finding is one line: file:line: what is wrong. Exit status 0: nothing found, 1: findings, 2: wrong use.
"""

import pathlib
import re
import sys

# The architecture. A row says what files below its path may include: rooms of ours (always also their own), and headers
# of third parties, by prefix. Rows go from the bottom of the house to its top: a row may name only rooms of rows above it,
# so that no include points up. A new edge or a new third party is a decision: it needs a line here and one in the README of
# the room saying why.
#
# Rows add up: daemon/core/log.cpp may do what daemon/core may, and more. The exception are the rooms of DIVIDED, whose
# rows with one more part are rooms of their own: daemon/device/sim is the room "device/sim". It has only its own row, and
# "device" means the files of daemon/device that belong to no such room.
DIVIDED = {"device", "fleet", "lab"}
#
#    path                        rooms                                                    third party
HOUSE = [
    ("daemon/core",              [],                                                      []),
    ("daemon/core/log.cpp",      [],                                                      ["spdlog/"]),
    ("daemon/core/utf8.cpp",     [],                                                      ["utf8cpp/"]),
    ("daemon/core/result.h",     [],                                                      ["tl/expected.hpp"]),
    ("daemon/physics",           ["core"],                                                ["Eigen/"]),
    ("daemon/sim",               ["core", "physics"],                                     []),
    ("daemon/classifier",        ["core"],                                                []),
    ("daemon/posturography",     ["core"],                                                []),
    ("daemon/pattern",           ["core", "posturography"],                               []),
    ("daemon/pattern/pattern_model.cpp", [],                                              ["nlohmann/"]),
    ("daemon/c3d",               ["core"],                                                []),
    ("daemon/events",            ["core", "posturography", "proto"],                      ["google/protobuf/"]),
    ("daemon/posturography/fourier", [],                                                  ["kissfft/"]),
    ("daemon/pipeline",          ["core", "physics", "classifier", "posturography", "pattern"], []),
    ("daemon/record",            ["core", "events", "proto"],                             ["nlohmann/"]),
    ("daemon/record/export/c3d_export", ["c3d"],                                          []),
    ("daemon/record/sha256.cpp", [],                                                      ["sodium.h"]),
    ("daemon/record/xdf",        [],                                                      ["boost/crc.hpp", "pugixml.hpp", "sodium.h"]),
    ("daemon/record/catalogue",  [],                                                      ["sodium.h", "sqlite3.h", "SQLiteCpp/"]),
    ("daemon/device",            ["core"],                                                []),
    ("daemon/device/usb",        ["core", "device"],                                      ["libusb-1.0/"]),
    ("daemon/device/bytes",      ["core"],                                                []),
    ("daemon/device/bytes/raw_mode.cpp", [],                                              ["asm/"]),
    ("daemon/device/device_entry", ["core", "device", "device/usb"],                      []),
    ("daemon/device/mcc",        ["core", "device", "device/usb", "device/device_entry"], []),
    ("daemon/device/labjack",    ["core", "device", "device/usb", "device/device_entry"], []),
    ("daemon/device/nidaqmx",    ["core", "device", "device/device_entry"],               []),
    ("daemon/device/board",      ["core", "device", "device/bytes", "device/device_entry"], []),
    ("daemon/device/board/frames.cpp", [],                                                ["boost/crc.hpp"]),
    ("daemon/device/board/frames.h", [],                                                  ["tl/expected.hpp"]),
    ("daemon/device/replay",     ["core", "record", "proto", "device", "device/device_entry"], []),
    ("daemon/device/sim",        ["core", "physics", "sim", "device", "device/device_entry"], []),
    ("daemon/device/registry",   ["core", "device/device_entry", "device/mcc", "device/labjack", "device/nidaqmx", "device/board",
                                  "device/replay", "device/sim"],                                          []),
    ("daemon/device/found_units", ["core", "device/bytes", "device/usb", "device/registry"], []),
    ("daemon/session",           ["core", "device", "device/usb", "device/registry", "device/found_units", "pipeline",
                                  "classifier", "record", "physics", "posturography", "pattern", "events", "proto"], ["google/protobuf/"]),
    ("daemon/files",             ["core", "physics", "classifier", "pattern", "pipeline"], ["toml++/"]),
    ("daemon/files/protocol_file", ["session"],                                           []),
    ("daemon/files/trunk_model_text", ["record"],                                         []),
    ("daemon/settings",          ["core", "files"],                                       []),
    ("daemon/access",            ["core", "files", "proto"],                              ["zmq.h"]),
    ("daemon/ipc",               ["core", "settings", "access", "events", "session", "record", "proto"], ["zmq.h", "zmq.hpp", "google/protobuf/"]),
    ("daemon/app",               ["core", "physics", "files", "classifier", "device", "device/usb", "device/registry",
                                  "pipeline", "record", "session", "settings", "access", "ipc", "proto"], ["toml++/", "systemd/"]),
    ("daemon/app/daemon.cpp",    [],                                                      ["zmq.hpp"]),
    ("daemon/app/main.cpp",      [],                                                      ["CLI/", "google/protobuf/"]),
    ("clients/libdts",           ["proto"],                                               ["zmq.h", "zmq.hpp", "google/protobuf/",
                                                                                           "tl/expected.hpp"]),
    ("clients/libdts/key.cpp",   [],                                                      ["toml++/"]),
    ("clients/cli",              ["core"],                                                ["CLI/", "nlohmann/"]),
    ("clients/visits",           ["session", "proto"],                                    ["nlohmann/"]),
    ("clients/report",           ["core", "physics", "classifier", "posturography", "record", "session", "proto"], ["kainjow/", "pugixml.hpp"]),
    ("clients/report/recorded_definitions", ["files"],                                    []),
    ("clients/fhir",             ["core", "posturography", "record", "session", "report", "proto"], ["nlohmann/"]),
    ("clients/fhir/resource_id.cpp", [],                                                  ["boost/uuid/"]),
    ("clients/fhir/resources.cpp", [],                                                    ["sodium.h"]),
    ("clients/ctl",              ["cli", "libdts", "proto", "report", "visits"],                   ["CLI/", "google/protobuf/"]),
    ("clients/ctl/system_facts", ["core"],                                                []),
    ("clients/ctl/doctor.cpp",   ["core"],                                                []),
    ("clients/ctl/calibrate",    ["core", "physics", "files"],                            []),
    ("clients/ctl/sessions",     ["core", "record", "report", "fhir"],                    []),
    ("clients/lab/base",         ["cli", "core", "physics", "files", "pipeline", "record"], ["CLI/"]),
    ("clients/lab/plate",        ["cli", "physics", "files", "lab/base"],         ["CLI/"]),
    ("clients/lab/cop",          ["cli", "core", "physics", "files", "lab/base"],         ["CLI/"]),
    ("clients/lab/place",        ["cli", "core", "physics", "lab/base"],                  ["CLI/", "Eigen/"]),
    ("clients/lab/force",        ["cli", "core", "physics", "files", "posturography", "c3d", "lab/base"], ["CLI/"]),
    ("clients/lab/compare",      ["cli", "core", "files", "record", "settings", "report", "lab/base", "lab/force"], ["CLI/", "Eigen/"]),
    ("clients/lab/replay",       ["cli", "core", "files", "pipeline", "record", "session", "events", "proto", "device/replay", "lab/base"], ["CLI/"]),
    ("clients/lab/simulate",     ["cli", "core", "sim", "files", "pipeline", "record", "session", "device/registry",
                                  "device/sim", "lab/base"],                              ["CLI/"]),
    ("clients/lab/sway",         ["cli", "core", "files", "posturography", "record", "session", "lab/base", "lab/force"], ["CLI/"]),
    ("clients/lab/steadiness",   ["cli", "core", "files", "posturography", "pattern", "lab/base", "lab/force", "lab/sway"], ["CLI/", "Eigen/"]),
    ("clients/lab/results",      ["cli", "core", "classifier", "record", "session", "lab/base"], ["CLI/"]),
    ("clients/lab/reach",        ["cli", "core", "physics", "sim", "files", "pipeline", "lab/base"], ["CLI/"]),
    ("clients/lab/training",     ["cli", "core", "files", "classifier", "record", "lab/base", "lab/reach"], ["CLI/", "Eigen/"]),
    ("clients/lab/training/onnx_schema.h", [],                                            ["onnx/"]),
    ("clients/lab/study",        ["cli", "core", "physics", "classifier", "lab/base", "lab/reach", "lab/training"], ["CLI/"]),
    ("clients/lab/resolution",   ["cli", "core", "lab/base", "lab/reach", "lab/training"],                ["CLI/"]),
    ("clients/lab/thesis",       ["cli", "core", "physics", "lab/base", "lab/simulate", "lab/study"],     ["CLI/"]),
    ("clients/lab",              ["cli", "lab/plate", "lab/cop", "lab/place", "lab/compare", "lab/force", "lab/replay", "lab/simulate", "lab/sway",
                                  "lab/steadiness", "lab/results", "lab/reach", "lab/training", "lab/study", "lab/resolution", "lab/thesis"], ["CLI/"]),
    ("clients/gateway",          ["core", "cli", "libdts", "proto"],                              ["boost/", "google/protobuf/", "CLI/"]),
    ("clients/gateway/gateway.cpp", [],                                                   ["systemd/"]),
    ("clients/gateway/access",   [],                                                      ["sodium.h", "nlohmann/"]),
    ("clients/gateway/subjects", ["visits"],                                              []),
    ("clients/gateway/archive",  ["record", "report", "fhir"],                            ["archive.h", "archive_entry.h"]),
    ("clients/gateway/metrics",  [],                                                      ["prometheus/"]),
    ("clients/relay",            ["core", "files", "settings", "access", "libdts", "proto"], ["zmq.h", "zmq.hpp"]),
    ("clients/relay/relay.cpp",  [],                                                      ["systemd/"]),
    ("clients/relay/main.cpp",   [],                                                      ["CLI/", "systemd/"]),
    ("clients/lsl",              ["core", "cli", "files", "settings", "libdts", "proto"], []),
    ("clients/lsl/bridge.cpp",   [],                                                      ["systemd/"]),
    ("clients/lsl/event_text.cpp", [],                                                    ["nlohmann/"]),
    ("clients/lsl/main.cpp",     [],                                                      ["google/protobuf/"]),
    ("clients/fleet/wire",       ["core", "proto"],                                       ["google/protobuf/"]),
    ("clients/fleet/wire/nkey.cpp", [],                                                   ["sodium.h"]),
    ("clients/fleet/link",       ["core", "fleet/wire"],                                  ["nlohmann/", "openssl/", "sodium.h"]),
    ("clients/fleet/database",   ["core"],                                                ["libpq-fe.h"]),
    ("clients/fleet/s3",         ["core", "files"],                                       []),
    ("clients/fleet/s3/bucket.cpp", [],                                                   ["pugixml.hpp"]),
    ("clients/fleet/s3/connection.cpp", [],                                               ["curl/"]),
    ("clients/fleet/s3/sha256.cpp", [],                                                   ["openssl/"]),
    ("clients/fleet/forward",    ["cli", "core", "files", "libdts", "proto", "record", "fleet/wire", "fleet/link"],
                                                                                          ["CLI/", "SQLiteCpp/", "sodium.h", "systemd/"]),
    ("clients/fleet/forward/event_mask.cpp", [],                                          ["google/protobuf/", "nlohmann/"]),
    ("clients/fleet/forward/store.cpp", [],                                               ["google/protobuf/"]),
    ("clients/fleet/forward/sent_bytes.cpp", [],                                          ["openssl/"]),
    ("clients/fleet/forward/forwarder.cpp", [],                                           ["malloc.h"]),
    ("clients/fleet/forward/main.cpp", [],                                                ["google/protobuf/"]),
    ("clients/fleet/worker",     ["cli", "core", "files", "session", "fleet/database", "fleet/s3"], ["CLI/", "nlohmann/", "systemd/"]),
    ("clients/fleet/worker/stored_recording", [],                                         ["sodium.h"]),
    ("clients/fleet/hub",        ["cli", "core", "files", "proto", "record", "fleet/wire", "fleet/link", "fleet/database", "fleet/s3", "fleet/worker"],
                                                                                          ["CLI/", "google/protobuf/", "systemd/"]),
    ("clients/fleet/hub/durable_file.cpp", [],                                            ["openssl/"]),
    ("clients/fleet/desk",       ["cli", "core", "files", "gateway", "proto", "fleet/wire", "fleet/link", "fleet/database"],
                                                                                          ["boost/", "CLI/", "google/protobuf/", "systemd/"]),
    ("clients/firmware",         [],                                                      ["stdint.h"]),  # avr-libc has no C++ headers
    ("clients/firmware/avr",     [],                                                      ["avr/"]),
]

# What the system offers, allowed everywhere. C headers that have a C++ name (stdint.h) are missing on purpose.
STANDARD_CPP = re.compile(r"[a-z_0-9]+")
POSIX = {
    "dirent.h", "dlfcn.h", "fcntl.h", "glob.h", "grp.h", "malloc.h", "netdb.h", "poll.h", "pthread.h", "pwd.h", "sched.h", "signal.h",
    "spawn.h", "termios.h", "unistd.h",
}
POSIX_FOLDERS = ("arpa/", "linux/", "netinet/", "sys/")

ROOTS = ("daemon", "clients")
CODE = {".h", ".hpp", ".cpp", ".cc", ".c"}
WITH_LICENCE = CODE | {".py", ".proto", ".cmake", ".sh"}
SKIPPED_FOLDERS = {"build", "dist", "node_modules", "__pycache__", ".git"}
GENERATED = "_pb2.py"  # by protoc, not committed
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


def applies(row_path, relative):
    """A row is meant for a folder, for one file, or for the files of one name (registry: registry.h, registry.cpp)."""
    name = relative.as_posix()
    return name == row_path or name.startswith(row_path + "/") or name.startswith(row_path + ".")


def is_room(row_path):
    """daemon/device and daemon/device/sim are rooms, because "device" is divided; daemon/core/log.cpp is not."""
    parts = row_path.split("/")
    return len(parts) == 2 or (len(parts) == 3 and parts[1] in DIVIDED)


def name_of_row(row_path):
    """The name of the room that a row describes or belongs to."""
    parts = row_path.split("/")
    return "/".join(parts[1:3] if len(parts) > 2 and parts[1] in DIVIDED else parts[1:2])


ROOM_PATHS = {name_of_row(path): path for path, _, _ in HOUSE if is_room(path)}

# Where an include that starts with this name leads to: "session/rig.h" to daemon, "fleet/wire/nkey.h" to clients.
FIRST_PARTS = {room.split("/")[0]: path.split("/")[0] for room, path in ROOM_PATHS.items()}


def room_of(relative):
    """daemon/device/sim/x.cpp lives in the room "device/sim", daemon/record/xdf/x.cpp in "record"."""
    within = [room for room, path in ROOM_PATHS.items() if path.count("/") == 2 and applies(path, relative)]
    if within:
        return within[0]
    is_in_unlisted_room = relative.parts[1] in DIVIDED and len(relative.parts) > 3
    return "/".join(relative.parts[1:3]) if is_in_unlisted_room else relative.parts[1]


def allowed_by_house(relative):
    own = room_of(relative)
    rooms, third_party, is_listed = {own}, [], False
    for row_path, row_rooms, row_third_party in HOUSE:
        if applies(row_path, relative) and name_of_row(row_path) == own:
            is_listed = True
            rooms.update(row_rooms)
            third_party.extend(row_third_party)
    return rooms, third_party, is_listed


def target_room(root, relative, header):
    """The room of ours that an include leads to, or None when it leads out of the house."""
    first = header.split("/")[0]
    if header.startswith(("dts/v1/", "dts/wire/", "dts/zmtp/")):
        return "proto"
    if first == "dts":
        return "libdts"
    if "/" in header and first in FIRST_PARTS:
        return room_of(pathlib.PurePosixPath(FIRST_PARTS[first]) / header)
    if (root / relative.parent / header).is_file():
        return room_of(relative.parent / header)
    return None


def edges_of_rooms():
    """Every room with the rooms that it may include, as all its rows allow, from the bottom to the top."""
    edges = {}
    for row_path, rooms, _ in HOUSE:
        own = edges.setdefault(name_of_row(row_path), [])
        own.extend(room for room in rooms if room not in own)
    return edges


def arrows_up(_root):
    """What is wrong with HOUSE itself: an edge to a room that is not below."""
    findings, below = [], {"proto"}
    for row_path, rooms, _ in HOUSE:
        findings.extend(f"HOUSE: {row_path} may not include {room}, which is not below it" for room in rooms if room not in below)
        below.add(name_of_row(row_path))
    return findings


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


def rooms_of(folder):
    return [room for room, path in ROOM_PATHS.items() if path.startswith(folder + "/")]


def edges_text(rooms):
    return ", ".join(f"`{room}`" for room in rooms) or "nothing of ours"


ROOM_ROW = re.compile(r"\| `([a-z0-9_/]+)` \| (.+) \| ([^|]+) \|$")


def faults_of_room_tables(root):
    """daemon/README.md and clients/README.md have one row for each room: | `room` | what it is for | `may`, `include` |."""
    findings, edges = [], edges_of_rooms()
    for folder in ROOTS:
        readme = root / folder / "README.md"
        told = {match.group(1): match.group(3) for match in map(ROOM_ROW.match, lines_of(readme) if readme.is_file() else []) if match}
        for room in rooms_of(folder):
            if room not in told:
                findings.append(f"{folder}/README.md:1: no row for the room `{room}`")
            elif told[room] != edges_text(edges[room]):
                findings.append(f"{folder}/README.md:1: `{room}` may include {edges_text(edges[room])}, not {told[room]}")
        findings.extend(f"{folder}/README.md:1: there is no room `{room}`" for room in told if room not in rooms_of(folder))
    return findings


def faults_of_files(root):
    findings = []
    for relative in files_below(root, (*ROOTS, "proto", "tests", "cmake", "scripts"), WITH_LICENCE):
        if not any("SPDX-License-Identifier: Apache-2.0" in line for line in lines_of(root / relative)[:2]):
            findings.append(f"{relative}:1: no SPDX-License-Identifier: Apache-2.0 at the top")
    return findings


def faults_of_readmes(root):
    rooms = sorted({pathlib.Path(*file.parts[:2]) for file in files_below(root, ROOTS, CODE) if len(file.parts) > 2})
    return [f"{room}:1: no README.md" for room in rooms if not (root / room / "README.md").is_file()]


def print_table():
    for room, rooms in edges_of_rooms().items():
        print(f"| `{room}` | ? | {edges_text(rooms)} |")


def main(arguments):
    checks = {
        "edges": [forbidden_edges, arrows_up, faults_of_room_tables],
        "rules": [faults_of_files, faults_of_readmes],
    }
    if len(arguments) == 2 and arguments[0] == "table":
        print_table()
        return 0
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
