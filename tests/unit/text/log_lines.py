#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds messages in the section "What log lines mean" of docs/operating.md that no program prints.

    log_lines.py ROOT

A message stands between backticks before the colon of its list entry, or anywhere in the entry between double quotes. A program may join it from pieces:
what the document has between its places (capital letters, "...") must be in a string of the C++ sources. Pieces of one word count only if there is no
longer one. Exit status 0: all are found, 1: a list of the others.
"""
import errno
import os
import re
import sys
from pathlib import Path

import text_parts

DOCUMENT = "docs/operating.md"
HEADING = "What log lines mean"
ROOMS = ("clients", "daemon")
PLACE = re.compile(r"\b(?:[A-Z]|COLUMN|FILE|HINT|ID|LINE|NAME|PART|REASON|STATE|TIME|WHAT|WORD)\b|\.\.\.|\n")
# Not ours: systemd and the kernel print these.
OTHERS = {"Watchdog timeout", "killed by the OOM killer", "oom-kill"}


def section(document):
    """Returns the part of a document below HEADING."""
    return re.split(r"^## ", document.partition(f"## {HEADING}\n")[2], maxsplit=1, flags=re.MULTILINE)[0]


def entries(text):
    """Returns the entries of all lists, each as one line."""
    found = re.findall(r"^ *- (.*\n(?:^ *(?!- )\S.*\n)*)", text, re.MULTILINE)
    return [re.sub(r"\s+", " ", one) for one in found]


def messages(entry):
    """Returns the messages that an entry explains or quotes."""
    head = re.match(r"(?:`[^`]*`|[^`:])*", entry).group()
    return re.findall(r"`([^`]+)`", head) + re.findall(r'"([^"]+)"', re.sub(r"`[^`]*`", "", entry))


def pieces(message):
    """Returns the fixed pieces of a message: those of several words, or the longest."""
    parts = [part.strip(" ',;:()[]") for part in PLACE.split(message)]
    several = [part for part in parts if re.search(r"\w \w", part)]
    return several or [max(parts, key=len)]


def strings(source):
    """Returns the strings of a C++ source. Literals that stand one after the other are one."""
    joined = re.sub(r'"\s*\n\s*"', "", source)
    return "\n".join(re.sub(r"\\(.)", r"\1", line) for _, line in text_parts.tokens(joined, text_parts.STRING_GROUPS))


def faults(document, printed):
    """Returns a line for each message of the document that is not in `printed`."""
    return [f"{DOCUMENT}: no program prints: {message} (searched: {piece})"
            for entry in entries(section(document))
            for message in messages(entry) if message not in OTHERS
            for piece in pieces(message) if piece not in printed]


def main():
    root = Path(sys.argv[1])
    files = sorted(file for room in ROOMS for end in ("*.cpp", "*.h") for file in (root / room).rglob(end))
    system = [os.strerror(number) for number in errno.errorcode]
    printed = "\n".join([*(strings(file.read_text(encoding="utf-8")) for file in files), *system])
    lines = faults((root / DOCUMENT).read_text(encoding="utf-8"), printed)
    print("\n".join(lines), end="\n" if lines else "")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
