#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A board at a pseudo-terminal beside a USB DAQ: dtsd with 16 channels at 1500 Hz, one after the other, in turns.

    board_bench.py BUILD [--seconds 20] [--rounds 3]     BUILD: build/release

Prints for each the processor time of dtsd in % of a core (its libraries too), and the time from a scan to the data socket. The DAQ is an
emulated USB-1608G behind the real libusb (usb_emulator, umockdev): its emulator is not in the processor time of dtsd, but umockdev's
part within dtsd is. The board is fake_board: it speaks the frames and lines of docs/board-frames.md.
"""
import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CHANNELS, RATE_HZ = 16, 1500
SOURCE = Path(__file__).resolve().parents[2]


class Daemon:
    """dtsd with one rig; `wrapper` precedes its command."""

    def __init__(self, build: Path, device: str, wrapper: list[str]) -> None:
        self.build = build
        self.folder = Path(tempfile.mkdtemp(prefix="dts-bench-"))
        shutil.copytree(SOURCE / "config", self.folder / "config")
        rig = self.folder / "config/rigs/floor-daq.toml"
        rig.write_text(rig.read_text().replace("rate_hz = 100.0", f"rate_hz = {RATE_HZ}.0"))
        (self.folder / "config/dtsd.toml").write_text(f'[[rig]]\nname = "floor"\nfile = "rigs/floor-daq.toml"\ndevice = "{device}"\n'
                                                      f'[storage]\ndirectory = "{self.folder}/state"\n')
        self.environment = {**os.environ, "DTSD_RUNTIME_DIR": str(self.folder / "run")}
        command = [*wrapper, str(build / "bin/dtsd"), "--config", str(self.folder / "config/dtsd.toml"), "--foreground"]
        self.log = open(self.folder / "log", "w")
        self.process = subprocess.Popen(command, env=self.environment, stdin=subprocess.PIPE, stdout=self.log, stderr=self.log, cwd=SOURCE)

    def rig(self) -> dict:
        words = [self.build / "bin/dtsctl", "status", "--json"]
        done = subprocess.run(words, env=self.environment, capture_output=True, text=True)
        return json.loads(done.stdout)["rigs"][0] if done.returncode == 0 else {"scans_total": 0}

    def wait(self) -> dict:
        end_s = time.monotonic() + 60
        while time.monotonic() < end_s:
            if (rig := self.rig())["scans_total"] > 2 * RATE_HZ:  # the start is over
                return rig
            time.sleep(0.2)
        sys.exit(f"no scans within 60 s:\n{(self.folder / 'log').read_text()}")

    def pid(self) -> int:
        """Returns the process of dtsd, which may be below the wrapper."""
        pid, program = self.process.pid, (self.build / "bin/dtsd").resolve()
        while Path(f"/proc/{pid}/exe").resolve() != program:
            pid = int(Path(f"/proc/{pid}/task/{pid}/children").read_text().split()[0])
        return pid

    def end(self) -> None:
        os.kill(self.pid(), signal.SIGTERM)
        self.process.wait(30)
        self.log.close()
        shutil.rmtree(self.folder)


def cpu_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def quantile_ms(before: dict, after: dict, share: float) -> float:
    """Returns the upper bound of the bucket of the histogram in which the share is."""
    earlier = [bucket["blocks_total"] for bucket in before["latency"]["buckets"]]
    buckets = [(bucket.get("upper_ms", float("inf")), bucket["blocks_total"] - count)
               for bucket, count in zip(after["latency"]["buckets"], earlier)]
    return next(upper for upper, count in buckets if count >= share * buckets[-1][1])


def measure(name: str, build: Path, device: str, wrapper: list[str], seconds: float) -> None:
    daemon = Daemon(build, device, wrapper)
    before, used_s, begun_s = daemon.wait(), cpu_s(daemon.pid()), time.monotonic()
    time.sleep(seconds)
    after, used_s, elapsed_s = daemon.rig(), cpu_s(daemon.pid()) - used_s, time.monotonic() - begun_s
    blocks = after["latency"]["buckets"][-1]["blocks_total"] - before["latency"]["buckets"][-1]["blocks_total"]
    mean_ms = (after["latency"]["sum_ms"] - before["latency"]["sum_ms"]) / max(blocks, 1)
    per_second = (after["scans_total"] - before["scans_total"]) / elapsed_s
    lost = after["lost_scans_total"] - before["lost_scans_total"]
    print(f"| {name} | {100 * used_s / elapsed_s:.1f} | {mean_ms:.2f} | {quantile_ms(before, after, 0.5):g} "
          f"| {quantile_ms(before, after, 0.99):g} | {per_second:.0f} | {lost} |", flush=True)
    daemon.end()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--rounds", type=int, default=3)
    words = parser.parse_args()
    build = words.build.resolve()
    channels = ",".join(str(channel) for channel in range(CHANNELS))
    print("| device | CPU, % of a core | latency, mean ms | p50 below ms | p99 below ms | scans/s | lost |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        image = Path(folder) / "fpga"  # stands for the maker's image: the emulator looks at its length only
        image.write_bytes(b"x" * 73_722)
        for _ in range(words.rounds):
            measure("mcc:1608g", build, f"mcc:1608g?channels={channels}&range_v=5&fpga={image}",
                    [str(build / "bin/usb_emulator"), "umockdev", "1608g", "--"], words.seconds)
            for name, arguments, options in (("serial: frames", ["scans_per_frame=7"], "format=frames"),
                                             ("serial: lines", ["lines=1", "counter=1"], "format=lines&counter=1")):
                board = subprocess.Popen([build / "tests/fake_board", "pty=1", f"channels={CHANNELS}", f"rate_hz={RATE_HZ}", *arguments],
                                         stdout=subprocess.PIPE, text=True)
                port = board.stdout.readline().strip() if board.stdout else ""
                measure(name, build, f"serial:{port}?{options}&channels={CHANNELS}&rate_hz={RATE_HZ}", [], words.seconds)
                board.terminate()
                board.wait()


if __name__ == "__main__":
    main()
