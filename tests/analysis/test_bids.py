# SPDX-License-Identifier: Apache-2.0
"""The validator of the BIDS community accepts the datasets that dtsctl writes."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from typing import Any

import recordings
from support import PATIENCE_S, DaemonProcess

VALIDATOR = os.environ.get("DTS_BIDS_VALIDATOR", "")
# Warnings that no export of ours can avoid. Every other warning fails the test.
ACCEPTED = {
    "CUSTOM_COLUMN_WITHOUT_DESCRIPTION",  # this validator takes the first scan of a motion.tsv for a header; BIDS forbids a header there
    "MISSING_SESSION",  # not every subject came to every session
    "NO_AUTHORS",  # dtsd does not know who publishes the dataset
}


def issues_of(dataset: Path) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    """Returns errors and warnings: the names of the files by the key of the issue."""
    command = [os.environ.get("DTS_NODE", "node"), VALIDATOR, dataset, "--json"]
    done = subprocess.run(command, timeout=5 * PATIENCE_S, capture_output=True, text=True)
    assert done.stdout, done.stderr
    issues: dict[str, Any] = json.loads(done.stdout)["issues"]

    def by_key(kind: str) -> dict[str, list[str]]:
        return {issue["key"]: [(file.get("file") or {}).get("name", "") for file in issue["files"]] for issue in issues[kind]}

    return by_key("errors"), by_key("warnings")


class Datasets(unittest.TestCase):
    folder: Path
    dataset: Path
    recorded: list[recordings.Recorded]

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        process = DaemonProcess(further=recordings.RIGS)
        cls.addClassCleanup(process.close)
        cls.recorded = recordings.record(process)
        cls.dataset = cls.folder / "dataset"
        for session in cls.recorded:
            process.dtsctl("session", "export", session.session_id, "--format", "bids", "--out", str(cls.dataset))

    def test_EveryKindOfSessionIsValid(self) -> None:
        # requirement: REP-5
        errors, warnings = issues_of(self.dataset)

        self.assertEqual(errors, {})
        self.assertLessEqual(set(warnings), ACCEPTED, warnings)
        self.assertTrue(all(name.endswith("_motion.tsv") for name in warnings.get("CUSTOM_COLUMN_WITHOUT_DESCRIPTION", [])), warnings)

    def files_of(self, kind: str, pattern: str) -> list[Path]:
        (session,) = (session for session in self.recorded if session.kind == kind)
        label = "".join(letter for letter in session.session_id if letter.isalnum())
        return sorted(self.dataset.glob(f"sub-*/ses-{label}/motion/{pattern}"))

    def test_TwoPartsAreTwoRunsAndAGapIsInTheTimes(self) -> None:
        for kind in ("two-part", "resumed"):
            runs = [file.name.rsplit("floorcop_")[1] for file in self.files_of(kind, "*floorcop*motion.tsv")]
            self.assertEqual(runs, ["motion.tsv", "run-2_motion.tsv"], kind)
        (cop,) = self.files_of("gapped", "*floorcop_motion.tsv")
        times_s = [float(line.split("\t")[0]) for line in cop.read_text().splitlines()]
        self.assertGreater(max(b - a for a, b in zip(times_s, times_s[1:])), 1.0)

    def test_EveryRecordingHasItsOtherFactsBeside(self) -> None:
        documents = [json.loads(document.read_text()) for document in (self.dataset / "sourcedata").rglob("*_recording.json")]

        for session in self.recorded:
            parts = sorted(document["part"] for document in documents if document["session_id"] == session.session_id)
            self.assertEqual(parts, list(range(1, len(session.files) + 1)), session.kind)
        self.assertIn("max_reach_cm", next(document["subject_fields"] for document in documents if document["rig"] == "chair"))

    def test_AKeyOfOursInASidecarIsFound(self) -> None:
        """Shows that the validator reads the sidecars at all."""
        broken = self.folder / "broken"
        shutil.copytree(self.dataset, broken)
        sidecar = next(broken.rglob("*chairraw_motion.json"))
        sidecar.write_text(json.dumps({**json.loads(sidecar.read_text()), "FilterDelay": 0.02}))

        errors, _ = issues_of(broken)

        self.assertEqual(errors, {"JSON_SCHEMA_VALIDATION_ERROR": [sidecar.name]})


if __name__ == "__main__":
    if not VALIDATOR:
        print("skipped: the BIDS validator is not installed; it requires node and npm")
        sys.exit(77)
    unittest.main()
