#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds texts of the daemon and the gateway that have no German in the dashboard or in the report.

    daemon_messages.py ROOT

Reads every sentence in a string of the C++ sources below: "rig '" + name + "' is unknown" is the message "rig '{}' is unknown". What goes to a log only
is left out. Translates each with the catalogue as the dashboard does. Exit status 0: no English is left, 1: a list of the messages that have no German.
"""
import errno
import os
import pathlib
import re
import sys

# Rooms whose texts an operator can meet on a page: answers to commands, states of devices, recordings and sessions, notices.
ROOMS = (
    "clients/fhir/recorded_session.cpp", "clients/fleet/desk", "clients/fleet/forward/viewers.cpp", "clients/gateway",
    "clients/libdts/control_client.cpp", "clients/libdts/endpoints.cpp", "clients/report/pdf.cpp", "clients/report/report.cpp",
    "clients/report/session_data.cpp", "clients/report/transient_trace.cpp", "clients/report/watched_recording.cpp",
    "daemon/access/gate.cpp", "daemon/app/daemon.cpp", "daemon/app/plate_check.cpp", "daemon/core/loss_watch.cpp", "daemon/core/thread.cpp",
    "daemon/device", "daemon/ipc", "daemon/posturography/prepare.cpp", "daemon/record/catalogue", "daemon/record/overview.cpp",
    "daemon/record/recorder.cpp", "daemon/record/replace_file.cpp", "daemon/record/xdf", "daemon/session",
)
# Files of these rooms that stay English, with the reason.
EXCEPTIONS = {
    "dtsd, dts-gateway or dts-fleet-gateway does not start with such a mistake in its configuration": (
        "clients/fleet/desk/program.cpp", "clients/fleet/desk/serve.cpp",
        "clients/gateway/config_file.cpp", "clients/gateway/gateway.cpp", "clients/gateway/http/server.cpp", "clients/gateway/http/static_files.cpp",
        "clients/gateway/http/tls_context.cpp", "clients/gateway/options.cpp", "clients/gateway/program.cpp", "daemon/device/*/*_options.*",
        "daemon/device/*/*/*_options.*", "daemon/device/*/command_line.cpp", "daemon/device/*/entries.cpp", "daemon/device/*/uri_choices.cpp",
        "daemon/device/*/usb1608g_setup.cpp", "daemon/device/device_uri.cpp", "daemon/device/program_rights.cpp", "daemon/device/registry.cpp",
        "daemon/device/sim/*/*", "daemon/device/sim/[!s]*", "daemon/device/sim/s[!i]*", "daemon/device/uri_options.cpp",
        "daemon/ipc/control_socket.cpp", "daemon/ipc/endpoint.cpp", "daemon/record/catalogue/schema.cpp", "daemon/session/rig_pipeline.cpp",
    ),
    "only a terminal or a log shows it": (
        "clients/gateway/access/ask_password.cpp", "clients/gateway/access/password.cpp", "clients/gateway/access/user_*.cpp",
        "clients/gateway/metrics/*", "daemon/device/found_units.cpp", "daemon/device/mcc/transfer_choice.cpp", "daemon/device/usb_tty.cpp",
        "daemon/device/*/usb_tty.cpp", "daemon/ipc/audit_trail.cpp", "daemon/ipc/key_commands.cpp", "daemon/ipc/local_publisher.cpp",
    ),
    "answers to a program that is not the dashboard": ("clients/gateway/http/request_check.cpp", "clients/gateway/http/websocket_session.cpp"),
    "for the person who programs a board": ("daemon/device/board/board_facts.cpp", "daemon/device/board/frames.cpp"),
    "what exactly is wrong inside a file, for the person who repairs it": (
        "daemon/device/replay/recorded_device.cpp", "daemon/device/replay/scan_merger.cpp", "daemon/record/catalogue/catalogue.cpp",
        "daemon/record/xdf/chunk_decoder.cpp", "daemon/record/xdf/chunk_index.cpp", "daemon/record/xdf/header_xml_*.cpp",
        "daemon/record/xdf/samples_codec.cpp", "daemon/record/xdf/verify.cpp", "daemon/record/xdf/xdf_writer.cpp",
    ),
    "the report translates it: clients/report/german.cpp": ("daemon/session/standing_load.cpp", "daemon/session/sway_summary.cpp"),
    "SQL": ("daemon/record/catalogue/catalogue_rows.h",),
}
# Texts of these rooms that stay as they are: those of the log, a string with quotes inside, which is
# in the catalogue, and the protocol of dtsd itself, which has its own translations.
OTHER_TEXTS = {
    'as the owner of the database: CREATE ROLE "dts-fleet-gateway" LOGIN IN ROLE dashboard, and name this role in --database', "{} at the centre watches {}",
    "login: {} ({}) from {}", "serving {} rig(s)", "session {} part {}: ", "{}(a login is {{}: {}, {}: {}})", "login rejected: {} from {}", ", and {} more since the line before", "a name that no user has", " (and {} more gaps before it)",
    "Free recording", "Freie Aufzeichnung", "Records until it is stopped", "Zeichnet auf, bis die Untersuchung beendet wird",
}
CATALOGUE = "clients/web/src/strings/de"
# Errors of the system, as strerror() words them, that opening and writing files, ports and sockets can have.
SYSTEM_ERRORS = (
    errno.EACCES, errno.EBUSY, errno.ECONNREFUSED, errno.ECONNRESET, errno.EDQUOT, errno.EEXIST, errno.EHOSTUNREACH, errno.EINVAL, errno.EIO,
    errno.EISDIR, errno.EMFILE, errno.ENETUNREACH, errno.ENODEV, errno.ENOENT, errno.ENOMEM, errno.ENOSPC, errno.ENOTDIR, errno.ENXIO, errno.EPERM,
    errno.EPIPE, errno.EROFS, errno.ETIMEDOUT,
)
# What a report says of a trial, a recording or a quotient; its German is in clients/report/german.cpp.
REPORTED = (
    "daemon/core/losses.cpp", "daemon/posturography/prepare.cpp", "daemon/record/overview.cpp", "daemon/record/xdf/survey.cpp",
    "daemon/session/standing_load.cpp", "daemon/session/sway_results.cpp", "daemon/session/sway_summary.cpp",
)
REPORT_CATALOGUE = "clients/report/german.cpp"
LOGGED = re.compile(r"(?:\blog_?(?:\.|->)\w+|\bstatic_assert)\($")
HEAD = re.compile(r"^(?:.*?(?:\breturn\b|(?<![=!<>])=(?!=)|\bcase [^\"]*?:(?!:)|\bdefault:|<<))", re.DOTALL)
SENTENCE = re.compile(r"[A-Za-z]{2,}[,:;]? [a-z(]|[a-z][,:;]? [A-Za-z]{2}")
NOT_FOR_PEOPLE = re.compile(r"\s*(?:SELECT|SET LOCAL|INSERT|UPDATE|DELETE|PRAGMA|WHERE|ORDER)\b|.*\bORDER BY\b|.*charset=|.*; SameSite=|default-src|attachment;|(?:dtsctl|dts-gateway|chmod) ",
                            re.DOTALL)
ESCAPES = {"n": "\n", "t": "\t"}
PLACE = re.compile(r"\{!?\}")
# A place in a command: what is typed must stay as it is, so the place must be "{!}".
PLACE_IN_COMMAND = re.compile(r"(?:dtsctl|--rig|--session)\b[^';]*\{\}")
MOST_DEPTH = 8


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
            message += "" if message.endswith("{}") or depth > 1 or letter == "{" else "{}"
        elif letter in ")]}":
            depth -= 1
        elif depth == 0 and not letter.isspace() and letter != "+" and not message.endswith("{}"):
            message += "{}"
        index += 1
    return [*found, message]


def without_comments(source):
    """Returns the source without comments, preprocessor lines and characters in single quotes."""
    kept, index = [], 0
    while index < len(source):
        end = index + 1
        character = re.match(r"'(?:\\.|[^\\'])'", source[index:index + 4])
        if source[index] == '"':
            end = literal(source, index)[1]
            kept.append(source[index:end])
        elif character and not source[index - 1:index].isalnum():
            end = index + character.end()
            kept.append("' '")
        elif source.startswith("//", index):
            end = source.find("\n", index)
            end = len(source) if end < 0 else end
        else:
            kept.append(source[index])
        index = end
    return re.sub(r"(?m)^#.*$", "", "".join(kept))


def expressions(text):
    """Returns each expression with a string, without what is in brackets inside it; what goes to a log is left out."""
    found, open_ones, logged, index = [], [""], None, 0

    def end_expression():
        if '"' in open_ones[-1]:
            found.append(open_ones[-1])
        open_ones[-1] = ""

    while index < len(text):
        letter = text[index]
        if letter == '"':
            end = literal(text, index)[1]
            open_ones[-1] += text[index:end] if logged is None else ""
            index = end
            continue
        if letter in "([{":
            if letter == "(" and logged is None and LOGGED.search(text[max(0, index - 40):index + 1]):
                logged = len(open_ones)
            open_ones[-1] += letter
            open_ones.append("")
        elif letter in ")]}":
            end_expression()
            if len(open_ones) > 1:
                open_ones.pop()
            if logged == len(open_ones):
                logged = None
            open_ones[-1] += letter
            if letter == "}":
                end_expression()
        elif letter in ",;":
            end_expression()
        else:
            open_ones[-1] += letter
        index += 1
    end_expression()
    return found


def without_head(expression):
    """Returns the expression without "return" or "name =" before it."""
    while head := HEAD.match(expression[:expression.find('"')]):
        expression = expression[head.end():]
    return expression


def messages_of(source):
    """Returns all messages of one source."""
    found = set()
    for expression in expressions(without_comments(source)):
        for message in messages(without_head(expression)):
            message = re.sub(r"%[-+0-9.]*(?:ll|z)?[a-z]", "{}", message).replace("%%", "%") if "%" in message else message
            if SENTENCE.search(re.sub(" +", " ", message.replace("{}", "")).strip()) and not NOT_FOR_PEOPLE.match(message):
                found.add(message)
    return found


def catalogue(source):
    """Returns the English messages of the catalogue."""
    found = re.findall(r"""\[\s*('(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*"),""", source, re.MULTILINE)
    return {re.sub(r"\\(.)", r"\1", one[1:-1]) for one in found}


def report_catalogue(source):
    """Returns the English texts of the report's catalogue. "{#}" is a place for a number."""
    found = re.findall(r'\{"((?:[^"\\]|\\.)*)"\s*,', re.sub(r'"\s*\n\s*"', "", source))
    return {re.sub(r"\\(.)", r"\1", one).replace("{#}", "{}") for one in found}


class Translation:
    """Translates as clients/web/src/strings/messages.ts does, but returns what stays English."""

    def __init__(self, known):
        self.known = known
        split = [(PLACE.split(one), PLACE.findall(one)) for one in known if PLACE.search(one)]
        split.sort(key=lambda one: -sum(letter.isalpha() for part in one[0] for letter in part))
        self.shapes = [(parts, [place == "{!}" or part.endswith("'") for place, part in zip(places, parts)]) for parts, places in split]

    @staticmethod
    def filled(message, parts):
        """Returns the texts for each place, or None if the message is another one."""
        if not message.startswith(parts[0]) or not message.endswith(parts[-1]):
            return None
        texts, at = [], len(parts[0])
        for index, part in enumerate(parts[1:]):
            end = len(message) - len(part) if index + 2 == len(parts) else message.find(part, at)
            if end <= at or (parts[index].endswith("'") and "'" in message[at:end]):
                return None
            texts.append(message[at:end])
            at = end + len(part)
        return texts

    def left(self, message, depth=0):
        """Returns the parts that stay English."""
        if message in self.known:
            return []
        for parts, is_name in self.shapes if depth < MOST_DEPTH else ():
            texts = self.filled(message, parts)
            if texts is not None:
                return [one for text, name in zip(texts, is_name) if not name for one in self.left(text, depth + 1)]
        is_text = re.search(r"[a-z]{3}", PLACE.sub("", message)) and not NOT_FOR_PEOPLE.match(message)
        return [message] if is_text else []

    def has_german(self, message):
        """Returns whether the message has German. Sources join sentences from parts: a part must occur in a sentence that has German."""
        return all(self.is_part(one) for one in self.left(message))

    def is_part(self, text):
        bare = re.sub(r"^(?:\{\})+|(?:\{\})+$", "", text).strip()
        pattern = re.compile("".join(r"(?:\{!?\}|[^{}]{1,40})" if part == "{}" else re.escape(part) for part in re.split(r"(\{\})", bare)))
        return any(pattern.search(one) for one in self.known)


def sources(root):
    """Returns the files of the rooms that are no exceptions."""
    excluded = {file for patterns in EXCEPTIONS.values() for pattern in patterns for file in root.glob(pattern)}
    files = {file for room in ROOMS for file in ([root / room] if "." in room else [*(root / room).rglob("*.cpp"), *(root / room).rglob("*.h")])}
    return sorted(files - excluded)


def main():
    root = pathlib.Path(sys.argv[1])
    texts = [file.read_text(encoding="utf-8") for file in sorted((root / CATALOGUE).glob("daemon*.ts"))]
    german = Translation({one for text in texts for one in catalogue(text)})
    missing = [f"{file.relative_to(root)}: no German for: {message}"
               for file in sources(root)
               for message in sorted(messages_of(file.read_text(encoding="utf-8")))
               if message not in OTHER_TEXTS and not german.has_german(message)]
    missing += [f"write {{!}} in the command, a command is not translated: {one}" for one in sorted(german.known) if PLACE_IN_COMMAND.search(one)]
    report = Translation(report_catalogue((root / REPORT_CATALOGUE).read_text(encoding="utf-8")))
    missing += [f"{name}: no German in the report for: {message}"
                for name in REPORTED
                for message in sorted(messages_of((root / name).read_text(encoding="utf-8")))
                if not report.has_german(message)]
    missing += [f"errno {number}: no German for: {os.strerror(number)}" for number in SYSTEM_ERRORS if os.strerror(number) not in german.known]
    print("\n".join(missing), end="\n" if missing else "")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
