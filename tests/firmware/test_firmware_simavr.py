# SPDX-License-Identifier: Apache-2.0
"""The firmware in simavr against a host that was written from the description of the protocol. Every code is known.

As fast as simavr runs, and never faster than this host reads: no result depends on the speed of the machine.
DTS_FIRMWARE_SCANS: scans of the longest run (default 20,000).
"""

import os
import pathlib
import signal
import struct
import subprocess
import tempfile
import time
import unittest

from board_host import (CHANNEL, DESCRIBE, DESCRIPTOR, LIMIT_S, LOG, LOST, PATTERN, SCANS, START, STOP, Board, ScanChecker, conversion_of,
                        encode, wave)

MAKEFILE = pathlib.Path(__file__).resolve().parents[2] / "clients/firmware"

PATTERN_ON, STREAMING = 4, 8
PERIOD = 2000  # ticks at 1000 Hz
LONG_RUN = int(os.environ.get("DTS_FIRMWARE_SCANS", "20000"))


def started(board: Board, numerator: int = 0, denominator: int = 1) -> dict:
    """Describes the board, starts it, and returns the descriptor of the run."""
    board.describe()
    board.start(numerator, denominator)
    while True:
        descriptor = board.until(DESCRIPTOR)[-1]
        if descriptor["flags"] & STREAMING:
            board.damaged = 0  # the first frame after opening the port can be half of one
            return descriptor


def run_scans(board: Board, checker: ScanChecker, scans: int):
    while checker.scans + checker.lost < scans:
        checker.take(board.frame())


