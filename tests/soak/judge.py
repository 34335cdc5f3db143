# SPDX-License-Identifier: Apache-2.0
"""Judges the memory and descriptors of one process from samples of a run. All memory is in MB (1,000,000 bytes).

    judge.py FILE.csv    judges the samples that a run has written so far, also of an interrupted one
"""
import csv
import dataclasses
import statistics
import sys
from collections import defaultdict
from pathlib import Path

BATCHES = 20  # of samples, for the slope of the memory
ENDS = 5  # samples at least at each end, of which the least counts

# A run stops taking samples some seconds before its end, so its last sample is a little before 10 or 60 min.
SHORT_S = 580.0  # a shorter run says nothing of the slope
SHORT_WARM_UP_S = 60.0  # rings, heaps and the peers' queues fill: measured +7.5 MB in the first 40 s, +0.4 MB in the next 6 min
SHORT_MOST_MB = 5.0  # of growth. On a busy machine queues of peers fill after the warm-up, too: measured 3.8 MB. 128 bytes a scan are more
MIDDLE_MOST_MB = 1.0
MIDDLE_MOST_MB_PER_HOUR = 0.5
LONG_S = 3500.0
LONG_WARM_UP_S = 1800.0
LONG_MOST_MB_PER_HOUR = 0.3  # what leaks per block would be a hundred times that
MOST_DESCRIPTORS = 4  # of growth
HELD = {"dts-gateway": 16, "dts-relay": 100}  # connections that peers open and close all the time: at most, by process


@dataclasses.dataclass(frozen=True)
class Sample:
    """What a process used at an instant of the run."""

    at_s: float
    resident_mb: float
    descriptors: int
    cpu_s: float


@dataclasses.dataclass(frozen=True)
class Verdict:
    row: str  # of a Markdown table
    faults: list[str]


def memory_slope(samples: list[Sample]) -> tuple[float, float]:
    """Returns MB an hour, and twice the standard error of the fit. Memory goes in steps, so neighbouring samples are nearly the same: the line
    goes through the means of batches, which are nearly independent in a long run. In a short one the true error is larger than this."""
    size = max(1, len(samples) // BATCHES)
    batches = [samples[at : at + size] for at in range(0, len(samples) - size + 1, size)]
    hours = [statistics.fmean(sample.at_s for sample in batch) / 3600 for batch in batches]
    resident_mb = [statistics.fmean(sample.resident_mb for sample in batch) for batch in batches]
    line = statistics.linear_regression(hours, resident_mb)
    residual = sum((y - line.intercept - line.slope * x) ** 2 for x, y in zip(hours, resident_mb))
    spread = sum((x - statistics.fmean(hours)) ** 2 for x in hours)
    return line.slope, 2 * (residual / (len(hours) - 2) / spread) ** 0.5


def memory_fault(growth_mb: float, slope: float, noise: float, run_s: float, judged_s: float) -> str:
    """Returns what is wrong with the memory, or "". What is within the noise is no growth; a fit that is noisier than the limit proves nothing,
    unless the ends show that the memory is the same."""
    measured = f"{growth_mb:+.2f} MB, {slope:+.2f} +- {noise:.2f} MB an hour"
    if run_s < SHORT_S:
        return "" if growth_mb < SHORT_MOST_MB else f"memory grows: {measured}"
    if run_s < LONG_S:
        is_small = slope - noise <= MIDDLE_MOST_MB_PER_HOUR and noise <= MIDDLE_MOST_MB_PER_HOUR
        return "" if is_small or growth_mb < MIDDLE_MOST_MB else f"memory grows: {measured}"
    if abs(slope) - noise > LONG_MOST_MB_PER_HOUR:  # a fall, too: it could hide a leak
        return f"memory {'grows' if slope > 0 else 'falls'}: {measured}"
    if noise > LONG_MOST_MB_PER_HOUR and abs(growth_mb) > LONG_MOST_MB_PER_HOUR * judged_s / 3600:
        return f"memory is too unsteady to judge: {measured}. Repeat the run on an idle machine"
    return ""


def judge(process: str, samples: list[Sample]) -> Verdict:
    """Judges the samples of one process. A short run has too few of them to tell connections that peers hold from growth."""
    run_s = samples[-1].at_s if samples else 0.0
    begin_s = LONG_WARM_UP_S if run_s >= LONG_S else min(SHORT_WARM_UP_S, run_s / 2)
    warm = [sample for sample in samples if sample.at_s >= begin_s]
    if len(warm) < 2 * ENDS:
        return Verdict(f"| {process} | too few samples to judge |", [f"{process}: only {len(warm)} samples after the first {begin_s:.0f} s"])
    slope, noise = memory_slope(warm)
    # The least of some samples: the queue of a reader that had to wait, or a peer's connection, is gone in one of them.
    ends = max(ENDS, len(warm) // 10)
    first_mb, last_mb = (min(sample.resident_mb for sample in part) for part in (warm[:ends], warm[-ends:]))
    first_fds, last_fds = (min(sample.descriptors for sample in part) for part in (warm[:ends], warm[-ends:]))
    judged_s = warm[-1].at_s - warm[0].at_s
    cpu = (warm[-1].cpu_s - warm[0].cpu_s) / judged_s
    faults = [fault] if (fault := memory_fault(last_mb - first_mb, slope, noise, run_s, judged_s)) else []
    most_fds = first_fds + MOST_DESCRIPTORS + (HELD.get(process, 0) if run_s < LONG_S else 0)
    if last_fds > most_fds:
        faults.append(f"descriptors grow from {first_fds} to {last_fds}")
    row = (
        f"| {process} | {first_mb:.1f} to {last_mb:.1f} MB, {slope:+.2f} +- {noise:.2f} MB an hour; {first_fds} to {last_fds} descriptors; "
        f"{samples[-1].cpu_s:.0f} s of CPU time, {100 * cpu:.0f} % of a core |"
    )
    return Verdict(row, [f"{process}: {fault}" for fault in faults])


COLUMNS = ("at_s", "process", "resident_mb", "descriptors", "cpu_s", "lost_scans", "gaps", "dropped_blocks")


def read(file: Path) -> dict[str, list[Sample]]:
    """Returns the samples of each process."""
    samples = defaultdict(list)
    with file.open(newline="") as lines:
        for row in csv.DictReader(lines):
            if row["cpu_s"] is None or row[COLUMNS[-1]] is None:
                continue  # the run was interrupted while it wrote this row
            sample = Sample(float(row["at_s"]), float(row["resident_mb"]), int(row["descriptors"]), float(row["cpu_s"]))
            samples[row["process"]].append(sample)
    return samples


def main(file: Path) -> int:
    samples = read(file)
    if not samples:
        print(f"{file} has no samples", file=sys.stderr)
        return 1
    print(f"| {file.name} | |\n|---|---|")
    verdicts = [judge(process, of_process) for process, of_process in samples.items()]
    for verdict in verdicts:
        print(verdict.row)
    for fault in (faults := [fault for verdict in verdicts for fault in verdict.faults]):
        print(f"soak: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1])))
