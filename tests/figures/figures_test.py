# SPDX-License-Identifier: Apache-2.0
"""Tests of figures.py."""

import datetime
import tempfile
import unittest
from pathlib import Path

import figures

CHEAP = {"file": "a.md", "text": "error 0.19 mm", "command": "echo '{\"rows\": [{\"mm\": 0.193}]}'", "value": "rows.0.mm", "expected": 0.19, "tolerance": 0.005}
OTHER = {"file": "a.md", "text": "takes 5 ms", "command": "scripts/bench", "last_run": datetime.date(2026, 11, 26)}


class Figures(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        (self.root / "a.md").write_text("An error\n0.19 mm. It takes 5 ms.\n")

    def test_TextsAreFoundAcrossLines(self) -> None:
        self.assertEqual(figures.text_findings(self.root, [CHEAP, OTHER]), [])

    def test_ChangedFigureIsFound(self) -> None:
        self.assertIn("not in the document", figures.text_findings(self.root, [CHEAP | {"text": "error of 0.19 mm"}])[0])

    def test_IncompleteEntriesAreFound(self) -> None:
        incomplete = {key: value for key, value in CHEAP.items() if key != "tolerance"}
        self.assertIn("keys", figures.text_findings(self.root, [incomplete])[0])
        self.assertIn("not a date", figures.text_findings(self.root, [OTHER | {"last_run": "yesterday"}])[0])

    def test_ExpectedValueIsThatOfTheText(self) -> None:
        self.assertIn("expected value 0.5", figures.text_findings(self.root, [CHEAP | {"expected": 0.5}])[0])

    def test_ValueWithinItsTolerance(self) -> None:
        self.assertIsNone(figures.value_finding(CHEAP))

    def test_ValueOutsideIsFoundWithBothNumbers(self) -> None:
        finding = figures.value_finding(CHEAP | {"expected": 0.18})
        self.assertIn("prints 0.193", finding)
        self.assertIn("says 0.18", finding)


if __name__ == "__main__":
    unittest.main()
