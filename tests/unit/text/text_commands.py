#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that every command of our programs in a document exists, with its options.

    text_commands.py ROOT BIN    BIN is the folder of the programs

The --help of the programs decides. Each finding is one line. Exit status 0: nothing found, 1: findings, 2: wrong use.
"""

import functools
import pathlib
import re
import subprocess
import sys

import text_parts
import text_rules

PROGRAMS = ("dtsctl", "dtslab", "dts-gateway")
OPTIONAL_PROGRAMS = ("dts-forward", "dts-hub", "dts-fleet", "dts-worker", "dts-fleet-gateway")  # checked if they are built
COMMAND = re.compile(rf"(?<![\w.-])(?:[\w./]*/)?({'|'.join(PROGRAMS + OPTIONAL_PROGRAMS)})((?: [^\s]+)+)")  # two spaces end it: a picture, a remark
END = re.compile(r"[|&;<>#=]|--+(?![a-z])|.*[`;]$")  # a word at which the shell's next command, a remark or an arrow begins
WORD = re.compile(r"[a-z][a-z-]*(?:\|[a-z-]+)*")


class Helps:
    """The --help texts of the programs in a folder."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    @functools.cache
    def text(self, *words):
        done = subprocess.run([self.folder / words[0], *words[1:], "--help"], capture_output=True, text=True, check=False, timeout=60)
        return done.stdout


def commands_in(help_text):
    """Returns the words that the section "Commands" of a help text lists."""
    section = re.search(r"^Commands:\n((?:  .*\n)+)", help_text, re.MULTILINE)
    return set(re.findall(r"^  ([a-z][a-z-]*) ", section.group(1), re.MULTILINE)) if section else set()


def fault_of_command(program, words, helps):
    """Returns what is wrong with a command of a program, None if nothing is."""
    path = [program]
    if program in OPTIONAL_PROGRAMS and not (helps.folder / program).exists():
        return None
    for word in words:
        if END.match(word):
            return None
        if word.startswith("-"):
            option = re.match(r"-+[\w-]*", word).group(0)
            known = helps.text(*path) + helps.text(program)
            if len(option) > 2 and not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", known):
                return f"{' '.join(path)} has no option {option}"
            continue
        known = commands_in(helps.text(*path))
        if not known or not WORD.fullmatch(word):
            continue  # an argument
        for choice in word.split("|"):
            if choice not in known:
                return f"{' '.join(path)} has no command '{choice}'"
        path.append(word.split("|")[0])
    return None


def faults_of_document(relative, text, helps):
    """Looks at code only, because prose uses names of programs as words."""
    prose = text_parts.without_blocks(text)
    pieces = [(text_parts.line_of(prose, match.start()), match.group(1)) for match in re.finditer(r"`([^`]+)`", prose)]
    continued = ""
    for number, (line, outside) in enumerate(zip(text.split("\n"), prose.split("\n")), start=1):
        if outside.strip():
            continue
        line = f"{continued} {line.strip()}" if continued else line
        continued = line[:-1].rstrip() if line.endswith("\\") else ""
        if not continued:
            pieces.append((number, line))
    for number, piece in pieces:
        for match in COMMAND.finditer(piece.replace("\n", " ")):
            fault = fault_of_command(match.group(1), match.group(2).split(), helps)
            if fault:
                yield f"{relative}:{number}: {fault}"


def wrong_commands(root, helps):
    return [
        finding
        for relative in text_rules.documents(root)
        for finding in faults_of_document(relative, text_rules.read(root / relative), helps)
    ]


def main(arguments):
    if len(arguments) != 2 or not all((pathlib.Path(arguments[1]) / program).exists() for program in PROGRAMS):
        print(__doc__, file=sys.stderr)
        return 2
    findings = wrong_commands(pathlib.Path(arguments[0]), Helps(arguments[1]))
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
