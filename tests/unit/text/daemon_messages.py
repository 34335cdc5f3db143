#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds messages of the daemon and the gateway that have no German in the dashboard.

    daemon_messages.py ROOT

Reads the texts of fail(...) and wrong(...) in the C++ sources below: "rig '" + name + "' is unknown" is the message
"rig '{}' is unknown". Each must be in clients/web/src/strings/de/daemon.ts. Exit status 0: nothing is missing, 1: a list of what is missing.
"""
import pathlib
import re
import sys

# What an operator can meet on the screen. Messages of other sources concern the person who sets up the machine; they stay
# English.
SOURCES = (
    "daemon/access/gate.cpp", "daemon/session/correction_request.cpp", "daemon/session/label_rule.cpp", "daemon/session/protocol.cpp",
    "daemon/session/recordings_edit.cpp", "daemon/session/recordings_erase.cpp", "daemon/session/recordings_owed.cpp",
    "daemon/session/rig_session.cpp", "daemon/session/session.cpp", "daemon/session/supervisor.cpp", "daemon/session/supervisor_devices.cpp",
    "daemon/session/subject_edit.cpp", "daemon/session/supervisor_edit.cpp", "daemon/session/supervisor_resume.cpp",
    "daemon/session/trial_run.cpp", "clients/fhir/recorded_session.cpp", "clients/gateway/archive/archive.cpp",
    "clients/gateway/archive/export_maker.cpp", "clients/gateway/archive/session_files.cpp", "clients/report/pdf.cpp",
    "daemon/record/catalogue/subject_notes.cpp",
)
CATALOGUE = "clients/web/src/strings/de/daemon.ts"
CALL = re.compile(r"\b(?:fail|wrong)\(")
ESCAPES = {"n": "\n", "t": "\t"}


def literal(text, start):
    """Returns the value of the string literal at `start`, and the index after it."""
    value = ""
    index = start + 1
    while text[index] != '"':
        if text[index] == "\\":
            index += 1
            value += ESCAPES.get(text[index], text[index])
        else:
            value += text[index]
        index += 1
    return value, index + 1


def arguments(text, start):
    """Returns the arguments of the call whose bracket opens at `start`."""
    found, depth, begin, index = [], 0, start + 1, start
    while index < len(text):
        letter = text[index]
        if letter == '"':
            index = literal(text, index)[1]
            continue
        if letter in "([{":
            depth += 1
        elif letter in ")]}":
            depth -= 1
        if (letter == "," and depth == 1) or depth == 0:
            found.append(text[begin:index])
            begin = index + 1
        if depth == 0:
            return found
        index += 1
    return found


def messages(expression):
    """Returns the messages of an expression: several if it is a condition."""
    found, message, depth, index = [], "", 0, 0
    while index < len(expression):
        letter = expression[index]
        if letter == '"' and depth == 0:
            value, index = literal(expression, index)
            message += value
            continue
        if letter == '"':
            index = literal(expression, index)[1]
            continue
        if depth == 0 and letter == "?":
            message = ""  # what was before is the condition
        elif depth == 0 and letter == ":" and expression[index - 1] != ":" and expression[index + 1:index + 2] != ":":
            found.append(message)
            message = ""
        elif letter in "([{":
            depth += 1
        elif letter in ")]}":
            depth -= 1
        elif depth == 0 and not letter.isspace() and letter != "+" and not message.endswith("{}"):
            message += "{}"
        index += 1
    return [*found, message]


def messages_of(source):
    """Returns all messages of one source."""
    text = re.sub(r"(?m)^\s*//.*$", "", source)
    all_arguments = [one for call in CALL.finditer(text) for one in arguments(text, call.end() - 1) if '"' in one]
    found = {message for one in all_arguments for message in messages(one)}
    return {message for message in found if re.search(r"[a-z]{3}", message.replace("{}", "")) and not message.startswith("dtsctl ")}


def catalogue(source):
    """Returns the English messages of the catalogue."""
    found = re.findall(r"""\[\s*('(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*"),""", source, re.MULTILINE)
    return {one[1:-1].replace("\\'", "'") for one in found}


def has_german(message, known):
    """Returns whether the catalogue has the message. An argument of it may be a fixed command or the name of a thing."""
    pattern = re.compile("".join(".+" if part == "{}" else re.escape(part) for part in re.split(r"(\{\})", message)))
    if message in known:
        return True
    whole = [one for one in known if "{}" in one and len(one.replace("{}", "")) > 8]
    shapes = [re.compile("".join("(.+)" if part == "{}" else re.escape(part) for part in re.split(r"(\{\})", one))) for one in whole]
    fixed = [shape for shape in shapes if shape.fullmatch(message)]
    return bool(fixed) or any(pattern.fullmatch(one) for one in known)


def main():
    root = pathlib.Path(sys.argv[1])
    known = catalogue((root / CATALOGUE).read_text(encoding="utf-8"))
    missing = [f"{name}: no German for: {message}"
               for name in SOURCES
               for message in sorted(messages_of((root / name).read_text(encoding="utf-8")))
               if not has_german(message, known)]
    print("\n".join(missing), end="\n" if missing else "")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
