# SPDX-License-Identifier: Apache-2.0
"""What judge.py says of made samples: a leak, a step, noise, a queue that fills, descriptors that stay open."""
import contextlib
import csv
import io
import math
import random
import tempfile
import unittest
from collections.abc import Callable
from pathlib import Path

import judge
from judge import Sample

HOUR_S = 3600.0
LONG_S = 2 * HOUR_S
EVERY_S = 10.0


def samples_of(
    run_s: float, memory_mb: Callable[[float], float], descriptors: Callable[[float], int] = lambda _: 40, every_s: float = EVERY_S
) -> list[Sample]:
    times = [number * every_s for number in range(int(run_s / every_s))]
    return [Sample(at_s, memory_mb(at_s), descriptors(at_s), 0.1 * at_s) for at_s in times]


def leak(mb_per_hour: float, jitter_mb: float = 0.0) -> Callable[[float], float]:
    chance = random.Random(7)
    return lambda at_s: 40 + mb_per_hour * at_s / HOUR_S + chance.uniform(-jitter_mb, jitter_mb)


def faults_of(run_s: float, memory_mb: Callable[[float], float]) -> list[str]:
    return judge.judge("dtsd", samples_of(run_s, memory_mb)).faults


class LongRun(unittest.TestCase):
    def test_steady_memory_is_right(self) -> None:
        self.assertEqual(faults_of(LONG_S, leak(0.0)), [])
        self.assertEqual(faults_of(LONG_S, leak(0.0, jitter_mb=1.0)), [])

    def test_the_limit_is_300_kb_an_hour(self) -> None:
        self.assertEqual(faults_of(LONG_S, leak(0.29)), [])
        self.assertEqual(len(faults_of(LONG_S, leak(0.31))), 1)

    def test_a_leak_is_seen_in_noise(self) -> None:
        self.assertRegex(faults_of(LONG_S, leak(1.0, jitter_mb=1.0))[0], r"dtsd: memory grows: \+\d\.\d\d MB")

    def test_a_leak_of_a_day_is_seen(self) -> None:
        self.assertEqual(len(faults_of(12 * LONG_S, leak(0.35, jitter_mb=2.0))), 1)

    def test_a_fall_could_hide_a_leak(self) -> None:
        self.assertIn("memory falls", faults_of(LONG_S, leak(-1.0))[0])

    def test_growth_in_the_first_half_hour_does_not_count(self) -> None:
        self.assertEqual(faults_of(LONG_S, lambda at_s: 40 + 20 * min(at_s, 1700.0) / 1700), [])
        self.assertNotEqual(faults_of(LONG_S, lambda at_s: 40 + 20 * min(at_s, 3500.0) / 3500), [])

    def test_a_step_that_stays_is_growth(self) -> None:
        self.assertEqual(len(faults_of(LONG_S, lambda at_s: 40.0 if at_s < 1.2 * HOUR_S else 47.0)), 1)

    def test_a_queue_that_empties_again_is_none(self) -> None:
        self.assertEqual(faults_of(LONG_S, lambda at_s: 47.0 if HOUR_S < at_s < HOUR_S + 300 else 40.0), [])

    def test_what_is_too_unsteady_proves_nothing(self) -> None:
        self.assertEqual(faults_of(LONG_S, lambda at_s: 40 + 5 * math.sin(at_s / 200)), [], "the least of each end is the same")
        ends_higher = 3.0
        waves = lambda at_s: 40 + 5 * math.sin(at_s / 200) + ends_higher * (at_s > LONG_S - 700)  # noqa: E731
        self.assertIn("too unsteady to judge", faults_of(LONG_S, waves)[0])


