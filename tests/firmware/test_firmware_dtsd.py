# SPDX-License-Identifier: Apache-2.0
"""dtsd with the firmware in simavr as its DAQ: every recorded value is exact, and a reset of the board is a gap.

200 Hz, so that simavr has time to spare on a busy machine: dtsd compares the rate of a device with the clock of the machine.
DTS_FIRMWARE_RATE and DTS_FIRMWARE_SECONDS: another rate (Hz), and how long dtsd records before the reset.
"""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

from board_host import Board, conversion_of, wave

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = pathlib.Path(os.environ["DTS_BIN_DIR"])
LIMIT_S = 120.0
RATE = int(os.environ.get("DTS_FIRMWARE_RATE", "200"))
SECONDS = int(os.environ.get("DTS_FIRMWARE_SECONDS", "3"))


class Daemon:
    """A dtsd with one rig: the floor platform on a board at `port`."""

    def __init__(self, port: str, options: str = f"?channels=4&rate_hz={RATE}"):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="dts-", dir="/tmp"))  # short: a socket path has 107 bytes
        shutil.copytree(SOURCE / "config", self.folder / "config")
        rig = self.folder / "config/rigs/floor-board.toml"
        text = rig.read_text()
        assert "rate_hz = 1000.0" in text
        rig.write_text(text.replace("rate_hz = 1000.0", f"rate_hz = {RATE}.0"))
        config = self.folder / "config/dtsd.toml"
        config.write_text(f'[[rig]]\nname = "floor"\nfile = "rigs/floor-board.toml"\ndevice = "serial:{port}{options}"\n')
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("DTSD_")}
        self.environment |= {"DTSD_RUNTIME_DIR": str(self.folder), "DTSD_STATE_DIR": str(self.folder / "state")}
        self.log = (self.folder / "log").open("wb")
        self.process = subprocess.Popen([PROGRAMS / "dtsd", "--config", config, "--foreground"], env=self.environment, stderr=self.log)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(LIMIT_S)
        self.log.close()
        shutil.rmtree(self.folder)

    def ctl(self, *words: str) -> str:
        done = subprocess.run([PROGRAMS / "dtsctl", "--timeout", str(LIMIT_S), *words], env=self.environment, capture_output=True, text=True, timeout=2 * LIMIT_S)
        if done.returncode != 0:
            raise AssertionError(f"dtsctl {' '.join(words)}: {done.stderr}\n{(self.folder / 'log').read_text()}")
        return done.stdout

    def status(self) -> dict:
        return json.loads(self.ctl("status", "--json"))["rigs"][0]

    def scans(self) -> int:
        return self.status()["scans_total"]

    def wait_for(self, condition, what: str):
        end = time.monotonic() + LIMIT_S + SECONDS
        while True:
            try:
                if condition():
                    return
            except AssertionError:
                if self.process.poll() is not None:
                    raise
            if time.monotonic() > end:
                raise AssertionError(f"waited in vain: {what}\n{(self.folder / 'log').read_text()}")
            time.sleep(0.1 if SECONDS < 60 else 1)

    def raw_rows(self, session: str) -> list:
        """Returns the recorded volts of a session as codes, one list for each segment."""
        folder = self.folder / "csv"
        self.ctl("session", "export", session, "--format", "csv", "--out", str(folder))
        with next(folder.glob("*_raw.csv")).open() as table:
            return list(csv.DictReader(line for line in table if not line.startswith("#")))


class Dtsd(unittest.TestCase):
    def test_every_recorded_value_is_exact_and_a_reset_is_a_gap(self):
        with Board("dts-firmware.elf", "--reset-on-open") as board:
            self.check_with_daemon(board)
            changes = int(board.ask("led 4000").split()[1])
            self.assertIn(changes, (3, 4, 5), "dtsd has ended: the board is idle")

    def test_a_saturated_input_is_marked_as_rail(self):
        with Board("dts-firmware.elf", "--reset-on-open") as board:
            board.ask("volts 5.2 0 4.99 1")
            with Daemon(board.path) as daemon:
                daemon.wait_for(lambda: daemon.scans() > 100, "dtsd receives scans")
                lines = daemon.ctl("watch", "floor/raw", "--jsonl", "--count", "20").splitlines()
                blocks = [block for block in map(json.loads, lines) if "values" in block]
                self.assertGreater(len(blocks), 0)
                for block in blocks:
                    self.assertEqual(block["quality"], {"w1_v": ["rail"], "w2_v": ["rail"]})
                    for values in block["values"]:
                        self.assertEqual([round(volts * 1024 / 5, 2) for volts in values], [1023, 0, 1021, 204])

    def check_with_daemon(self, board: Board):
        with Daemon(board.path) as daemon:
            daemon.wait_for(lambda: daemon.scans() > 100, "dtsd receives scans")
            session = daemon.ctl("session", "start", "--rig", "floor", "--protocol", "free", "--subject", "P001").strip()
            before = daemon.scans()
            daemon.wait_for(lambda: daemon.scans() > before + SECONDS * RATE, f"{SECONDS} s are recorded")
            self.assertEqual(daemon.status()["gaps_total"], 0)
            board.ask("reset")
            daemon.wait_for(lambda: daemon.status()["gaps_total"] > 0, "the reset is a gap")
            after = daemon.scans()
            daemon.wait_for(lambda: daemon.scans() > after + 2 * RATE, "scans after the reset")
            daemon.ctl("session", "stop", "--rig", "floor")
            segments = {}
            for row in daemon.raw_rows(session):
                segments.setdefault(row["segment"], []).append((int(row["scan"]), [float(row[f"w{i}_v"]) for i in range(1, 5)]))
            self.assertEqual(len(segments), 2)
            for rows in segments.values():
                self.assertGreater(len(rows), RATE)
                first = conversion_of(0, round(rows[0][1][0] * 1024 / 5))
                for i, (scan, volts) in enumerate(rows):
                    self.assertEqual(scan, rows[0][0] + i)
                    self.assertEqual(volts, [wave(channel, first + i) * 5 / 1024 for channel in range(4)])
            print(f"{sum(map(len, segments.values()))} scans x 4 channels at {RATE} Hz recorded: every value exact; the reset is the only gap")


if __name__ == "__main__":
    unittest.main(verbosity=2)
