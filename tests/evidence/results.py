# SPDX-License-Identifier: Apache-2.0
"""Results of a run of the suite: of each test of ctest, and of the cases that GoogleTest and node:test print."""

import json
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

# "[       OK ] Kinds/DeviceContract.Deadline_IsKept/sim (12 ms)": the case without the names of its parameters.
GTEST = re.compile(r"^\[ *(RUN|OK|FAILED|SKIPPED) +\] (?:[^/\s]+/)?(\w+\.\w+)\S*(?: \(\d+ ms\)|, where .* \(\d+ ms\))?$", re.M)
SKIPPED_SCRIPT = re.compile(r"^OK \(skipped=\d+\)$", re.M)  # unittest does not name the cases: all of the file count as skipped
# node:test prints TAP if nobody watches: "    ok 2 - name", "not ok 1 - name", "ok 3 - name # SKIP". vitest: "    ok 1 - name # time=1.58ms".
TAP = re.compile(r"^\s*((?:not )?ok) \d+ - (.*?)(?: # time=\S+)?( # SKIP.*)?(?: \{)?$", re.M)
WORDS = {"RUN": "begun", "OK": "passed", "FAILED": "failed", "SKIPPED": "skipped", "ok": "passed", "not ok": "failed"}
WORST_FIRST = ("failed", "not run", "skipped", "passed")


@dataclass
class Results:
    tests: dict[str, str] = field(default_factory=dict)  # name in ctest: passed, failed, skipped
    seconds: dict[str, float] = field(default_factory=dict)
    cases: dict[str, str] = field(default_factory=dict)  # "Suite.Name" or the text of a case: the same
    left_out: dict[str, str] = field(default_factory=dict)  # of a case that passed: "3 of 14 parameters skipped"
    files: dict[str, list[str]] = field(default_factory=dict)  # a script's file name: the tests of ctest that run it

    def of(self, case: str, file: str) -> str:
        """Of a case; of a script that prints no cases: of the tests that run its file."""
        if case in self.cases:
            return self.cases[case]
        found = [self.tests[test] for test in self.files.get(Path(file).name, []) if test in self.tests]
        return worst(found)


def over_parameters(words: list[str]) -> str:
    """Of the parameters of a case: one that is skipped, as a device that makes no gap, counts only if all are. `left_out` has their number."""
    return worst([word for word in words if word != "skipped"] or words)


def worst(words: list[str]) -> str:
    """What is true of several results: one that failed, was not run or was skipped counts before those that passed."""
    return min(words, key=WORST_FIRST.index, default="not run")


def ended(words: list[str]) -> list[str]:
    """The results of a case that a program of GoogleTest printed: one that began and has no result crashed."""
    results = [word for word in words if word != "begun"]
    return results + ["failed"] * max(0, words.count("begun") - len(results))


def status_of(case: ElementTree.Element) -> str:
    return {"run": "passed", "fail": "failed"}.get(case.get("status", ""), "skipped")


def read(junit: Path, build: Path) -> Results:
    results = Results()
    of_gtest: dict[str, list[str]] = {}  # all results of a case, with each parameter
    of_tap: dict[str, list[str]] = {}  # cases of two files may have the same text
    for case in ElementTree.parse(junit).getroot().iter("testcase"):
        name = case.get("name", "")
        results.tests[name] = status_of(case)
        results.seconds[name] = float(case.get("time", 0))
        output = case.findtext("system-out") or ""
        of_program: dict[str, list[str]] = {}
        for word, found in GTEST.findall(output):
            of_program.setdefault(found, []).append(WORDS[word])
        for found, printed in of_program.items():
            of_gtest.setdefault(found, []).extend(ended(printed))
        if results.tests[name] == "passed" and SKIPPED_SCRIPT.search(output):
            results.tests[name] = "skipped"
        for word, found, skipped in TAP.findall(output):
            of_tap.setdefault(found, []).append("skipped" if skipped else WORDS[word])
    results.cases = {name: worst(found) for name, found in of_tap.items()} | {name: over_parameters(found) for name, found in of_gtest.items()}
    for name, found in of_gtest.items():
        if results.cases[name] == "passed" and "skipped" in found:
            results.left_out[name] = f"{found.count('skipped')} of {len(found)} parameters skipped"
    listed = subprocess.run(
        ["ctest", "--test-dir", str(build), "--show-only=json-v1"], check=True, capture_output=True, text=True
    ).stdout
    for test in json.loads(listed)["tests"]:
        command = test.get("command", [])
        modules = [f"{word}.py" for word in command[command.index("unittest") + 1 :]] if "unittest" in command else []
        for word in command + modules:
            if word.endswith((".py", ".mjs")):
                results.files.setdefault(Path(word).name, []).append(test["name"])
    return results
