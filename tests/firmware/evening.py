# SPDX-License-Identifier: Apache-2.0
"""Follows docs/evening-rig.md from step 5 on, with a simulated board and a simulated assistant. scripts/evening-demo runs it.

--sensors-only      ends after the calibration of the sensors
--write-weights F   only writes the rows of weights for a simulated plate, in the order of `calibrate cop --grid 6 --verify 5`
--keep F            copies the folder of configuration, calibrations, recordings and report to F at the end

Each step prints its command and how long it took. The assistant works faster than a person: spacers and weights rest for a second.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = pathlib.Path(os.environ.get("DTS_BIN_DIR", SOURCE / "build/release/bin"))
ELF = pathlib.Path(os.environ.get("DTS_FIRMWARE_DIR", SOURCE / "build/release/firmware")) / "dts-firmware.elf"
LIMIT_S = 900.0
GAPS = "12.5,12,11,10,9,8,7,6.5"
LOADS = (245.2, 588.4)
HALF_MM = 129.0  # the sensors lie so far from the centre, along both axes


def weights() -> list:
    """Returns the rows of weights in the order in which `calibrate cop --grid 6 --verify 5` asks for them."""
    grid = [HALF_MM * (2 * i / 5 - 1) for i in range(6)]
    rows = [(x, y, load) for load in LOADS for row, y in enumerate(grid) for x in (grid if row % 2 == 0 else grid[::-1])]
    quarter = [HALF_MM * (i / 4 - 1) for i in range(5)]
    verified = [(quarter[column], quarter[row], LOADS[-1]) for row in range(5) for column in range(row + 1)]
    return rows + [verified[i * 14 // 4] for i in range(5)]


def write_weights(path: pathlib.Path):
    path.write_text("x_mm,y_mm,load_n\n" + "".join(f"{x},{y},{load}\n" for x, y, load in weights()))


class Evening:
    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="dts-", dir="/tmp"))  # short: a socket path has 107 bytes
        self.config = self.folder / "evening"
        shutil.copytree(SOURCE / "config", self.config)
        self.rig = self.config / "rigs/floor-board.toml"
        shutil.copy(self.rig, self.folder / "plate.toml")  # what the simulated plate is; the rig file changes
        (self.folder / "plate.toml").write_text(self.rig.read_text().replace("../sensors/", f"{self.config}/sensors/"))
        (self.config / "dtsd.toml").write_text(
            '[[rig]]\nname = "floor"\nfile = "rigs/floor-board.toml"\n'
            f'device = "serial:{self.folder}/board?channels=4&rate_hz=1000"\n')
        self.environment = {name: value for name, value in os.environ.items() if not name.startswith("DTSD_")}
        self.environment |= {"DTSD_RUNTIME_DIR": str(self.folder), "DTSD_STATE_DIR": str(self.folder / "state"),
                             "XDG_STATE_HOME": str(self.folder / "xdg")}
        self.board = self.daemon = None

    def close(self):
        self.stop()
        shutil.rmtree(self.folder)

    def stop(self):
        for process in (self.daemon, self.board):
            if process is not None:
                process.terminate()
                process.wait(LIMIT_S)
        self.daemon = self.board = None

    def begin(self, scene: str):
        """Starts the board with a scene, and dtsd."""
        self.stop()
        self.board = subprocess.Popen([PROGRAMS / "simavr_board", ELF, "--reset-on-open", "--rig", self.folder / "plate.toml",
                                       "--link", self.folder / "board", "--scene", scene], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.board.stdout.readline()
        with (self.folder / "log").open("ab") as log:
            self.daemon = subprocess.Popen([PROGRAMS / "dtsd", "--config", self.config / "dtsd.toml", "--foreground"],
                                           env=self.environment, stderr=log)
        end = time.monotonic() + LIMIT_S
        while True:
            done = subprocess.run([PROGRAMS / "dtsctl", "status", "--json"], env=self.environment, capture_output=True, text=True)
            if done.returncode == 0 and json.loads(done.stdout)["rigs"][0]["scans_total"] > 2000:  # two seconds
                return
            if time.monotonic() > end or self.daemon.poll() is not None:
                sys.exit("dtsd receives no scans:\n" + (self.folder / "log").read_text())
            time.sleep(0.1)

    def ctl(self, *words: str, is_quiet: bool = False) -> str:
        """Runs a command of the page, and prints it with what it says."""
        begun = time.monotonic()
        print(f"$ dtsctl {' '.join(words)}", flush=True)
        done = subprocess.run([PROGRAMS / "dtsctl", *words], env=self.environment, capture_output=True, text=True, timeout=LIMIT_S,
                              cwd=self.folder)
        print(f"    [{time.monotonic() - begun:.1f} s]")
        if done.returncode != 0:
            sys.exit(done.stdout + done.stderr + (self.folder / "log").read_text())
        if not is_quiet:
            print(done.stdout, end="")
        return done.stdout

    def enter_curves(self, report: dict):
        text = self.rig.read_text()
        for sensor in report["sensors"]:
            before, label, after = text.partition(f'label = "{sensor["sensor"]}"')
            text = before + label + after.replace('curve = "../sensors/hoa1405-assumed.toml"', f'curve = "{sensor["file"]}"', 1)
        self.rig.write_text(text)

    def enter_calibration(self, report: dict):
        text = self.rig.read_text().replace('estimator = "poly3"', "# estimator: that of the calibration", 1)
        self.rig.write_text(report["rig_file_line"] + "\n" + text)


def check_curves(evening: Evening):
    """dtsd accepts the rig file with the new curves, and the simulated plate with it."""
    assert "hoa1405-assumed" not in evening.rig.read_text(), evening.rig.read_text()
    evening.begin("sim:floor?seed=7&step_on_s=60")
    assert not doubts(evening), doubts(evening)
    text = evening.rig.read_text()
    files = re.findall(r'curve = "(.*?)"', text)
    evening.rig.write_text(text.replace(files[0], "w1 of another").replace(files[1], files[0]).replace("w1 of another", files[1]))
    evening.begin("sim:floor?seed=7&step_on_s=60")
    assert "sensor curves (w1, w2) were measured at other sensors (w2, w1)" in doubts(evening)[0], doubts(evening)
    print("dtsd runs with the curves that were measured, and names two that are exchanged")


def doubts(evening: Evening):
    """Returns dtsd's notices about the sensor curves."""
    return [notice for notice in json.loads(evening.ctl("status", "--json", is_quiet=True))["notices"] if "sensor curves" in notice]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--sensors-only", action="store_true")
    parser.add_argument("--write-weights", type=pathlib.Path)
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    if options.write_weights:
        write_weights(options.write_weights)
        return
    if options.keep and options.keep.exists():
        sys.exit(f"{options.keep} exists; name a folder that does not")
    begun = time.monotonic()
    evening = Evening()
    try:
        evening.begin("sim:floor?seed=7")
        evening.ctl("device", "list")
        evening.ctl("device", "test", "floor")

        evening.begin(f"sim:floor?contact=gaps&gaps_mm={GAPS}&step_on_s=10&hold_s=1.5&pause_s=0.5&ramp_s=0.1")
        curves = json.loads(evening.ctl("calibrate", "sensor", "--rig", "floor", "--sensor", "all", "--auto", "--hold", "0.5", "--json",
                                        "--out", str(evening.config / "sensors"), is_quiet=True))
        evening.enter_curves(curves)
        if options.sensors_only:
            check_curves(evening)
            return

        write_weights(evening.folder / "weights.csv")
        print("77 weights, some 2 s each:")
        evening.begin(f"sim:floor?contact=weights&weights={evening.folder}/weights.csv&step_on_s=15&hold_s=1.5&pause_s=0.5&ramp_s=0.1")
        cop = json.loads(evening.ctl("calibrate", "cop", "--rig", "floor", "--loads", "245.2,588.4", "--grid", "6", "--verify", "5",
                                     "--auto", "--hold", "0.5", "--json", "--out", str(evening.folder / "cop.toml"), is_quiet=True))
        errors = [max(abs(point["x_error_mm"]), abs(point["y_error_mm"])) for point in cop["verification"]["points"]]
        print(f"verification at {len(errors)} places: the largest error along an axis is {max(errors):.2f} mm")
        evening.enter_calibration(cop)

        evening.begin("sim:floor?seed=7&step_on_s=8")
        time.sleep(10)  # the person steps on 8 s after the start
        session = evening.ctl("session", "start", "--rig", "floor", "--protocol", "quiet-standing", "--subject", "P001").strip()
        evening.ctl("session", "trial", "next", "--rig", "floor")
        evening.ctl("watch", "floor/sway", "--count", "60", is_quiet=True)
        evening.ctl("session", "stop", "--rig", "floor")
        evening.ctl("session", "show", session)
        evening.ctl("session", "verify", session)
        evening.ctl("report", session, "--out", str(evening.folder / "report"))
        status = json.loads(evening.ctl("status", "--json", is_quiet=True))["rigs"][0]
        print(f"the page was followed in {(time.monotonic() - begun) / 60:.1f} min; {status['scans_total']} scans since the last start, "
              f"{status['gaps_total']} gaps")
    finally:
        evening.stop()
        if options.keep:
            shutil.copytree(evening.folder, options.keep, ignore=shutil.ignore_patterns("*.sock", "board"))
        evening.close()


main()
