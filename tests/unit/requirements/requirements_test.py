# SPDX-License-Identifier: Apache-2.0
"""Tests of requirements.py: each way in which document and tests can differ is found."""

import tempfile
import unittest
from pathlib import Path

import requirements

TABLE = "| id | requirement | source |\n|---|---|---|\n| COP-1 | Axes. | thesis |\n| REP-2 | Bytes. | README |\n"
CPP = 'TEST(Cop, Axes)\n{\n  RecordProperty("requirement", "COP-1");\n}\n'
PYTHON = "class A:\n    def test_Bytes(self) -> None:\n        # requirement: REP-2\n        pass\n"


class Requirements(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)

        self.hazards = "| HAZ-1 | wrong side | mirrored | harm | rejected | COP-1 REP-2 | none |\n"

    def findings(self, document: str = TABLE, **tests: str) -> list[str]:
        """The findings in a tree with this document and these files: their names have "_" before the suffix."""
        (self.root / "docs").mkdir(exist_ok=True)
        (self.root / requirements.DOCUMENT).write_text(document)
        (self.root / "docs/device").mkdir(exist_ok=True)
        (self.root / requirements.HAZARDS).write_text(self.hazards)
        (self.root / "tests").mkdir(exist_ok=True)
        for name, text in tests.items():
            (self.root / "tests" / name.replace("_", ".")).write_text(text)
        return requirements.findings(self.root)

    def test_CompletePasses(self) -> None:
        self.assertEqual(self.findings(a_cpp=CPP, b_py=PYTHON), [])

    def test_RequirementWithoutATestIsFound(self) -> None:
        self.assertEqual(self.findings(a_cpp=CPP), ["docs/requirements.md: REP-2 has no test: let a test carry this ID"])

    def test_UnknownIdIsFoundWithItsPlace(self) -> None:
        wrong = CPP.replace("COP-1", "COP-1 COP-9")
        self.assertEqual(self.findings(a_cpp=wrong, b_py=PYTHON), ["tests/a.cpp:3: COP-9 is not in docs/requirements.md"])

    def test_IdTwiceIsFound(self) -> None:
        twice = TABLE + "| COP-1 | Other. | thesis |\n"
        self.assertEqual(self.findings(twice, a_cpp=CPP, b_py=PYTHON), ["docs/requirements.md: COP-1 is there twice"])

    def test_IdOutsideOfATestIsFound(self) -> None:
        loose = "# requirement: REP-2\n"
        self.assertEqual(self.findings(a_cpp=CPP, b_py=loose), ["tests/b.py:1: REP-2 belongs to no test"])

    def test_DocumentWithoutRequirementsIsFound(self) -> None:
        self.hazards = ""
        self.assertEqual(self.findings("# Requirements\n"), ["docs/requirements.md: no requirement found"])

    def test_CommentOfAScriptBelongsToTheNextTest(self) -> None:
        script = "test('one', () => {});\n  // requirement: REP-2\n  test('it\\'s two', () => {});\n"
        self.assertEqual(self.findings(a_cpp=CPP, b_mjs=script), [])
        self.assertEqual([item.name for item in requirements.all_evidence(self.root) if item.id == "REP-2"], ["it\\'s two"])

    def test_HazardWithoutARequirementOrWithAnUnknownOneIsFound(self) -> None:
        self.hazards += self.hazards.replace("COP-1 REP-2", "") + self.hazards.replace("COP-1", "COP-9")
        self.assertEqual(
            self.findings(a_cpp=CPP, b_py=PYTHON),
            ["docs/device/hazards.md:2: HAZ-1 names no requirement", "docs/device/hazards.md:3: COP-9 is not in docs/requirements.md"],
        )

    def test_MatrixNamesEachTest(self) -> None:
        self.findings(a_cpp=CPP, b_py=PYTHON)
        self.assertEqual(
            list(requirements.matrix(self.root))[2:],
            ["| COP-1 | Axes. | `Cop.Axes` (tests/a.cpp) |", "| REP-2 | Bytes. | `test_Bytes` (tests/b.py) |"],
        )


if __name__ == "__main__":
    unittest.main()
