#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What `cmake --install` lays down fits together: units and their programs, the configuration, the manual pages.

DTS_BUILD_DIR: the build."""
import os
import re
import shutil
import subprocess
import tempfile
import tomllib
import unittest
import urllib.request
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent.parent
BUILD = Path(os.environ.get("DTS_BUILD_DIR", SOURCE / "build/release"))
PATIENCE_S = 60.0
TABLE = re.compile(r"^# (?=\[\[rig\]\]|(?:name|file|device) = )", re.MULTILINE)


def run(*words: str | Path, environment: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE_S, check=False, env=environment)


class Installed(unittest.TestCase):
    root: Path  # everything is below it
    prefix: Path  # usr/local in it
    etc: Path  # of dtsd

    @classmethod
    def setUpClass(cls) -> None:
        cls.root = Path(tempfile.mkdtemp(prefix="dts-"))
        cls.addClassCleanup(shutil.rmtree, cls.root)
        done = run("cmake", "--install", BUILD, environment={**os.environ, "DESTDIR": str(cls.root)})
        if done.returncode != 0:
            raise AssertionError(done.stdout + done.stderr)
        (cls.prefix,) = {unit.parents[3] for unit in cls.root.rglob("lib/systemd/system/dtsd.service")}
        cls.etc = next(cls.root.rglob("dtsd.toml")).parent

    def daemon(self, file: Path) -> subprocess.CompletedProcess[str]:
        environment = {"PATH": os.environ["PATH"], "DTSD_RUNTIME_DIR": str(self.root / "run"), "DTSD_STATE_DIR": str(self.root / "state")}
        return run(self.prefix / "sbin/dtsd", "--config", file, "--check-config", environment=environment)

    def test_UnitsNameWhatIsThere(self) -> None:
        # requirement: CFG-6
        fleet = ("dts-forward", "dts-hub", "dts-worker", "dts-fleet-gateway")  # only if their libraries are installed
        installed = [name for name in fleet if (self.prefix / f"lib/systemd/system/{name}.service").exists()]
        for name in ("dtsd", "dts-relay", "dts-lsl", "dts-gateway", *installed):
            text = (self.prefix / f"lib/systemd/system/{name}.service").read_text()
            (line,) = re.findall(r"^ExecStart=(.*)$", text, re.MULTILINE)
            named = [word for word in line.split() if word.startswith("/")]
            self.assertEqual(len(named), 2, line)
            for path in named:
                self.assertTrue((self.root / path.lstrip("/")).is_file(), path)

    def test_ConfigurationIsSound_AndHasNoRig(self) -> None:
        done = self.daemon(self.etc / "dtsd.toml")

        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("0 rig(s)", done.stdout)

    def test_RigsOfTheConfiguration_AreSoundOnceTheyAreNoCommentAnyMore(self) -> None:
        text = TABLE.sub("", (self.etc / "dtsd.toml").read_text())
        first, second = text.index("[[rig]]"), text.index("# Without a DAQ")
        hardware, simulated = text[:second], text[:first] + text[second:]
        for name, whole, rigs in (("hardware", hardware, 1), ("simulated", simulated, 2)):
            file = self.etc / f"{name}.toml"
            file.write_text(whole)

            done = self.daemon(file)

            self.assertEqual(done.returncode, 0, f"{name}: {done.stderr}")
            self.assertIn(f"{rigs} rig(s)", done.stdout)

    def test_GuideNamesWhatIsThere_AndItsRigIsSound(self) -> None:
        """docs/operating.md: the examples, and the table that it says to write for a DAQ without a trigger line."""
        (guide,) = self.prefix.rglob("doc/dtsd/docs/operating.md")
        for example in ("dtsd-daq.toml", "dtsd-alerts.yml", "dtsd.json"):
            self.assertIn(example, guide.read_text())
            self.assertTrue((guide.parent.parent / "examples" / example).is_file(), example)
        (table,) = re.findall(r"^ {4}\[\[rig\]\]\n(?: {4}\w+ = .*\n)+", guide.read_text(), re.MULTILINE)
        rig = (self.etc / "rigs/floor-daq.toml").read_text()
        (self.etc / "rigs/floor.toml").write_text(re.sub(r"^\[trigger\].*?(?=^\[)", "", rig, flags=re.MULTILINE | re.DOTALL))
        file = self.etc / "guide.toml"
        file.write_text(re.sub(r"^ +", "", table, flags=re.MULTILINE))

        done = self.daemon(file)

        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("1 rig(s)", done.stdout)

    def test_SimulatedExampleWorksInThePlaceOfTheConfiguration(self) -> None:
        (example,) = self.prefix.rglob("examples/dtsd-sim.toml")
        file = shutil.copy(example, self.etc / "copied.toml")

        done = self.daemon(Path(file))

        self.assertEqual(done.returncode, 0, done.stderr)

    def test_GatewayStartsWithItsConfiguration(self) -> None:
        (config,) = self.root.rglob("dts-gateway/gateway.toml")
        environment = {"PATH": os.environ["PATH"], "DTSD_RUNTIME_DIR": str(self.root / "run"), "CACHE_DIRECTORY": str(self.root)}
        words = [str(self.prefix / "bin/dts-gateway"), "serve", "--config", str(config), "--listen", "127.0.0.1:0"]
        if not (self.prefix / "share/dts-gateway/web").exists():
            self.skipTest("this build has no dashboard: npm was not there")
        with subprocess.Popen(words, stderr=subprocess.PIPE, text=True, env=environment) as gateway:
            assert gateway.stderr
            said = gateway.stderr.readline()
            try:
                with urllib.request.urlopen(said.split()[-1], timeout=PATIENCE_S) as page:
                    title = page.read()
            finally:
                gateway.terminate()
                status = gateway.wait(PATIENCE_S)

        self.assertRegex(said, r"^listening on http://127\.0\.0\.1:\d+/$")
        self.assertIn(b"<title>Tactile sensing (dtsd)</title>", title)
        self.assertEqual(status, 0)

    def test_RelayHasNothingToDoWithTheConfiguration(self) -> None:
        environment = {"PATH": os.environ["PATH"], "DTSD_RUNTIME_DIR": str(self.root / "run"), "DTSD_STATE_DIR": str(self.root / "state")}

        done = run(self.prefix / "sbin/dts-relay", "--config", self.etc / "dtsd.toml", environment=environment)

        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("nothing to relay", done.stderr)

    def test_GatewayRefusesAConfigurationWithAnUnknownWord(self) -> None:
        (config,) = self.root.rglob("dts-gateway/gateway.toml")
        wrong = self.root / "wrong.toml"
        wrong.write_text(config.read_text() + 'lisen = "127.0.0.1:0"\n')
        environment = {"PATH": os.environ["PATH"], "CACHE_DIRECTORY": str(self.root)}

        done = run(self.prefix / "bin/dts-gateway", "serve", "--config", wrong, environment=environment)

        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("lisen", done.stderr)

    def test_ManualPageHasEveryKeyOfTheConfiguration(self) -> None:
        (page,) = self.root.rglob("man5/dtsd.toml.5")
        sections = dict(re.findall(r"^\.SH \[+(\w+)\]+\n(.*?)(?=^\.SH)", page.read_text(), re.MULTILINE | re.DOTALL))
        for file in ("dtsd.toml", "dtsd-clinic.toml"):
            text = (SOURCE / "config" / file).read_text()
            whole = tomllib.loads(re.sub(r"^# (\w+ = .*|\[+\w+\]+(?: .*)?)$", r"\1", text, flags=re.MULTILINE))
            keys = {(table, key) for table, entry in whole.items() for key in (entry[0] if isinstance(entry, list) else entry)}
            self.assertGreater(len(keys), 12)
            for table, key in sorted(keys):
                self.assertIn(f"\n.B {key}\n", sections.get(table, ""), f"{file}: [{table}] {key}")

    def test_ReaderForOctaveIsWhereItsPageSaysIt(self) -> None:
        page = (SOURCE / "docs" / "analysis.md").read_text()

        self.assertIn("installs it in `/usr/share/dts/octave`", page)
        self.assertTrue((self.prefix / "share/dts/octave/dts_read_xdf.m").is_file())

    def test_ManualPagesAreThereAndSoundRoff(self) -> None:
        pages = sorted(path.name for path in self.prefix.rglob("man?/*.?"))
        has_fleet = (self.prefix / "sbin/dts-hub").is_file()  # only if its libraries are installed
        fleet = ["dts-fleet-gateway.8", "dts-fleet.1", "dts-forward.8", "dts-hub.8", "dts-worker.8"] if has_fleet else []
        self.assertEqual(pages, sorted([*fleet, "dts-gateway.8", "dts-lsl.8", "dts-relay.8", "dtsctl.1", "dtsd.8", "dtsd.toml.5", "dtslab.1"]))
        if shutil.which("groff") is None:
            self.skipTest("groff is not installed")
        for path in self.prefix.rglob("man?/*.?"):
            done = run("groff", "-man", "-Tutf8", "-ww", "-z", path)
            self.assertEqual(done.stderr, "", path.name)


class Purged(unittest.TestCase):
    def test_PurgeOfDtsd_RemovesWhatThePackageHas_AndNothingOfOthers(self) -> None:
        root = Path(tempfile.mkdtemp(prefix="dts-"))
        self.addCleanup(shutil.rmtree, root)
        etc = root / "etc/dtsd"
        etc.mkdir(parents=True)
        own = re.findall(r"^etc/dtsd/(\S+)$", (SOURCE / "debian/dtsd.install").read_text(encoding="utf-8"), re.MULTILINE)
        for name in own:
            file = etc / name if "." in name else etc / name / "made-here.toml"
            file.parent.mkdir(exist_ok=True)
            file.touch()
        of_others = ["forward.toml", "kent.toml", "lsl.toml", "s3-ca.pem", "s3.keys", "worker.toml"]
        for name in of_others:
            (etc / name).touch()
        environment = {**os.environ, "DPKG_ROOT": str(root)}

        done = run("sh", SOURCE / "debian/dtsd.postrm", "purge", environment=environment)

        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(sorted(file.name for file in etc.iterdir()), of_others)
        for name in of_others:
            (etc / name).unlink()
        run("sh", SOURCE / "debian/dtsd.postrm", "purge", environment=environment)
        self.assertFalse(etc.exists())


if __name__ == "__main__":
    unittest.main()
