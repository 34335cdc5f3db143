# SPDX-License-Identifier: Apache-2.0
"""Tests of results.py: what a run printed becomes the result of each case."""

import tempfile
import unittest
from pathlib import Path
from unittest import mock

import results

JUNIT = """<testsuite>
<testcase name="unit_core" status="run" time="1.5"><system-out>[ RUN      ] Rate.Day
[       OK ] Rate.Day (0 ms)
[ RUN      ] Rate.Crash
[       OK ] Kinds/Device.Stop/sim (1 ms)
[  FAILED  ] Kinds/Device.Stop/usb, where GetParam() = 1 (1 ms)
[  SKIPPED ] Disk.Full (0 ms)
[       OK ] Kinds/Device.Gap/sim (1 ms)
[  SKIPPED ] Kinds/Device.Gap/usb (1 ms)
[  SKIPPED ] Kinds/Device.Rest/sim (1 ms)
[  SKIPPED ] Kinds/Device.Rest/usb (1 ms)
</system-out></testcase>
<testcase name="web_live" status="fail" time="2"><system-out>TAP version 13
    ok 1 - shows a figure
    not ok 2 - shows another
    ok 3 - is left out # SKIP no screen
    ok 4 - is in two files
ok 1 - src/decisions.test.ts # time=8.24ms {
    ok 1 - one of vitest # time=1.58ms
    ok 2 - one that vitest leaves out # SKIP
    ok 3 - is in two files # SKIP
}
</system-out></testcase>
<testcase name="self_test" status="run" time="1"><system-out></system-out></testcase>
<testcase name="python_live" status="run" time="3"><system-out>..</system-out></testcase>
<testcase name="python_other" status="run" time="3"><system-out>ss
OK (skipped=2)
</system-out></testcase>
</testsuite>"""
LISTED = '{"tests": [{"name": "python_live", "command": ["python3", "/tests/python/test_live.py"]}, {"name": "python_other", "command": ["/tests/python/test_skipped.py"]}, {"name": "self_test", "command": ["python3", "-m", "unittest", "-q", "words_test"]}, {"name": "unit_core"}]}'


class RunOfTheSuite(unittest.TestCase):
    def setUp(self) -> None:
        with tempfile.NamedTemporaryFile("w", suffix=".xml") as file, mock.patch("subprocess.run") as run:
            file.write(JUNIT)
            file.flush()
            run.return_value.stdout = LISTED
            self.run_of = results.read(Path(file.name), Path("build"))

    def test_TestsHaveTheirStatusAndTime(self) -> None:
        self.assertEqual(
            self.run_of.tests,
            {"unit_core": "passed", "web_live": "failed", "self_test": "passed", "python_live": "passed", "python_other": "skipped"},
        )
        self.assertEqual(self.run_of.seconds["unit_core"], 1.5)

    def test_CasesOfGoogleTest(self) -> None:
        self.assertEqual(self.run_of.of("Rate.Day", "rate_test.cpp"), "passed")
        self.assertEqual(self.run_of.of("Disk.Full", "disk_test.cpp"), "skipped")
        self.assertEqual(self.run_of.of("Rate.Year", "rate_test.cpp"), "not run")

    def test_CaseThatBeganAndDidNotEnd_HasFailed(self) -> None:
        self.assertEqual(self.run_of.of("Rate.Crash", "rate_test.cpp"), "failed")

    def test_SkippedScript_IsNotPassed(self) -> None:
        self.assertEqual(self.run_of.of("test_Nothing", "tests/python/test_skipped.py"), "skipped")

    def test_OneParameterThatFails_FailsTheCase(self) -> None:
        self.assertEqual(self.run_of.of("Device.Stop", "device_test.cpp"), "failed")

    def test_ParametersThatAreSkipped_CountIfAllAre(self) -> None:
        self.assertEqual(self.run_of.of("Device.Gap", "device_test.cpp"), "passed")
        self.assertEqual(self.run_of.of("Device.Rest", "device_test.cpp"), "skipped")
        self.assertEqual(self.run_of.left_out, {"Device.Gap": "1 of 2 parameters skipped"})

    def test_CasesOfUnittest_AreThoseOfItsModule(self) -> None:
        self.assertEqual(self.run_of.of("test_word", "tests/unit/text/words_test.py"), "passed")

    def test_CasesOfNode(self) -> None:
        self.assertEqual(self.run_of.of("one of vitest", "decisions.test.ts"), "passed")
        self.assertEqual(self.run_of.of("one that vitest leaves out", "decisions.test.ts"), "skipped")
        self.assertEqual(self.run_of.of("shows a figure", "live.test.mjs"), "passed")
        self.assertEqual(self.run_of.of("shows another", "live.test.mjs"), "failed")
        self.assertEqual(self.run_of.of("is left out", "live.test.mjs"), "skipped")

    def test_OneOfTwoCasesOfNodeWithTheSameText_ThatIsSkipped_Counts(self) -> None:
        self.assertEqual(self.run_of.of("is in two files", "live.test.mjs"), "skipped")

    def test_ScriptsWithoutCases_HaveTheResultOfTheirFile(self) -> None:
        self.assertEqual(self.run_of.of("test_Values", "tests/python/test_live.py"), "passed")
        self.assertEqual(self.run_of.of("test_Values", "tests/python/test_other.py"), "not run")


if __name__ == "__main__":
    unittest.main()
