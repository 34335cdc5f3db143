#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sentences that stand in several programs must be the same in all of them.

    shared_sentences.py ROOT

Reports, dtsctl and FHIR bundles have them in C++, the dashboard in TypeScript, and a document explains them.
requirement: REP-11 SWAY-10
"""

import re
import sys
from pathlib import Path

STRINGS = "clients/web/src/strings/"
REPORT = "clients/report/"


def literals(source):
    """Joins the literals of C++ that stand one after the other."""
    return re.sub(r'"\s*\n\s*"', "", source)


def text_of(source, key):
    """Returns the text of a key in a catalogue of the dashboard; None without one."""
    found = re.search(rf"^\s*{key}:\s*'([^'\n]*)',$", source, re.MULTILINE)
    return found and found.group(1)


def faults(read):
    """Returns a line for each place that lacks a sentence. `read` returns the content of a file of the repository."""
    german = literals(read(REPORT + "german.cpp"))
    use = {code: text_of(read(STRINGS + code + "/common.ts"), "intendedUse") for code in ("en", "de")}
    limit = {code: text_of(read(STRINGS + code + "/steadiness_decision.ts"), "limit") for code in ("en", "de")}
    page = re.sub(r"\s+", " ", re.sub(r"^> ", "", read("docs/device/intended-use.md"), flags=re.MULTILINE))
    wanted = [
        ("intended use", use["en"], literals(read(REPORT + "intended_use.h")), '"{}"', REPORT + "intended_use.h"),
        ("intended use", use["de"], german, '"{}"', REPORT + "german.cpp"),
        ("intended use", use["en"], page, "{}", "docs/device/intended-use.md"),
        ("limit of a decision", limit["en"], literals(read(REPORT + "decision_words.h")), '"{}."', REPORT + "decision_words.h"),
        ("limit of a decision", limit["de"], german, '"{}."', REPORT + "german.cpp"),
    ]
    lines = []
    for what, text, content, form, place in wanted:
        if text is None:
            lines.append(f"{STRINGS}: no sentence for: {what}")
        elif form.format(text) not in content:
            lines.append(f"{place}: lacks the sentence of the dashboard ({what}): {text}")
    return lines


def main():
    root = Path(sys.argv[1])
    lines = faults(lambda name: (root / name).read_text(encoding="utf-8"))
    print("\n".join(lines) or "the sentences are the same in C++, TypeScript and the documents")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
