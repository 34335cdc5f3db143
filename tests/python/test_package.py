# SPDX-License-Identifier: Apache-2.0
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from support import PATIENCE_S, SOURCE, DaemonProcess, WithDaemon, wait_for

CLIENT = SOURCE / "clients" / "python"


def run(*command: str | Path, environment: dict[str, str] | None = None, folder: Path = CLIENT) -> str:
    done = subprocess.run(command, env=environment, cwd=folder, timeout=5 * PATIENCE_S, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Package(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def test_TypesAreStrictlyChecked(self) -> None:
        cache = f"--cache-dir={self.folder}"
        examples = sorted((CLIENT / "examples").glob("*.py"))

        run(sys.executable, "-m", "mypy", cache, "--config-file", "pyproject.toml", "-p", "dts")
        for example in examples:
            run(sys.executable, "-m", "mypy", cache, "--config-file", "pyproject.toml", example)

        self.assertTrue(examples)

    def test_WheelIsBuiltWithoutNetworkAndImports(self) -> None:
        """In a copy of what the repository holds, since building writes beside the sources; through the source distribution."""
        tree = self.folder / "tree"
        ignored = shutil.ignore_patterns("v1", "build", "dist", "*.egg-info", "__pycache__")
        shutil.copytree(CLIENT, tree / "clients" / "python", ignore=ignored)
        shutil.copytree(SOURCE / "proto", tree / "proto")
        for name in ("CMakeLists.txt", "LICENSE"):
            shutil.copy(SOURCE / name, tree)
        clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}

        run(sys.executable, "-m", "build", "--no-isolation", "--outdir", self.folder, tree / "clients" / "python", environment=clean)
        (wheel,) = self.folder.glob("dts-*.whl")
        (source,) = self.folder.glob("dts-*.tar.gz")
        if (twine := shutil.which("twine")) is not None:  # as a package index checks them
            run(twine, "check", "--strict", wheel, source, environment=clean)
        shutil.unpack_archive(source, self.folder / "source")
        shutil.unpack_archive(wheel, self.folder / "installed", "zip")
        program = "import dts, dts.v1.control_pb2, pathlib; print(pathlib.Path(dts.__file__).parent)"
        where = run(sys.executable, "-c", program, environment={**clean, "PYTHONPATH": str(self.folder / "installed")}, folder=self.folder)

        self.assertEqual(Path(where.strip()), self.folder / "installed" / "dts")
        project = re.search(r"project\(dtsd VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())
        assert project
        self.assertEqual(wheel.name, f"dts-{project.group(1)}-py3-none-any.whl")
        self.assertTrue((self.folder / "source" / f"dts-{project.group(1)}" / "LICENSE").exists())
        self.assertTrue((self.folder / "installed" / "dts" / "py.typed").exists())
        self.assertTrue((self.folder / "installed" / "dts" / "v1" / "stream_pb2.pyi").exists())


class Examples(WithDaemon):
    def setUp(self) -> None:
        super().setUp()
        self.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.environment = {**self.process.environment, "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(self.folder)}

    def test_StabilogramIsDrawnAndItsFiguresAreLikeTheDaemons(self) -> None:
        picture = self.folder / "stabilogram.png"

        out = run(sys.executable, CLIENT / "examples" / "stabilogram.py", picture, "10", environment=self.environment)

        self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))
        velocity = re.search(r"mean velocity \(mm/s\) +([\d.]+) +([\d.]+)", out)
        area = re.search(r"95 % ellipse area \(mm2\) +([\d.]+) +([\d.]+)", out)
        assert velocity and area, out
        here, told = map(float, velocity.groups())
        self.assertTrue(0.5 < here / told < 2.0, out)  # of another stretch of the same person
        here, told = map(float, area.groups())
        self.assertTrue(0.05 < here / told < 20.0, out)

    def test_RecordingIsSummedUp(self) -> None:
        with self.daemon.start_session("floor", "free") as session:
            session.mark("here")
            self.daemon.record("floor/cop", 1.0)
        file = self.daemon.session(session.id).parts[0].file

        out = run(sys.executable, CLIENT / "examples" / "load_recording.py", file, environment=self.environment)

        self.assertRegex(out, r"floor/raw +w1_v +mean +[\d.]+")
        self.assertIn("marker  text here", out)

    def test_FirstMinuteOfTheReadmeRuns(self) -> None:
        wait_for(lambda: self.daemon.record("floor/cop", 0.1)["load_n"].mean() > 50, "somebody stands on the plate")
        (program,) = re.findall(r"```python\n(.*?)```", (CLIENT / "README.md").read_text(), re.DOTALL)

        out = run(sys.executable, "-c", program, environment=self.environment)

        self.assertIn("scans", out)


class Load(unittest.TestCase):
    def test_NothingIsLostOfSixteenChannelsAt1500Hz(self) -> None:
        # requirement: ACQ-2
        process = DaemonProcess(chair_streams=("raw", "deflection", "transient", "aux"))
        self.addCleanup(process.close)
        with process.connect() as daemon:
            raw = daemon.record("chair/raw", 3.0)

        self.assertEqual(raw.gaps, ())
        self.assertEqual(raw.values.shape, (4500, 16))


if __name__ == "__main__":
    unittest.main()
