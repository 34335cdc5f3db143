# SPDX-License-Identifier: Apache-2.0
"""Sixteen channels at 1500 Hz, recorded, with eight clients: five read, two are stuck, one is hostile.

    soak.py [--minutes 2]

Prints a Markdown table and fails when a scan is missing that nobody told of, a file is not whole, memory or descriptors grow, or the
attackers were not there."""
import argparse
import json
import os
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))
from support import DaemonProcess  # noqa: E402

HERE = Path(__file__).resolve().parent
RATE_HZ = 1500
STREAMS = ("chair/raw", "chair/deflection", "chair/transient")
READERS = 5
STUCK = 2
BATCHES = 20  # of samples, for the slope of the memory
WARM_UP_S = 60.0  # rings, heaps and the peers' queues fill: measured +7.5 MiB in the first 40 s, +0.4 MiB in the next 6 min
MOST_KIB = 1024  # of growth that counts whatever its slope
SHORT_S = 600.0  # a shorter run says nothing of the slope
MOST_SHORT_KIB = 5 * 1024  # on a busy machine queues of peers fill after the warm-up, too: measured 3.7 MiB. A leak of 64 bytes a scan is more
MOST_KIB_PER_HOUR = 512.0  # beyond the noise of the slope; what leaks per block would be a hundred times that


