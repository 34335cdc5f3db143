# SPDX-License-Identifier: Apache-2.0
import json
import signal
import threading
import time
import unittest
from collections.abc import Callable
from typing import Any

import numpy as np
from support import DaemonProcess, WithDaemon, first

import dts


class Streams(WithDaemon):
    def test_BlocksFollowEachOther(self) -> None:
        stream = self.daemon.stream("floor/cop")

        blocks = first(stream, 20)

        scans = np.concatenate([block.scans for block in blocks])
        np.testing.assert_array_equal(np.diff(scans), 1)
        self.assertEqual(sum(block.lost_scans for block in blocks), 0)
        self.assertEqual(blocks[0].channels, ("ml_mm", "ap_mm", "load_n"))
        self.assertEqual(blocks[0].units, ("mm", "mm", "N"))
        self.assertEqual(blocks[0].rate, 100)
        self.assertEqual(blocks[0].values.dtype, np.float32)
        self.assertEqual(blocks[0].values.shape, (len(blocks[0]), 3))
        self.assertEqual(stream.statistics.malformed, 0)

    def test_TimesAreThoseOfThisHost(self) -> None:
        stream = self.daemon.stream("floor/cop", "floor/aux")
        block = next(block for block in stream if block.topic == "floor/aux")

        age_s = time.monotonic() - block.time_s[-1]

        self.assertTrue(-0.1 < age_s < 60.0, age_s)
        self.assertLess(abs(block.utc[-1].astype(np.int64) * 1e-9 - time.time()), 60.0)
        np.testing.assert_allclose(np.diff(block.time_s), 0.01, atol=1e-6)

    def test_ValuesAreWhatDtsctlShows(self) -> None:
        # requirement: LIB-1
        stream = self.daemon.stream("floor/cop")
        shown = [json.loads(line) for line in self.process.dtsctl("watch", "floor/cop", "--count", "20", "--jsonl").splitlines()]

        scans: dict[int, list[float]] = {}
        for block in stream:
            scans.update(zip(block.scans.tolist(), block.values.tolist(), strict=True))
            if block.scans[-1] >= shown[-1]["first_scan"] + len(shown[-1]["values"]):
                break

        for line in shown:
            for offset, values in enumerate(line["values"]):
                known = [np.nan if value is None else np.float32(value) for value in values]
                np.testing.assert_array_equal(np.float32(scans[line["first_scan"] + offset]), np.float32(known))

    def test_SilenceEndsInTimeoutAndIterationGoesOn(self) -> None:
        reaches = self.daemon.events("floor/trigger", timeout=0.2)

        with self.assertRaises(dts.Timeout):
            next(reaches)
        with self.assertRaises(dts.Timeout):
            next(reaches)

    def test_ClosedStreamSaysSo(self) -> None:
        with self.daemon.stream("floor/cop") as stream:
            next(stream)

        with self.assertRaises(dts.InvalidArgument):
            next(stream)

    def test_InterruptArrivesWhileWaiting(self) -> None:
        events = self.daemon.events("floor/trigger", timeout=600)
        # A shell starts background jobs with SIGINT ignored.
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        begun_s = time.monotonic()

        with self.assertRaises(KeyboardInterrupt):
            threading.Timer(0.3, signal.raise_signal, (signal.SIGINT,)).start()
            next(events)

        self.assertLess(time.monotonic() - begun_s, 300.0)  # not only when the wait is over


