#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the texts of the repository: documents, comments, messages, and the words on the screen.

    text_rules.py lines ROOT    Markdown lines are shorter than 120 characters, except rows of tables; no mark of an unfinished merge
    text_rules.py links ROOT    every local link in Markdown leads to a file or heading that exists
    text_rules.py words ROOT    no word that docs/glossary.md replaces by another one
    text_rules.py list ROOT     prints the files that have such words, as not_clean.txt lists them

Each finding is one line: file:line: what is wrong. Exit status 0: nothing found, 1: findings, 2: wrong use.
"""

import fnmatch
import os
import pathlib
import re
import sys
import urllib.parse

import text_parts

MAX_LINE = 119

# A pattern of whole words, and what to write instead. Add a word here when docs/glossary.md gets it.
WORDS = [
    (r"pseudonyms?", "subject ID"),
    (r"test persons?", "subject"),
    (r"(?:some|any)(?:body|one) (?:stands|who)|whoever|whosoever", "the subject, the user, the client"),
    (r"holes?", "gap"),
    (r"mend(?:s|ed|ing)?", "fix, correct, repair"),
    (r"anew", "again"),
    (r"(?:tell|hear)s?|(?:is|are|was|were|be|been) told|heard", "report, print, state; receive"),
    (r"(?:go|goes|went|going|gone) on(?! (?:the|a|its|their|board)\b)", "continue"),
    (r"refus(?:e|es|ed|ing|al|als)", "reject"),
    (r"broken off", "aborted"),
    (r"feigns?|feigned", "cause, imitate"),
    (r"drop-?outs?", "gap"),
    (r"stands? (?:still that|in the (?:file|status|catalogue|recording|table))|stands? behind it", "is in; follows"),
    (r"(?:does|do|did|done) without", "works without"),
    (r"is given up", "is abandoned, is dropped"),
    (r"zeroing|nulling", "tare"),
    (r"by no means|none of ours|of ours is", "not"),
]
BANNED = [(re.compile(rf"\b(?:{pattern})\b", re.IGNORECASE), instead) for pattern, instead in WORDS]

# The files whose comments or messages still have such words. This list must only become shorter: `list` prints it again.
NOT_CLEAN = "tests/unit/text/not_clean.txt"
# These name the words in order to replace them.
ABOUT_WORDS = ("docs/glossary.md", "tests/unit/text/")

SKIPPED_FOLDERS = {"build", "dist", "node_modules", "__pycache__", ".git", "generated"}
LINK = re.compile(r"(?<!\\)\[[^\]]*\]\(\s*<?([^)\s>]+)>?[^)]*\)")
SCHEME = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def files_of(root, patterns):
    """Returns relative paths, sorted, of files that match one of the patterns (FOLDER/NAME or FOLDER/**/NAME) and are not generated.

    Never enters a folder of generated files: other tests delete files there at the same time."""
    found = set()
    for pattern in patterns:
        folder, _, name = pattern.rpartition("/")
        for place, folders, names in os.walk(root / folder.removesuffix("**")):
            folders[:] = [each for each in folders if folder.endswith("**") and each not in SKIPPED_FOLDERS]
            found.update((pathlib.Path(place) / each).relative_to(root) for each in fnmatch.filter(names, name))
    return sorted(found)


def documents(root):
    return files_of(root, ["**/*.md"])


def read(path):
    return path.read_text(encoding="utf-8", errors="replace")


def long_lines(root):
    return [
        f"{relative}:{number}: {len(line)} characters, allowed are {MAX_LINE}"
        for relative in documents(root)
        for number, line in enumerate(read(root / relative).splitlines(), start=1)
        if len(line) > MAX_LINE and not line.startswith("|")  # Markdown cannot break a row of a table
    ] + [
        f"{relative}:{number}: mark of an unfinished merge: choose one of both texts"
        for relative in documents(root)
        for number, line in enumerate(read(root / relative).splitlines(), start=1)
        if re.match(r"<{7} |>{7} |={7}$", line)
    ]


def anchor_of(heading):
    """Returns the anchor that GitHub makes of a heading."""
    text = re.sub(r"[`*]|\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors_in(path):
    """Returns all anchors of a document. A repeated heading gets -1, -2, ..."""
    anchors, seen = set(), {}
    for line in text_parts.without_blocks(read(path)).splitlines():
        match = re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
        if match:
            anchor = anchor_of(match.group(1))
            count = seen.get(anchor, 0)
            seen[anchor] = count + 1
            anchors.add(f"{anchor}-{count}" if count else anchor)
    return anchors


def fault_of_link(root, relative, target):
    """Returns what is wrong with a link in the document `relative`, None if nothing is. Does not look at other machines."""
    if SCHEME.match(target):
        return None
    name, _, anchor = urllib.parse.unquote(target).partition("#")
    path = root / relative.parent / name if name else root / relative
    if not path.resolve().is_relative_to(root.resolve()):
        return f"{target}: leads out of the repository"
    if not path.exists():
        return f"{target}: no such file"
    if anchor and (path.suffix != ".md" or anchor not in anchors_in(path)):
        return f"{target}: no such heading"
    return None


def dead_links(root):
    findings = []
    for relative in documents(root):
        text = text_parts.without_code(read(root / relative))
        for match in LINK.finditer(text):
            fault = fault_of_link(root, relative, match.group(1))
            if fault:
                findings.append(f"{relative}:{text_parts.line_of(text, match.start(1))}: {fault}")
    return findings


# Kind of text, the files that have it, and the function that returns its paragraphs.
SCOPES = [
    ("documents", ["**/*.md"], text_parts.prose),
    ("comments", [f"{folder}/**/*{suffix}" for folder in ("daemon", "clients", "proto") for suffix in text_parts.COMMENTED],
     text_parts.comments),
    ("messages", ["daemon/**/*.cpp", "clients/**/*.cpp"], text_parts.messages),
    ("screen", ["clients/web/src/strings/*.ts"], text_parts.messages),
]


def faults_of_paragraph(paragraph):
    """Returns pairs of line number and fault."""
    text = " ".join(line for _, line in paragraph)
    faults = []
    for pattern, instead in BANNED:
        for match in pattern.finditer(text):
            end = 0
            for number, line in paragraph:
                end += len(line) + 1
                if match.start() < end:
                    faults.append((number, f"'{match.group(0)}': write {instead}"))
                    break
    return faults


def unclean(root, kind, patterns, parts):
    """Returns, for one kind of text, pairs of path and findings."""
    for relative in files_of(root, patterns):
        if relative.as_posix().startswith(ABOUT_WORDS):
            continue
        paragraphs = parts(relative, read(root / relative))
        faults = sorted(fault for paragraph in paragraphs for fault in faults_of_paragraph(paragraph))
        if faults:
            yield relative, [f"{relative}:{number}: {fault}" for number, fault in faults]


def banned_words(root):
    not_clean = not_clean_in(root)
    return [
        finding
        for kind, patterns, parts in SCOPES
        for relative, findings in unclean(root, kind, patterns, parts)
        if (kind, relative.as_posix()) not in not_clean
        for finding in findings
    ]


def not_clean_in(root):
    """Returns the pairs of kind and path that NOT_CLEAN lists."""
    path = root / NOT_CLEAN
    lines = read(path).splitlines() if path.exists() else []
    return {tuple(line.split()) for line in lines if line.strip() and not line.startswith("#")}


def list_of_not_clean(root):
    """Returns the lines of a new NOT_CLEAN file."""
    return [f"{kind} {relative}" for kind, patterns, parts in SCOPES for relative, _ in unclean(root, kind, patterns, parts)]


def main(arguments):
    checks = {"lines": long_lines, "links": dead_links, "words": banned_words, "list": list_of_not_clean}
    if len(arguments) != 2 or arguments[0] not in checks:
        print(__doc__, file=sys.stderr)
        return 2
    root = pathlib.Path(arguments[1])
    if not documents(root):
        print(f"{root}: no documents found: nothing was checked", file=sys.stderr)
        return 2
    findings = checks[arguments[0]](root)
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
