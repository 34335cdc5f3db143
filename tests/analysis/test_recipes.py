# SPDX-License-Identifier: Apache-2.0
"""Runs the programs of docs/analysis.md as they are printed there."""
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import dts
import numpy as np
from support import PATIENCE_S, SOURCE, WithDaemon, wait_for

BLOCK = re.compile(r"```(octave|python)\n(.*?)```", re.DOTALL)
OCTAVE = shutil.which("octave-cli")
LOAD_N = 100.0  # more than an empty plate, less than the simulated person


class Recipes(WithDaemon):
    folder: Path
    recording: dts.Recording

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        with cls.process.connect() as daemon:
            wait_for(lambda: bool(daemon.record("floor/cop", 0.1)["load_n"].mean() > LOAD_N), "a person stands on the plate")
            with daemon.start_session("floor", "free") as session:
                daemon.record("floor/cop", 1.0)
                session.mark("eyes closed")
                daemon.record("floor/cop", 0.5)
            file = daemon.session(session.id).parts[0].file
        shutil.copy(file, cls.folder / "session.xdf")
        cls.process.dtsctl("session", "export", session.id, "--format", "csv", "--out", str(cls.folder))
        (cls.folder / f"{session.id}_cop.csv").rename(cls.folder / "session_cop.csv")
        cls.recording = dts.load(file)

    def recipe(self, language: str, word: str) -> str:
        """Returns the one program on the page that contains the word."""
        page = (SOURCE / "docs" / "analysis.md").read_text()
        (program,) = [text for kind, text in BLOCK.findall(page) if kind == language and word in text]
        return str(program)

    def start(self, *command: str) -> "subprocess.Popen[str]":
        path = f"{self.process.program('dtsctl').parent}:{os.environ['PATH']}"
        environment = {**os.environ, **self.process.environment, "PATH": path}
        process = subprocess.Popen(command, cwd=self.folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def run_to_its_end(self, *command: str) -> str:
        process = self.start(*command)
        out, log = process.communicate(timeout=5 * PATIENCE_S)
        self.assertEqual(process.returncode, 0, out + log)
        return out

    def octave(self, word: str) -> str:
        if OCTAVE is None:
            self.skipTest("Octave is not installed: apt-get install octave")
        reader = str(SOURCE / "clients" / "octave")
        return self.run_to_its_end(OCTAVE, "--quiet", "--no-init-file", "--path", reader, "--eval", self.recipe("octave", word))

    def python(self, word: str) -> str:
        return self.run_to_its_end(sys.executable, "-c", self.recipe("python", word))

    def needs(self, module: str) -> None:
        if importlib.util.find_spec(module) is None:
            self.skipTest(f"{module} is not installed")

    def test_OctaveLoadsAFile(self) -> None:
        ap_mm = self.recording["cop"]["ap_mm"]
        at_s = self.recording.events_of("marker")[0].time_s - self.recording["cop"].time_s[0]

        out = self.octave("dts_read_xdf")

        self.assertEqual(out, f"ap_mm: {ap_mm.min():g} to {ap_mm.max():g} mm\n{at_s:.3f} s: eyes closed\n")

    def test_OctaveLoadsATable(self) -> None:
        ap_mm = self.recording["cop"]["ap_mm"]

        self.assertEqual(self.octave("dlmread"), f"{ap_mm.min():g} to {ap_mm.max():g}\n")

    def test_OctaveHasLiveData(self) -> None:
        for word in ("popen", "system("):
            rows = [line.split() for line in self.octave(word).splitlines()]
            self.assertEqual(len(rows), 20)
            scans = [int(row[0]) for row in rows]
            self.assertEqual(scans, sorted(set(scans)))
            self.assertGreater(min(float(row[1]) for row in rows), LOAD_N)

    def test_PythonLoadsAFile(self) -> None:
        cop = self.recording["cop"]
        marker = self.recording.events_of("marker")[0]

        out = self.python('cop["ap_mm"].max()')

        self.assertEqual(out, f"{cop.channels} {cop.values.shape} 0 {str(cop['ap_mm'].max())}\n{[(marker.time_s, 'eyes closed')]}\n")

    def test_PythonHasLiveData(self) -> None:
        process = self.start(sys.executable, "-c", self.recipe("python", "dts.connect()"))
        assert process.stdout is not None
        rows = [process.stdout.readline().split() for _ in range(20)]

        scans = [int(row[0]) for row in rows]
        self.assertEqual(scans, sorted(set(scans)))
        self.assertGreater(min(float(row[1]) for row in rows), LOAD_N)

    def test_MneHasTheFirstSegment(self) -> None:
        self.needs("mne")

        out = self.python("import dts, mne")

        self.assertEqual(out.splitlines()[-1], f"{len(self.recording['cop'])} ['eyes closed']")

    def test_PyxdfHasEveryScan(self) -> None:
        # requirement: REC-1
        self.needs("pyxdf")
        cop = self.recording["cop"]

        shape, first_s = re.fullmatch(r"(\(.*\)) (\S+)\n", self.python("import pyxdf")).groups()  # type: ignore[union-attr]

        self.assertEqual(shape, str(cop.values.shape))
        np.testing.assert_allclose(float(first_s), cop.time_s[0], rtol=0, atol=1e-6)


if __name__ == "__main__":
    unittest.main()
