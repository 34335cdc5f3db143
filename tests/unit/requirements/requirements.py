#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares docs/requirements.md with the IDs that the tests carry and that docs/device/hazards.md names.

    requirements.py check ROOT     fails if a requirement has no test, if a test or hazard has an ID that is not in the document, or if a
                                   hazard has none
    requirements.py matrix ROOT    prints the matrix of requirements and tests as Markdown

Exit status 0: nothing found, 1: findings, 2: wrong use.
"""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

DOCUMENT = Path("docs/requirements.md")
HAZARDS = Path("docs/device/hazards.md")
ROW = re.compile(r"\| (?P<id>[A-Z]+-\d+) \| (?P<text>.+) \| (?P<source>.+) \|")
# A test of GoogleTest, of unittest or of node:test begins; or an ID, which belongs to the test around it.
CPP = re.compile(r'^(?:TEST|TEST_F|TEST_P)\(\s*(?P<suite>\w+),\s*(?P<name>\w+)\s*\)|RecordProperty\("requirement", "(?P<ids>[^"]*)"\)', re.M)
PYTHON = re.compile(r"^ *def (?P<name>test_\w+)|^ *# requirement: (?P<ids>.*)$", re.M)
SCRIPT = re.compile(r"^ *test\('(?P<name>(?:[^'\\]|\\.)*)'|^ *// requirement: (?P<ids>.*)$", re.M)
PATTERNS = {".cpp": CPP, ".py": PYTHON, ".mjs": SCRIPT, ".ts": SCRIPT}


@dataclass(frozen=True)
class Requirement:
    id: str
    text: str
    source: str


@dataclass(frozen=True)
class Evidence:
    """A test that carries IDs. `name` is that of the test's framework: "Suite.Name" for GoogleTest."""

    id: str
    name: str
    file: str
    line: int


def requirements(root: Path) -> list[Requirement]:
    rows = [ROW.fullmatch(line) for line in (root / DOCUMENT).read_text(encoding="utf-8").splitlines()]
    return [Requirement(row["id"], row["text"], row["source"]) for row in rows if row]


def files(root: Path) -> Iterator[Path]:
    for folder in (root / "tests", root / "clients/web/src"):
        for file in sorted(folder.rglob("*")):
            if file.suffix in PATTERNS and "node_modules" not in file.parts and file.parent.name != "requirements":
                yield file


def evidence_of(file: Path, root: Path) -> Iterator[Evidence]:
    """A script's comment is before its test; in C++ and Python the ID is within the test."""
    text = file.read_text(encoding="utf-8")
    is_before = PATTERNS[file.suffix] is SCRIPT
    name = ""
    waiting: list[tuple[str, int]] = []
    for match in PATTERNS[file.suffix].finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        groups = match.groupdict()
        found = [(id, line) for id in (groups["ids"] or "").split()]
        if groups["ids"] is None:
            name = f"{groups['suite']}.{groups['name']}" if groups.get("suite") else groups["name"]
            found, waiting = waiting, []
        elif is_before:
            waiting, found = found, []
        for id, at in found:
            yield Evidence(id, name, str(file.relative_to(root)), at)


def all_evidence(root: Path) -> list[Evidence]:
    return [evidence for file in files(root) for evidence in evidence_of(file, root)]


def hazard_findings(root: Path, known: set[str]) -> Iterator[str]:
    """The requirements of a hazard are in the last column but one."""
    for number, line in enumerate((root / HAZARDS).read_text(encoding="utf-8").splitlines(), 1):
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if not cells[0].startswith("HAZ-"):
            continue
        ids = cells[-2].split()
        if not ids:
            yield f"{HAZARDS}:{number}: {cells[0]} names no requirement"
        yield from (f"{HAZARDS}:{number}: {id} is not in {DOCUMENT}" for id in ids if id not in known)


def findings(root: Path) -> list[str]:
    listed = requirements(root)
    evidence = all_evidence(root)
    known = {requirement.id for requirement in listed}
    tested = {item.id for item in evidence}
    result = [] if listed else [f"{DOCUMENT}: no requirement found"]
    for id in sorted({item.id for item in listed if sum(other.id == item.id for other in listed) > 1}):
        result.append(f"{DOCUMENT}: {id} is there twice")
    result += [f"{DOCUMENT}: {item.id} has no test: let a test carry this ID" for item in listed if item.id not in tested]
    result += [f"{item.file}:{item.line}: {item.id} is not in {DOCUMENT}" for item in evidence if item.id not in known]
    result += [f"{item.file}:{item.line}: {item.id} belongs to no test" for item in evidence if not item.name]
    return result + list(hazard_findings(root, known))


def matrix(root: Path) -> Iterator[str]:
    evidence = all_evidence(root)
    yield "| id | requirement | tests |"
    yield "|---|---|---|"
    for requirement in requirements(root):
        tests = [f"`{item.name}` ({item.file})" for item in evidence if item.id == requirement.id]
        yield f"| {requirement.id} | {requirement.text} | {'<br>'.join(tests)} |"


def main(arguments: list[str]) -> int:
    if len(arguments) != 2 or arguments[0] not in ("check", "matrix"):
        print(__doc__, file=sys.stderr)
        return 2
    root = Path(arguments[1])
    if arguments[0] == "matrix":
        print("\n".join(matrix(root)))
        return 0
    found = findings(root)
    print("\n".join(found) or f"{len(requirements(root))} requirements, each with a test")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