def memory_slope(samples: list[tuple[float, int, int]]) -> tuple[float, float]:
    """KiB an hour, and twice the standard error of the fit. Memory goes in steps, so that neighbouring samples tell the same: the line goes
    through the means of batches, which are nearly independent in a long run. In a short one the true error is larger than this."""
    size = max(1, len(samples) // BATCHES)
    batches = [samples[at : at + size] for at in range(0, len(samples) - size + 1, size)]
    hours = [statistics.fmean(sample[0] for sample in batch) / 3600 for batch in batches]
    kib = [statistics.fmean(sample[1] for sample in batch) for batch in batches]
    line = statistics.linear_regression(hours, kib)
    residual = sum((y - line.intercept - line.slope * x) ** 2 for x, y in zip(hours, kib))
    spread = sum((x - statistics.fmean(hours)) ** 2 for x in hours)
    return line.slope, 2 * (residual / (len(hours) - 2) / spread) ** 0.5


def state_of(child: "subprocess.Popen[str]") -> str:
    """As ps says it: S sleeps, R runs, T is stopped, Z has ended."""
    return Path(f"/proc/{child.pid}/stat").read_text().rpartition(")")[2].split()[0]


class Soak:
    def __init__(self, minutes: float) -> None:
        self.seconds = 60 * minutes
        self.daemon = DaemonProcess(chair_streams=("raw", "deflection", "transient", "aux"))
        self.children: list[subprocess.Popen[str]] = []
        self.samples: list[tuple[float, int, int]] = []  # s, KiB, descriptors
        self.faults: list[str] = []

    def close(self) -> None:
        for child in self.children:
            child.kill()
            child.wait()
        self.daemon.close()

    def run(self) -> None:
        readers = [self._start("client.py", str(self.seconds), *STREAMS) for _ in range(READERS)]
        stuck = [self._start("client.py", str(self.seconds), *STREAMS) for _ in range(STUCK)]
        for child in readers + stuck:
            assert child.stdout is not None
            assert child.stdout.readline() == "reading\n", "a client got nothing at all"
        for child in stuck:
            child.send_signal(signal.SIGSTOP)
        hostile = self._start("hostile.py", self.daemon.control, f"ipc://{self.daemon.folder}/data.sock")
        session = self.daemon.dtsctl("session", "start", "--rig", "chair", "--protocol", "free").strip()
        self._watch(self.seconds - 10)
        self._check_attackers(hostile, stuck)
        self.daemon.dtsctl("session", "stop", "--rig", "chair")
        self._check_status()
        self._check_recording(session)
        for number, child in enumerate(readers):
            self._check_reader(number, child)
        self._check_growth()

    def _start(self, program: str, *words: str) -> "subprocess.Popen[str]":
        child = subprocess.Popen([sys.executable, HERE / program, *words], env=self.daemon.environment, stdout=subprocess.PIPE, text=True)
        self.children.append(child)
        return child

    def _watch(self, seconds: float) -> None:
        begun_s = time.monotonic()
        every_s = min(10.0, seconds / 40)
        while (elapsed_s := time.monotonic() - begun_s) < seconds:
            self.samples.append((elapsed_s, *self._use()))
            if sys.stderr.isatty():
                print(f"\r{elapsed_s / 60:.1f} of {seconds / 60:.1f} min, {self.samples[-1][1] / 1024:.1f} MiB", end="", file=sys.stderr)
            time.sleep(every_s)

    def _use(self) -> tuple[int, int]:
        process = Path(f"/proc/{self.daemon.pid}")
        resident = next(line for line in (process / "status").read_text().splitlines() if line.startswith("VmRSS"))
        return int(resident.split()[1]), len(os.listdir(process / "fd"))

    def _check_attackers(self, hostile: "subprocess.Popen[str]", stuck: "list[subprocess.Popen[str]]") -> None:
        """A daemon that nobody attacked has not stood anything."""
        ended = hostile.poll()
        stopped = sum(state_of(child) == "T" for child in stuck)
        print(f"| hostile client | {'ran to the end' if ended is None else f'ended with {ended}'} |")
        print(f"| stuck clients | {stopped} of {len(stuck)} still stopped |")
        self._expect(ended is None, f"the hostile client ended with {ended}: for some of the time nobody attacked")
        self._expect(stopped == len(stuck), f"only {stopped} of {len(stuck)} stuck clients were still there")

    def _check_status(self) -> None:
        status = json.loads(self.daemon.dtsctl("status", "--json"))
        rejected = status["rejected_requests_total"]
        print(f"| daemon: rejected_requests_total | {rejected} |")
        self._expect(rejected > 0, "the daemon rejected nothing: the hostile client did not reach it")
        chair = next(rig for rig in status["rigs"] if rig["rig"]["name"] == "chair")
        for what in ("lost_scans_total", "gaps_total", "dropped_blocks_total"):
            print(f"| daemon: {what} | {chair[what]} |")
            self._expect(chair[what] == 0, f"{what} is {chair[what]}")

    def _check_recording(self, session: str) -> None:
        part = json.loads(self.daemon.dtsctl("session", "show", session, "--json"))["parts"][0]
        verified = subprocess.run(
            [self.daemon.program("dtsctl"), "session", "verify", session], env=self.daemon.environment, capture_output=True, text=True
        )
        print(f"| recording | {part['duration_s']:.1f} s, {part['scans']} scans, {part['state']} |")
        self._expect(verified.returncode == 0, f"the recording is damaged: {verified.stdout}{verified.stderr}")
        self._expect(part["state"] == "complete", f"the recording is {part['state']}")
        self._expect(abs(part["scans"] - part["duration_s"] * RATE_HZ) < RATE_HZ / 10, "the recording has a hole")

    def _check_reader(self, number: int, child: "subprocess.Popen[str]") -> None:
        text, _ = child.communicate(timeout=120)
        heard = json.loads(text)
        counts = heard["counts"].values()
        missed = sum(count["missed"] for count in counts)
        unexcused = missed - sum(count["excused"] for count in counts)
        known = [count["scans"] + count["missed"] for count in counts]
        late = f"blocks at most {heard['oldest_s']:.1f} s old, at most {heard['starved_s']:.1f} of 4 s without a core"
        print(f"| reader {number + 1} | {min(known)} scans of each of {len(known)} streams, {missed} missed, {late} |")
        # A reader that waits for a core for longer than its queue lasts loses blocks right after. Any other loses nothing.
        self._expect(unexcused == 0, f"reader {number + 1} missed {unexcused} scans, and had not waited for a core before")
        self._expect(min(known) > (self.seconds - 1) * RATE_HZ, f"reader {number + 1} knows of {min(known)} scans only")

    def _check_growth(self) -> None:
        begin_s = min(WARM_UP_S, self.samples[-1][0] / 2)
        warm = [sample for sample in self.samples if sample[0] >= begin_s]
        slope, noise = memory_slope(warm)
        # The least of some samples: the queue of a reader that had to wait is empty again in one of them.
        first, last = (min(sample[1] for sample in samples) for samples in (warm[:5], warm[-5:]))
        per_hour = f"{slope / 1024:+.2f} +- {noise / 1024:.2f} MiB an hour (2 standard errors)"
        print(f"| memory | {first / 1024:.1f} to {last / 1024:.1f} MiB, {per_hour} |")
        print(f"| descriptors | {min(sample[2] for sample in warm)} to {max(sample[2] for sample in warm)} |")
        # What is within two standard errors is no growth; a fit that is noisier than the limit clears nobody.
        is_small = slope - noise <= MOST_KIB_PER_HOUR and noise <= MOST_KIB_PER_HOUR
        most = MOST_SHORT_KIB if self.seconds < SHORT_S else MOST_KIB
        self._expect(is_small or last - first < most, f"memory grows by {last - first} KiB, {slope:.0f} +- {noise:.0f} KiB an hour")
        # The least of some samples: the hostile client's connections come and go.
        begun, ended = (min(sample[2] for sample in samples) for samples in (warm[:5], warm[-5:]))
        self._expect(ended <= begun + 4, "descriptors grow")

    def _expect(self, holds: bool, fault: str) -> None:
        if not holds:
            self.faults.append(fault)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=2.0)
    soak = Soak(parser.parse_args().minutes)
    try:
        print(f"| {soak.seconds / 60:.0f} min, 16 x {RATE_HZ} Hz, {READERS} readers, {STUCK} stuck, 1 hostile | |\n|---|---|")
        soak.run()
    finally:
        soak.close()
    for fault in soak.faults:
        print(f"soak: {fault}", file=sys.stderr)
    return 1 if soak.faults else 0


if __name__ == "__main__":
    sys.exit(main())