class Recording(WithDaemon):
    def test_RecordIsAsLongAsAskedFor(self) -> None:
        cop = self.daemon.record("floor/cop", seconds=1.5)

        self.assertEqual(len(cop), 150)
        self.assertEqual(cop.gaps, ())
        np.testing.assert_array_equal(np.diff(cop.scans), 1)
        np.testing.assert_allclose(np.diff(cop.time_s), 0.01, atol=1e-4)
        self.assertEqual(cop["load_n"].shape, (150,))
        self.assertEqual((cop.utc[-1] - cop.utc[0]).astype(int) // 10**7, 149)


class Events(WithDaemon):
    def test_MarkComesAsEventAtItsScan(self) -> None:
        events = self.daemon.events("floor/")
        latest = next(event for event in events if event.kind == "device")
        (mark,) = self.daemon.mark("eyes closed", "floor")
        event = next(event for event in events if event.kind == "marker")

        self.assertEqual(latest.fields["state"], "streaming")
        self.assertEqual(event.fields, {"text": "eyes closed"})
        self.assertEqual((event.rig, event.segment, event.scan), ("floor", mark.segment, mark.scan))
        assert event.message is not None
        self.assertEqual(event.message.marker.text, "eyes closed")

    def test_SwayIsToldWithMeasures(self) -> None:
        event = next(self.daemon.events("floor/sway"))

        self.assertTrue(event.fields["is_preliminary"])
        self.assertEqual(event.fields["measures"]["MVELO"]["unit"], "mm/s")
        self.assertIsInstance(event.fields["flags"], list)


class Commands(WithDaemon):
    def test_RigsAndProtocolsAreToldByName(self) -> None:
        self.assertEqual(set(self.daemon.rigs), {"floor", "chair"})
        self.assertIn("quiet-standing", self.daemon.protocols())
        self.assertEqual(len(self.daemon.rigs["floor"].sensors), 4)
        self.assertTrue(self.daemon.devices().devices)
        self.daemon.record("floor/cop", 1.5)  # a test of the device needs a second of samples
        self.assertEqual(len(self.daemon.test_device("floor").channels[:4]), 4)

    def test_RefusalsHaveTheirClassAndSayMore(self) -> None:
        refusals: list[tuple[type[dts.Error], str, Callable[[], object]]] = [
            (dts.NotFound, "floor/cop", lambda: self.daemon.stream("floor/copp")),
            (dts.NotFound, "floor/cop", lambda: self.daemon.stream()),
            (dts.NotFound, "floor/marker", lambda: self.daemon.events("flor/")),
            (dts.NotFound, "ceiling'\n  known: ", lambda: self.daemon.tare("ceiling")),
            (dts.NotFound, "20000101T000000Z-floor-1", lambda: self.daemon.session("20000101T000000Z-floor-1")),
            (dts.InvalidArgument, "quiet-standing", lambda: self.daemon.start_session("floor", "quiet-standing", fields={"shoe_size": 43})),
            (dts.InvalidArgument, "text", lambda: self.daemon.mark("")),
        ]
        for kind, words, command in refusals:
            with self.subTest(words), self.assertRaises(kind) as raised:
                command()
            self.assertRegex(f"{raised.exception.what}\n  {raised.exception.hint}", words)

    def test_CommandsComeFromSeveralThreads(self) -> None:
        versions: list[str] = []
        threads = [threading.Thread(target=lambda: versions.append(self.daemon.status().version)) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

        self.assertEqual(len(versions), 8)


class Restart(unittest.TestCase):
    def setUp(self) -> None:
        self.process = DaemonProcess()
        self.addCleanup(self.process.close)

    def test_StreamGoesOnAfterARestartAndSaysSo(self) -> None:
        with self.process.connect() as daemon:
            stream = daemon.stream("floor/cop", timeout=60)
            next(stream)
            self.process.stop(signal.SIGKILL)
            self.process.start()

            block = next(block for block in stream if block.is_restart)

            self.assertFalse(block.is_loss_exact)
            self.assertFalse(next(stream).is_restart)
            self.assertEqual(stream.statistics.restarts, 1)
            self.assertGreaterEqual(stream.statistics.interruptions, 1)
            self.assertLess(daemon.status().uptime_s, 60.0)

    def test_DeadDaemonIsUnreachable(self) -> None:
        with self.process.connect() as daemon:
            stream = daemon.stream("floor/cop", timeout=4)
            self.process.stop(signal.SIGKILL)
            try:
                with self.assertRaises(dts.Unreachable):
                    for _ in stream:
                        pass
                with self.assertRaisesRegex(dts.Unreachable, "no program listens"):
                    daemon.status()
            finally:
                self.process.start()


class Gap(unittest.TestCase):
    @staticmethod
    def record_across_a_gap(at_s: float) -> tuple[dts.Samples, dts.Recording, Any] | None:
        """A record of a daemon whose device has a gap `at_s` after its start, the session's recording, and what the daemon says of it; None
        when the machine was too slow to be there in time."""
        process = DaemonProcess(devices={"sim:floor?seed=7": f"sim:floor?seed=7&fault=overrun&fault_at_s={at_s:g}&fault_for_s=0.25"})
        try:
            with process.connect() as daemon:
                with daemon.start_session("floor", "free") as session:
                    cop = daemon.record("floor/cop", at_s + 1.0)
                part = daemon.session(session.id).parts[0]
                return (cop, dts.load(part.file), part) if cop.segments[0] == 0 else None
        finally:
            process.close()

    def test_GapOfTheDeviceIsListedInARecordAndInARecording(self) -> None:
        for at_s in (4.0, 15.0, 60.0):
            if (recorded := self.record_across_a_gap(at_s)) is not None:
                break
        assert recorded is not None, "a minute is enough for any machine"

        cop, recording, part = recorded
        (gap,) = cop.gaps
        self.assertEqual(cop.segments[gap.index], 1)
        self.assertEqual(gap.reason, "overrun")
        self.assertEqual((gap.scans, gap.is_exact), (25, True))
        self.assertEqual(len(cop) + gap.scans, 100 * (at_s + 1.0))
        self.assertEqual(recording.losses, (dts.Loss("overrun", 1, 25),))
        self.assertEqual([(loss.gaps_total, loss.lost_scans_total) for loss in part.losses], [(1, 25)])
        self.assertEqual(recording["cop"].gaps[0].scans, 25)


if __name__ == "__main__":
    unittest.main()
