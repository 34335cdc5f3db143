#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Compares figures of the documents with what their commands print.

    figures.py check ROOT    only whether the documents have the texts that figures.toml names
    figures.py run ROOT      also runs the cheap commands and compares; lists the others with the date of their last run

Exit status 0: all agree, 1: something differs, 2: wrong use.
"""

import functools
import json
import shlex
import subprocess
import sys
import tomllib
from datetime import date
from pathlib import Path

KEYS_OF_CHEAP = {"file", "text", "command", "value", "expected", "tolerance"}
KEYS_OF_OTHERS = {"file", "text", "command", "last_run"}


def read(list_file: Path) -> list[dict]:
    return tomllib.loads(list_file.read_text(encoding="utf-8"))["figure"]


def one_line(text: str) -> str:
    """A text may be broken into lines differently."""
    return " ".join(text.split())


def text_findings(root: Path, figures: list[dict]) -> list[str]:
    findings = []
    for figure in figures:
        name = f"{figure.get('file')}: {figure.get('text')}"
        if set(figure) not in (KEYS_OF_CHEAP, KEYS_OF_OTHERS):
            findings.append(f"{name}: the keys are neither those of a cheap figure nor those of another one")
        elif "last_run" in figure and not isinstance(figure["last_run"], date):
            findings.append(f"{name}: last_run is not a date")
        elif "expected" in figure and f"{figure['expected']:g}" not in figure["text"]:
            findings.append(f"{name}: the text does not have the expected value {figure['expected']:g}")
        elif one_line(figure["text"]) not in one_line((root / figure["file"]).read_text(encoding="utf-8")):
            findings.append(f"{name}: this text is not in the document. Did the figure change? Then change figures.toml too")
    return findings


@functools.cache
def printed(command: str) -> object:
    return json.loads(subprocess.run(shlex.split(command), check=True, capture_output=True, text=True).stdout)


def value_of(document: object, way: str) -> float:
    for key in way.split("."):
        document = document[int(key)] if isinstance(document, list) else document[key]
    return float(document)


def value_finding(figure: dict) -> str | None:
    found = value_of(printed(figure["command"]), figure["value"])
    if abs(found - figure["expected"]) <= figure["tolerance"]:
        print(f"agrees   {found:.6g}  {figure['command']}: {figure['value']}")
        return None
    return f"{figure['file']}: {figure['command']} prints {found:.6g} for {figure['value']}, the document says {figure['expected']}"


def main(arguments: list[str]) -> int:
    if len(arguments) != 2 or arguments[0] not in ("check", "run"):
        print(__doc__, file=sys.stderr)
        return 2
    figures = read(Path(__file__).with_name("figures.toml"))
    findings = text_findings(Path(arguments[1]), figures)
    if arguments[0] == "run" and not findings:
        findings = [finding for figure in figures if "value" in figure and (finding := value_finding(figure))]
        for figure in figures:
            if "last_run" in figure:
                print(f"not run  last run {figure['last_run']}  {figure['command']}: {figure['file']}: {figure['text'][:80]}")
    print("\n".join(findings) or f"{len(figures)} figures: no difference")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