class Description(unittest.TestCase):
    def test_descriptor_and_channels(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            descriptor, channels = board.describe()
            self.assertEqual(descriptor["version"], 1)
            self.assertEqual(descriptor["bits"], 10)
            self.assertEqual(descriptor["rate"][0] / descriptor["rate"][1], 1000)
            self.assertEqual(descriptor["ticks_per_s"], 2_000_000)
            self.assertGreaterEqual(2**32 / descriptor["ticks_per_s"], 60)
            self.assertEqual(descriptor["flags"], 3)
            self.assertEqual(descriptor["serial"], "")
            self.assertEqual([channel["name"] for channel in channels], ["A0", "A1", "A2", "A3"])
            for channel in channels:
                self.assertEqual((channel["lowest"], channel["highest"], channel["unit"]), (1, 1022, "V"))
                self.assertEqual((channel["scale"], channel["offset"]), (5 / 1024, 0))

    def test_descriptor_every_five_seconds(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            board.ask("run 0")
            board.ask("reset")
            board.ask("run 500")
            self.assertEqual([frame["kind"] for frame in board.waiting()[-5:]], [DESCRIPTOR] + 4 * [CHANNEL])
            board.ask("run 20000")
            frames = board.waiting()
            self.assertEqual([frame["kind"] for frame in frames], 4 * [DESCRIPTOR])
            self.assertEqual({frame["flags"] for frame in frames}, {3})

    def test_what_is_no_command_is_skipped(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            board.describe()
            os.write(board.port, b"\x81\x82garbage of some length, and no zero for a while" + b"\0")
            os.write(board.port, encode(bytes([STOP]) * 240))
            os.write(board.port, encode(bytes([DESCRIBE]))[:-2] + b"\0")
            board.send(0x77)
            self.assertIn("rejected", board.until(LOG)[-1]["text"])
            descriptor, channels = board.describe()
            self.assertEqual((descriptor["flags"], len(channels)), (3, 4))


class Run(unittest.TestCase):
    def test_every_code_counter_and_tick(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            self.assertEqual(started(board)["rate"], (2_000_000, PERIOD))
            checker = ScanChecker(PERIOD)
            begun = time.monotonic()
            run_scans(board, checker, LONG_RUN)
            self.assertEqual((checker.lost, board.damaged), (0, 0))
            print(f"{checker.scans} scans x 4 channels at 1000 Hz in {time.monotonic() - begun:.0f} s: every code exact, none lost; "
                  f"stack {board.ask('stack')} bytes")

    def test_other_rates(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            for numerator, denominator, period in ((100, 1, 20_000), (1000, 3, 6000), (50_000, 1, PERIOD)):
                self.assertEqual(started(board, numerator, denominator)["rate"], (2_000_000, period))
                checker = ScanChecker(period)
                run_scans(board, checker, 100)
                self.assertEqual(checker.lost, 0)
                board.send(STOP)
                board.until(DESCRIPTOR, flags=3)

    def test_start_while_streaming_changes_nothing(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            started(board)
            checker = ScanChecker(PERIOD)
            run_scans(board, checker, 500)
            board.start(100)
            answers = 0
            while checker.scans < 3000:
                frame = board.frame()
                checker.take(frame)
                if frame["kind"] == DESCRIPTOR:
                    answers += 1
                    self.assertEqual((frame["rate"], frame["flags"]), ((2_000_000, PERIOD), 3 | STREAMING))
            self.assertGreaterEqual(answers, 1)

    def test_stop_sends_the_tail_and_the_next_start_is_a_new_run(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            runs = []
            for _ in range(3):
                started(board)
                checker = ScanChecker(PERIOD)
                run_scans(board, checker, 200)
                board.send(STOP)
                for frame in board.until(LOST, reason=4):
                    checker.take(frame)  # LOST: its counter is the one after the last scan
                self.assertEqual(checker.lost, 0)
                self.assertEqual(board.frame()["flags"], 3)
                runs.append(checker.run)
                self.assertNotIn(SCANS, [frame["kind"] for frame in board.until(DESCRIPTOR)])
            self.assertEqual(len(set(runs)), 3)

    def test_pattern(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            started(board)
            board.until(SCANS)
            board.send(PATTERN, b"\1")
            board.until(DESCRIPTOR, flags=3 | STREAMING | PATTERN_ON)
            for _ in range(50):
                frame = board.until(SCANS)[-1]
                for i, codes in enumerate(frame["scans"]):
                    self.assertEqual(codes, tuple(((frame["counter"] + i) * 7 + channel * 1000) % 2**15 for channel in range(4)))
            board.send(PATTERN, b"\0")
            board.until(DESCRIPTOR, flags=3 | STREAMING)
            checker = ScanChecker(PERIOD)
            run_scans(board, checker, 1000)
            self.assertEqual(checker.lost, 0)

    def test_counter_and_clock_wrap(self):
        with Board("dts-firmware-wrap.elf", "--fast") as board:
            board.open()
            self.assertEqual(board.describe()[0]["serial"], "wrap-1")
            board.ask("run 0")
            board.ask("reset")
            board.ask("run 100")
            board.waiting()
            board.start()
            board.ask("resume")  # 20 s before the clock wraps
            checker = ScanChecker(PERIOD)
            first = board.until(SCANS)[-1]
            self.assertEqual(first["counter"], 2**32 - 500)
            checker.take(first)
            wraps = 0
            while wraps == 0 or checker.scans < 2000:
                frame = board.until(SCANS)[-1]
                wraps += frame["ticks"] < checker.period * 100
                checker.take(frame)
                self.assertLess(checker.scans, 60_000, "the clock does not wrap")
            self.assertLess(checker.counter, 2**31)
            self.assertEqual(checker.lost, 0)

    def test_the_clock_is_that_of_the_conversions(self):
        """STARTs at many places between two overflows of the timer of 16 bits (32.768 ms): the ticks of the first scan are those at which
        its conversion began, but for the few us of an interrupt."""
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            board.ask("run 200")
            board.waiting()
            distances = []
            places = set()
            for i in range(60):
                board.start()
                board.ask("run 40")
                board.send(STOP)
                board.ask(f"run {110 + i % 3}")
                first = next(frame for frame in board.waiting() if frame["kind"] == SCANS)
                self.assertEqual(first["counter"], 0)
                distances.append(int(board.ask("began")) / 8 - first["ticks"])
                places.add(first["ticks"] % 65536 // 4096)
            self.assertGreater(len(places), 12, places)
            self.assertLess(max(distances) - min(distances), 60, distances)
            self.assertLess(abs(min(distances)), 10_000, "the clock begins within 5 ms of the reset")

    def test_reset_in_the_middle(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            runs = []
            for _ in range(3):
                started(board)
                checker = ScanChecker(PERIOD)
                run_scans(board, checker, 500)
                runs.append(checker.run)
                board.ask("reset")
                board.until(DESCRIPTOR, flags=3)
                for i in range(4):
                    board.until(CHANNEL, index=i)
            self.assertEqual(len(set(runs)), 3)
            self.assertLessEqual(board.damaged, 1)  # the frame that the last reset cut off
            started(board)
            frame = board.until(SCANS)[-1]
            self.assertEqual(frame["counter"], 0)
            self.assertEqual(frame["scans"][0], tuple(wave(channel, 0) for channel in range(4)))

    def test_a_loss_is_counted_exactly(self):
        """8 channels at 1000 Hz are more than the line carries. This build does not limit the rate."""
        with Board("dts-firmware-overrun.elf", "--fast") as board:
            board.open()
            board.ask("run 100")
            board.waiting()
            board.damaged = 0
            board.start()
            board.ask("run 10000")
            board.send(STOP)
            board.ask("run 1000")
            frames = board.waiting()
            self.assertEqual((frames[0]["channels"], frames[0]["rate"]), (8, (2_000_000, PERIOD)))
            checker = ScanChecker(PERIOD)
            for frame in frames:
                checker.take(frame)
            losses = [frame for frame in frames if frame["kind"] == LOST]
            self.assertEqual({frame["reason"] for frame in losses[:-1]}, {1})
            self.assertEqual((losses[-1]["reason"], losses[-1]["lost"]), (4, 0))
            # The board's time is the witness: so many scans were due between START and STOP. Each command takes some ms to arrive.
            self.assertTrue(9997 <= checker.scans + checker.lost <= 10_003, (checker.scans, checker.lost))
            self.assertGreater(checker.lost, 1000)
            self.assertEqual((checker.counter, board.damaged), (checker.scans + checker.lost, 0))

    def test_a_scan_that_is_due_during_another_one_is_late(self):
        """2000 Hz, and 8 conversions take longer than 0.5 ms: so scans are late all the time."""
        with Board("dts-firmware-overrun.elf", "--fast") as board:
            board.open()
            board.ask("run 100")
            board.waiting()
            board.damaged = 0
            board.start(2000)
            board.ask("run 5000")
            board.send(STOP)
            board.ask("run 1000")
            frames = board.waiting()
            self.assertEqual(frames[0]["rate"], (2_000_000, 1000))
            checker = ScanChecker(1000)
            for frame in frames:
                checker.take(frame)
            losses = [frame for frame in frames if frame["kind"] == LOST]
            self.assertIn(2, {frame["reason"] for frame in losses})
            self.assertEqual(losses[-1]["reason"], 4, "short frames must not keep STOP and its answer waiting")
            self.assertTrue(9994 <= checker.scans + checker.lost <= 10_006, (checker.scans, checker.lost))
            self.assertGreater(checker.scans, 500)
            self.assertEqual(board.damaged, 0)


class EightChannels(unittest.TestCase):
    def check_highest_rate(self, elf: str, period: int, described_ms: float):
        """10 s at the highest rate, with a DESCRIBE now and then: none is lost, and each is answered."""
        with Board(elf, "--fast") as board:
            board.open()
            board.ask("run 200")
            board.waiting()
            board.damaged = 0
            board.start(1000)
            asked = 0
            frames = []
            for _ in range(int(10_000 / described_ms)):
                board.ask(f"run {described_ms}")
                frames += board.waiting()
                board.send(DESCRIBE)
                asked += 1
            board.ask("run 5000")
            board.send(STOP)
            board.ask("run 1000")
            frames += board.waiting()
            self.assertEqual((frames[0]["channels"], frames[0]["rate"]), (8, (2_000_000, period)))
            checker = ScanChecker(period)
            for frame in frames:
                checker.take(frame)
            self.assertEqual((checker.lost, board.damaged), (0, 0))
            self.assertGreater(checker.scans, 14.9 * 2_000_000 / period)
            self.assertEqual(sum(frame["kind"] == CHANNEL for frame in frames), 8 * asked)
            self.assertEqual([(frame["reason"], frame["lost"]) for frame in frames if frame["kind"] == LOST], [(4, 0)])

    def test_at_115200_baud(self):
        self.check_highest_rate("dts-firmware-8.elf", 3345, 5000)

    def test_descriptions_do_not_lose_scans(self):
        """A DESCRIBE every 250 ms is more than the line carries beside the scans. Later ones wait, or are dropped."""
        with Board("dts-firmware-8.elf", "--fast") as board:
            board.open()
            board.ask("run 200")
            board.waiting()
            board.damaged = 0
            board.start(1000)
            for _ in range(40):
                board.ask("run 250")
                board.send(DESCRIBE)
            frames = board.waiting()
            checker = ScanChecker(3345)
            for frame in frames:
                checker.take(frame)
            self.assertEqual((checker.lost, board.damaged), (0, 0))
            self.assertGreater(checker.scans, 5900)
            self.assertIn(CHANNEL, {frame["kind"] for frame in frames})

    def test_at_500000_baud(self):
        self.check_highest_rate("dts-firmware-8-fast.elf", PERIOD, 250)


class Led(unittest.TestCase):
    def led(self, board: Board):
        words = board.ask("led 4000").split()
        return int(words[1]), float(words[3])

    def test_idle_blinks_slowly(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            board.describe()
            changes, on_ms = self.led(board)
            self.assertIn(changes, (3, 4, 5))
            self.assertTrue(1500 < on_ms < 2500, on_ms)

    def test_on_while_streaming_and_blinking_again_after_stop(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            started(board)
            board.until(SCANS)
            changes, on_ms = self.led(board)
            self.assertEqual(changes, 0)
            self.assertGreater(on_ms, 3900)
            self.assertIn(SCANS, [frame["kind"] for frame in board.until(DESCRIPTOR)])  # it was streaming all the time
            board.send(STOP)
            board.until(DESCRIPTOR, flags=3)
            self.assertIn(self.led(board)[0], (3, 4, 5))

    def test_fast_while_it_loses_data(self):
        with Board("dts-firmware-overrun.elf", "--fast") as board:
            board.open()
            started(board)
            board.until(LOST, reason=1)
            self.assertGreater(self.led(board)[0], 30)


class Commands(unittest.TestCase):
    def test_each_is_answered_by_a_descriptor_of_its_own(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.open()
            board.ask("run 200")
            board.waiting()
            start = encode(struct.pack("<BII", START, 0, 1))
            on, off = (encode(bytes([PATTERN, value])) for value in (1, 0))
            os.write(board.port, start + on + off + start + encode(bytes([STOP])) + on + encode(bytes([STOP])))
            board.ask("run 1000")
            flags = [frame["flags"] for frame in board.waiting() if frame["kind"] == DESCRIPTOR]
            self.assertEqual(flags, [11, 15, 11, 11, 3, 7, 3])


class Build(unittest.TestCase):
    """make in a folder of its own; avrdude is a script that says what it would write."""

    def make(self, *words: str):
        path = f"{self.folder}:{os.environ['PATH']}"
        return subprocess.run(["make", "-C", MAKEFILE, f"OUT={self.folder}", *words], env=os.environ | {"PATH": path},
                              capture_output=True, text=True)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "avrdude").write_text('#!/bin/sh\necho "writes $*"\n')
        (self.folder / "avrdude").chmod(0o755)

    def test_flash_and_size_use_the_build_that_exists(self):
        self.assertEqual(self.make("SERIAL=plate-9").returncode, 0)
        built = (self.folder / "dts-firmware.hex").read_bytes()
        self.assertIn(b"plate-9", (self.folder / "dts-firmware.elf").read_bytes())
        flashed = self.make("flash", "PORT=/dev/null")
        self.assertIn(f"flash:w:{self.folder}/dts-firmware.hex:i", flashed.stdout)
        self.assertEqual(self.make("size").returncode, 0)
        self.assertEqual((self.folder / "dts-firmware.hex").read_bytes(), built)

    def test_without_a_build_they_say_so(self):
        for target in ("flash", "size"):
            done = self.make(target)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("Build it first", done.stderr)
            self.assertNotIn("writes", done.stdout)

    def test_a_rate_that_the_timer_cannot_do_is_no_build(self):
        self.assertIn("RATE must be 31 to 1000 Hz", self.make("RATE=30").stderr)


class Port(unittest.TestCase):
    def test_the_link_ends_with_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            link = pathlib.Path(folder) / "board"
            for end in ("quit", signal.SIGTERM, signal.SIGINT):
                with Board("dts-firmware.elf", "--fast", "--link", str(link)) as board:
                    self.assertEqual(os.readlink(link), board.path)
                    if end == "quit":
                        board.ask("quit")
                    else:
                        board.process.send_signal(end)
                    self.assertEqual(board.process.wait(LIMIT_S), 0)
                self.assertFalse(link.is_symlink(), end)

    def test_a_link_of_another_program_stays(self):
        with tempfile.TemporaryDirectory() as folder:
            link = pathlib.Path(folder) / "board"
            with Board("dts-firmware.elf", "--fast", "--link", str(link)) as board:
                link.unlink()
                link.symlink_to("/dev/null")
                board.ask("quit")
                board.process.wait(LIMIT_S)
            self.assertEqual(os.readlink(link), "/dev/null")

    def test_reset_on_open(self):
        with Board("dts-firmware.elf", "--reset-on-open") as board:
            board.open()
            descriptor, channels = board.description()  # without DESCRIBE
            self.assertEqual((descriptor["flags"], len(channels)), (3, 4))

    def test_volts(self):
        with Board("dts-firmware.elf", "--fast") as board:
            board.ask("volts 0 1.25 2.5 6")
            board.open()
            started(board)
            self.assertEqual(board.until(SCANS)[-1]["scans"][-1], (0, 256, 512, 1023))


if __name__ == "__main__":
    unittest.main(verbosity=2)
