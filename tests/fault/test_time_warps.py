#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The wall clock of a running daemon jumps, or shows a day of history: sessions are complete, and their scans are evenly spaced.

libfaketime (package faketime) changes CLOCK_REALTIME of the daemon only. The sleep of a machine is not here: a test of session/acquisition
has it with a virtual clock, and no test can suspend the machine on which it runs.
"""
import json
import os
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PROGRAMS = Path(os.environ.get("DTS_BIN_DIR", SOURCE / "build" / "release" / "bin"))
PATIENCE_S = 60.0
CONFIGURATION = """
[[rig]]
name = "floor"
file = "{source}/config/rigs/floor-sim.toml"
device = "sim:floor?seed=7"
"""


def library() -> str | None:
    """The library that the package faketime preloads."""
    found = sorted(Path("/usr/lib").glob("*/faketime/libfaketimeMT.so.1")) + sorted(Path("/usr/lib").glob("faketime/libfaketimeMT.so.1"))
    return str(found[0]) if found else None


@unittest.skipIf(library() is None, "needs the package faketime")
class WallClock(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="dts-", dir="/tmp"))  # short: a socket path has 107 bytes
        self.addCleanup(shutil.rmtree, self.folder)
        self.clock = self.folder / "clock"
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("DTSD_")}
        self.environment |= {"DTSD_RUNTIME_DIR": str(self.folder), "DTSD_STATE_DIR": str(self.folder / "state"), "TZ": "UTC"}

    def start_daemon(self, begin: str, zone: str = "UTC") -> None:
        """Starts dtsd at `begin`, "2038-01-19 03:14:05" of `zone`."""
        self.set_clock(f"@{begin}")
        (self.folder / "dtsd.toml").write_text(CONFIGURATION.format(source=SOURCE))
        faked = {
            "LD_PRELOAD": library() or "",
            "FAKETIME_TIMESTAMP_FILE": str(self.clock),
            "FAKETIME_NO_CACHE": "1",  # a changed file counts at once
            "FAKETIME_DONT_FAKE_MONOTONIC": "1",  # only the wall clock jumps, as with NTP
            "TZ": zone,
        }
        log = (self.folder / "log").open("w")
        self.addCleanup(log.close)
        process = subprocess.Popen(
            [PROGRAMS / "dtsd", "--config", self.folder / "dtsd.toml"],
            env=self.environment | faked,
            stdout=subprocess.DEVNULL,
            stderr=log,
        )
        self.addCleanup(self.end, process)
        self.wait_for(lambda: self.dtsctl("status", check=False).returncode == 0, "the daemon to serve")

    def end(self, process: subprocess.Popen[bytes]) -> None:
        process.terminate()
        try:
            self.assertEqual(process.wait(PATIENCE_S), 0)
        finally:
            process.kill()
            process.wait()

    def set_clock(self, text: str) -> None:
        """"@..." starts the clock at an instant, "+3600" shifts it by seconds from the true time."""
        new = self.folder / "clock.new"
        new.write_text(text)
        new.replace(self.clock)  # libfaketime never reads half a file

    def dtsctl(self, *words: str, check: bool = True) -> subprocess.CompletedProcess[str]:
        ended = subprocess.run([PROGRAMS / "dtsctl", "--timeout", f"{PATIENCE_S:g}", *words], env=self.environment, capture_output=True, text=True, timeout=2 * PATIENCE_S)
        if check and ended.returncode != 0:
            self.fail(f"dtsctl {' '.join(words)}: {ended.stderr}\n{(self.folder / 'log').read_text()}")
        return ended

    def wait_for(self, condition, what: str) -> None:
        deadline_s = time.monotonic() + PATIENCE_S
        while not condition():
            self.assertLess(time.monotonic(), deadline_s, f"waited in vain for {what}:\n{(self.folder / 'log').read_text()}")
            time.sleep(0.05)

    def session(self, during=lambda: None) -> str:
        """Records a session around `during`, and checks it: complete, sound, no gap, every scan at its time. Returns its ID."""
        id = self.dtsctl("session", "start", "--rig", "floor", "--protocol", "free", "--subject", "P1").stdout.strip()
        self.wait_for_scans(100)
        during()
        self.wait_for_scans(100)
        self.dtsctl("session", "stop", "--rig", "floor")
        self.wait_for(lambda: self.shown(id)["state"] == "complete", "the recording to be closed")
        self.dtsctl("session", "verify", id)
        shown = self.shown(id)
        self.assertEqual(shown["lost_scans"], 0)
        self.assertEqual(shown["gaps"], 0)
        out = self.folder / id
        self.dtsctl("session", "export", id, "--format", "csv", "--out", str(out))
        self.assert_even(next(out.glob("*raw*.csv")))
        return id

    def shown(self, id: str) -> dict:
        return json.loads(self.dtsctl("session", "show", id, "--json").stdout)

    def wait_for_scans(self, count: int) -> None:
        self.dtsctl("watch", "floor/cop", "--count", str(count), "--jsonl")

    def assert_even(self, file: Path) -> None:
        lines = file.read_text().splitlines()
        times_s = [float(line.split(",")[0]) for line in lines[1:]]
        self.assertGreater(len(times_s), 150)
        for before_s, after_s in zip(times_s, times_s[1:]):
            self.assertAlmostEqual(after_s - before_s, 0.01, places=4)

    def test_TheEndOf32BitSeconds(self) -> None:
        # requirement: REC-13
        self.start_daemon("2038-01-19 03:14:06")
        self.assertRegex(self.session(), "^20380119T0314")

    def test_ALeapDay(self) -> None:
        self.start_daemon("2028-02-28 23:59:58")
        self.assertRegex(self.session(), "^2028022[89]T")

    def test_TheHourThatIsSkipped(self) -> None:
        """In Berlin, 2026-03-29 01:59:59 is followed by 03:00:00; dtsd counts in UTC."""
        self.start_daemon("2026-03-29 01:59:58", zone="Europe/Berlin")
        self.assertRegex(self.session(), "^20260329T0(059|100)")

    def jump(self, begin: str, then: str, expected_id: str) -> None:
        """Sets the clock during a session. The ID of the next one shows that the daemon's clock has really changed."""
        self.start_daemon(begin)
        self.session(lambda: self.set_clock(f"@{then}"))
        self.assertRegex(self.session(), f"^{expected_id}")

    def test_AnHourForward(self) -> None:
        self.jump("2026-11-27 12:00:00", "2026-11-27 13:00:00", "20261127T13")

    def test_AnHourBack(self) -> None:
        # requirement: REC-13
        self.jump("2026-11-27 12:00:00", "2026-11-27 11:00:00", "20261127T11")

    def test_ALeapSecond(self) -> None:
        """Linux repeats the last second of the day: the wall clock goes back to its beginning."""
        self.jump("2016-12-31 23:59:50", "2016-12-31 23:59:59", "20170101T0000")

    def test_YearsForward(self) -> None:
        """A board without a battery, before NTP has set its clock."""
        self.jump("2001-01-01 00:00:05", "2026-11-27 12:00:00", "20261127T12")


if __name__ == "__main__":
    unittest.main()
