# SPDX-License-Identifier: Apache-2.0
"""Results of a run of the suite: of each test of ctest, and of the cases that GoogleTest and node:test print."""

import json
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

# "[       OK ] Kinds/DeviceContract.Deadline_IsKept/sim (12 ms)": the case without the names of its parameters.
GTEST = re.compile(r"^\[ +(OK|FAILED|SKIPPED) +\] (?:[^/\s]+/)?(\w+\.\w+)", re.M)
# node:test prints TAP if nobody watches: "    ok 2 - name", "not ok 1 - name", "ok 3 - name # SKIP".
TAP = re.compile(r"^\s*((?:not )?ok) \d+ - (.*?)( # SKIP.*)?$", re.M)
WORDS = {"OK": "passed", "FAILED": "failed", "SKIPPED": "skipped", "ok": "passed", "not ok": "failed"}
WORST_FIRST = ("failed", "passed", "skipped", "not run")


@dataclass
class Results:
    tests: dict[str, str] = field(default_factory=dict)  # name in ctest: passed, failed, skipped
    seconds: dict[str, float] = field(default_factory=dict)
    cases: dict[str, str] = field(default_factory=dict)  # "Suite.Name" or the text of a case: the same
    files: dict[str, list[str]] = field(default_factory=dict)  # a script's file name: the tests of ctest that run it

    def of(self, case: str, file: str) -> str:
        """Of a case; of a script that prints no cases: of the tests that run its file."""
        if case in self.cases:
            return self.cases[case]
        found = [self.tests[test] for test in self.files.get(Path(file).name, []) if test in self.tests]
        return worst(found)


def worst(words: list[str]) -> str:
    """A case of several parameters failed if one failed, and passed if one passed and none failed."""
    return min(words, key=WORST_FIRST.index, default="not run")


def status_of(case: ElementTree.Element) -> str:
    return {"run": "passed", "fail": "failed"}.get(case.get("status", ""), "skipped")


def read(junit: Path, build: Path) -> Results:
    results = Results()
    words: dict[str, list[str]] = {}
    for case in ElementTree.parse(junit).getroot().iter("testcase"):
        name = case.get("name", "")
        results.tests[name] = status_of(case)
        results.seconds[name] = float(case.get("time", 0))
        output = case.findtext("system-out") or ""
        for word, found in GTEST.findall(output):
            words.setdefault(found, []).append(WORDS[word])
        for word, found, skipped in TAP.findall(output):
            words.setdefault(found, []).append("skipped" if skipped else WORDS[word])
    results.cases = {name: worst(found) for name, found in words.items()}
    listed = subprocess.run(
        ["ctest", "--test-dir", str(build), "--show-only=json-v1"], check=True, capture_output=True, text=True
    ).stdout
    for test in json.loads(listed)["tests"]:
        for word in test.get("command", []):
            if word.endswith((".py", ".mjs")):
                results.files.setdefault(Path(word).name, []).append(test["name"])
    return results
