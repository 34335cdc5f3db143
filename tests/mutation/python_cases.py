# SPDX-License-Identifier: Apache-2.0
"""Runs cases of tests/python up to the first that fails.

    python_cases.py TEST CASE...
    python_cases.py TEST --trace FILE      all cases; FILE gets {case: [seconds, {file: lines}]}, the lines of the client that each comes by
"""
import collections
import json
import pathlib
import sys
import threading
import time
import unittest

reached: dict[str, set[int]] = collections.defaultdict(set)


def trace(frame, event, argument):
    path = frame.f_code.co_filename
    if "/dts/" not in path or "/v1/" in path:
        return None
    reached[pathlib.PurePath(path).name].add(frame.f_lineno)
    return trace


class Watched(unittest.TestResult):
    """What a class sets up counts for each of its cases."""

    def __init__(self) -> None:
        super().__init__()
        self.cases, self.shared, self.group = {}, {}, None

    def startTest(self, test) -> None:
        super().startTest(test)
        if self.group is not type(test):
            self.group, self.shared = type(test), {file: set(lines) for file, lines in reached.items()}
        self.begun = time.monotonic()
        reached.clear()

    def stopTest(self, test) -> None:
        super().stopTest(test)
        files = {file: sorted(reached[file] | self.shared.get(file, set())) for file in {*reached, *self.shared}}
        self.cases[test.id().partition(".")[2]] = [time.monotonic() - self.begun, files]
        reached.clear()


name, *arguments = sys.argv[1:]
file = pathlib.Path(arguments[1]) if arguments[:1] == ["--trace"] else None
if file:
    threading.settrace(trace)
    sys.settrace(trace)
module = __import__(name)
load = unittest.defaultTestLoader
suite = load.loadTestsFromModule(module) if file else load.loadTestsFromNames(arguments, module)
result = Watched()
result.failfast = True
suite.run(result)
sys.settrace(None)
if file:
    file.write_text(json.dumps(result.cases))
sys.exit(not result.wasSuccessful())