class ShortRun(unittest.TestCase):
    def two_minutes(self, memory_mb: Callable[[float], float]) -> list[str]:
        return judge.judge("dtsd", samples_of(110.0, memory_mb, every_s=2.5)).faults

    def test_a_leak_of_128_bytes_a_scan_is_seen(self) -> None:
        scans_per_hour = 1500 * HOUR_S
        self.assertEqual(self.two_minutes(leak(0.0)), [])
        self.assertEqual(self.two_minutes(leak(32 * scans_per_hour / 1e6)), [], "queues that fill take as much")
        self.assertEqual(len(self.two_minutes(leak(128 * scans_per_hour / 1e6))), 1)

    def test_a_queue_that_is_full_for_a_moment_does_not_count(self) -> None:
        self.assertEqual(self.two_minutes(lambda at_s: 60.0 if at_s > 107 else 40.0), [])
        self.assertEqual(len(self.two_minutes(lambda at_s: 60.0 if at_s > 90 else 40.0)), 1)

    def test_half_an_hour_has_a_slope(self) -> None:
        self.assertEqual(faults_of(HOUR_S / 2, leak(0.4)), [])
        self.assertEqual(faults_of(HOUR_S / 2, leak(1.0)), [], "less than 1 MB in all")
        self.assertEqual(len(faults_of(HOUR_S / 2, leak(4.0))), 1)

    def test_a_run_without_samples_is_not_right(self) -> None:
        self.assertIn("only 0 samples", judge.judge("dtsd", []).faults[0])


class Descriptors(unittest.TestCase):
    def faults(self, descriptors: Callable[[float], int], run_s: float = LONG_S) -> list[str]:
        return judge.judge("dts-relay", samples_of(run_s, leak(0.0), descriptors)).faults

    def test_connections_that_come_and_go(self) -> None:
        self.assertEqual(self.faults(lambda at_s: 40 + 100 * (int(at_s / EVERY_S) % 3 > 0)), [])

    def test_some_that_stay_open(self) -> None:
        self.assertEqual(self.faults(lambda at_s: 40 + (at_s > HOUR_S) * judge.MOST_DESCRIPTORS), [])
        self.assertIn("descriptors grow from 40 to 45", self.faults(lambda at_s: 40 + (at_s > HOUR_S) * (judge.MOST_DESCRIPTORS + 1))[0])

    def test_a_short_run_allows_for_the_connections_of_peers(self) -> None:
        self.assertEqual(self.faults(lambda at_s: 40 + (at_s > 300) * 104, run_s=500.0), [])
        self.assertEqual(len(self.faults(lambda at_s: 40 + (at_s > 300) * 105, run_s=500.0)), 1)


class File(unittest.TestCase):
    def judged(self, memory_mb: Callable[[float], float], run_s: float = LONG_S, tail: str = "") -> tuple[int, str]:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "soak.csv"
            with file.open("w", newline="") as lines:
                table = csv.writer(lines)
                table.writerow(judge.COLUMNS)
                for sample in samples_of(run_s, memory_mb):
                    for process in ("dtsd", "dts-relay"):
                        table.writerow((sample.at_s, process, sample.resident_mb, sample.descriptors, sample.cpu_s, "", "", ""))
                lines.write(tail)
            output = io.StringIO()
            with contextlib.redirect_stdout(output), contextlib.redirect_stderr(io.StringIO()):
                status = judge.main(file)
            return status, output.getvalue()

    def test_an_interrupted_run_is_judged_by_its_file(self) -> None:
        status, table = self.judged(leak(0.0))
        self.assertEqual(status, 0)
        self.assertIn("| dtsd | 40.0 to 40.0 MB, +0.00 +- 0.00 MB an hour; 40 to 40 descriptors; 719 s of CPU time, 10 % of a core |", table)
        self.assertIn("| dts-relay |", table)
        self.assertEqual(self.judged(leak(2.0))[0], 1)

    def test_an_hour_has_the_limit_of_long_runs(self) -> None:
        self.assertEqual(self.judged(leak(0.45), run_s=HOUR_S - 10)[0], 1)

    def test_a_row_that_is_not_complete_is_left_out(self) -> None:
        self.assertEqual(self.judged(leak(0.0), tail="7190.0,dtsd,4")[0], 0)


if __name__ == "__main__":
    unittest.main()
