# SPDX-License-Identifier: Apache-2.0
import csv
import random
import shutil
import struct
import tempfile
import unittest
from pathlib import Path

import numpy as np
from support import WithDaemon

import dts


class OwnRecording(WithDaemon):
    """A recording just made, beside what the C++ programs say of it."""

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        with cls.process.connect() as daemon:
            with daemon.start_session("chair", label="for the tests") as session:
                session.mark("comma, and \"quotes\"")
                daemon.record("chair/transient", 6.0)
            cls.file = daemon.session(session.id).parts[0].file
        cls.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.process.dtsctl("session", "export", cls.file, "--format", "csv", "--out", str(cls.folder))

    def test_EveryValueIsThatOfTheCsvExport(self) -> None:
        recording = dts.load(self.file)

        self.assertEqual(recording.damage, "")
        for name in ("raw", "filtered", "deflection", "transient", "aux", "quality"):
            if name not in recording:
                continue
            stream = recording[name]
            (exported,) = self.folder.glob(f"*_{name}.csv")
            with exported.open(newline="") as file:
                rows = list(csv.reader(file))[1:]
            with self.subTest(name):
                values = np.array([[float(cell) if cell else np.nan for cell in row[3:]] for row in rows])
                np.testing.assert_array_equal(stream.values, values.astype(stream.values.dtype))
                np.testing.assert_array_equal(stream.segments, [int(row[1]) for row in rows])
                np.testing.assert_array_equal(stream.scans, [int(row[2]) for row in rows])
                origin_s = recording["raw"].stamps_s[0]
                np.testing.assert_allclose(stream.stamps_s - origin_s, [float(row[0]) for row in rows], rtol=0, atol=1e-8)
        self.assertGreater(len(recording["raw"]), 8000)

    def test_EveryEventIsThatOfTheCsvExport(self) -> None:
        events = dts.load(self.file).events

        (exported,) = self.folder.glob("*_events.csv")
        with exported.open(newline="") as file:
            rows = sorted((int(row["scan"]), row["event"]) for row in csv.DictReader(file))
        self.assertEqual(sorted((event.scan, event.kind) for event in events), rows)
        self.assertIn("comma, and \"quotes\"", [event.fields.get("text") for event in events])

    def test_FileCutAnywhereIsReadUpToThere(self) -> None:
        whole = Path(self.file).read_bytes()
        full = dts.load(self.file)
        header_end = 9 + struct.unpack_from("<I", whole, 5)[0]  # the file header stands first, its length in four bytes
        generator = random.Random(1)
        cut = self.folder / "cut.xdf"
        for end in [4, 5, 100, len(whole) - 1, *(generator.randrange(5, len(whole)) for _ in range(30))]:
            cut.write_bytes(whole[:end])
            with self.subTest(end=end):
                try:
                    recording = dts.load(cut)
                except dts.DataDamaged as error:
                    self.assertLess(end, header_end, error)
                    continue
                self.assertTrue(recording.damage)
                for name, stream in recording.streams.items():
                    np.testing.assert_array_equal(stream.values, full[name].values[: len(stream)])

    def test_DamagedBytesNeverRaiseAnythingElse(self) -> None:
        whole = Path(self.file).read_bytes()[:60_000]
        generator = random.Random(2)
        damaged = self.folder / "damaged.xdf"
        told = 0
        for _ in range(100):
            content = bytearray(whole)
            for _ in range(generator.randrange(1, 20)):
                content[generator.randrange(len(content))] = generator.randrange(256)
            damaged.write_bytes(content)
            try:
                told += bool(dts.load(damaged).damage)
            except dts.DataDamaged:
                told += 1

        self.assertEqual(told, 100)  # each of them is torn at its end already

    def test_LiveValuesAreTheRecordedOnes(self) -> None:
        with self.daemon.start_session("floor") as session:
            live = self.daemon.record("floor/cop", 1.0)

        recorded = dts.load(self.daemon.session(session.id).parts[0].file)["cop"]

        rows = np.searchsorted(recorded.scans, live.scans)
        np.testing.assert_array_equal(recorded.values[rows], live.values)
        np.testing.assert_allclose(recorded.time_s[rows], live.time_s, atol=2e-6)


def chunk(tag: int, content: bytes) -> bytes:
    return b"\x04" + struct.pack("<IH", len(content) + 2, tag) + content


def foreign_file(*samples: bytes, form: str = "float32", channels: int = 2, rate: str = "50") -> bytes:
    """As another program would write it: no description, no exact rate, no footer."""
    header = (
        f"<?xml version='1.0'?><info><name>EEG</name><type>EEG</type><channel_count>{channels}</channel_count>"
        f"<nominal_srate>{rate}</nominal_srate><channel_format>{form}</channel_format></info>"
    )
    start = b"XDF:" + chunk(1, b"<info><version>1.0</version></info>") + chunk(2, struct.pack("<I", 9) + header.encode())
    return start + b"".join(chunk(3, struct.pack("<I", 9) + content) for content in samples)


class Foreign(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory(prefix="dts-")
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "file.xdf"

    def load(self, content: bytes) -> dts.Recording:
        self.file.write_bytes(content)
        return dts.load(self.file)

    def test_StampsAreCountedOnOverChunks(self) -> None:
        without_stamps = b"\0" + struct.pack("<ff", 3, 4) + b"\0" + struct.pack("<ff", 5, 6)
        first = b"\x01\x03" + b"\x08" + struct.pack("<dff", 10.0, 1, 2) + without_stamps
        second = b"\x01\x02" + b"\0" + struct.pack("<ff", 7, 8) + b"\x08" + struct.pack("<dff", 11.0, 9, 10)

        stream = self.load(foreign_file(first, second))["EEG"]

        np.testing.assert_allclose(stream.stamps_s, [10.0, 10.02, 10.04, 10.06, 11.0], atol=1e-12)
        np.testing.assert_array_equal(stream.values, np.arange(1, 11).reshape(5, 2))
        np.testing.assert_array_equal(stream.segments, [0, 0, 0, 0, 1])
        np.testing.assert_array_equal(stream.scans, [0, 1, 2, 3, 0])
        self.assertEqual([gap.index for gap in stream.gaps], [4])

    def test_HolesAreCountedWithTheirReasons(self) -> None:
        def told(time_s: float, text: str) -> bytes:
            row = b"\x08" + struct.pack("<d", time_s) + bytes([1, len(text)]) + text.encode()
            return chunk(3, struct.pack("<I", 10) + b"\x01\x01" + row)

        form = "<channel_count>1</channel_count><channel_format>string</channel_format>"
        header = f"<info><name>floor/events</name><type>Markers</type>{form}</info>".encode()
        events = chunk(2, struct.pack("<I", 10) + header)
        events += told(1.0, '{"event":"segment","segment":3,"scan":0,"reason":"unplugged","missing_scans":900,"is_exact":false}')
        events += told(3.0, '{"event":"segment","segment":4,"scan":0,"reason":"silence","missing_scans":75,"is_exact":true}')
        events += told(4.0, '{"event":"loss","segment":4,"scan":50,"scans":25}')
        events += told(5.0, '{"event":"segment","segment":5,"scan":0,"reason":"silence","missing_scans":"many"}')

        recording = self.load(foreign_file() + events)

        self.assertEqual(recording.losses, (dts.Loss("silence", 2, 75), dts.Loss("ring_full", 1, 25)))
        self.assertEqual((recording.lost_scans, recording.lost_in_gaps), (100, 3))
        self.assertIn("100 scans lost in 3 gaps: silence 2, ring_full 1", str(recording))

    def test_HolesOfOtherProgramsAreCountedByTheStamps(self) -> None:
        rows = b"".join(b"\x08" + struct.pack("<dff", time_s, 1, 2) for time_s in (10.0, 10.02, 10.1, 10.12, 10.11, 10.13))

        recording = self.load(foreign_file(b"\x01\x06" + rows))

        self.assertEqual([gap.index for gap in recording["EEG"].gaps], [2, 4])
        self.assertEqual(recording.losses, (dts.Loss("none", 2, 3),), "a stamp that goes back hides no scan")
        self.assertIn("3 scans lost in 2 gaps: none 2", str(recording))

    def test_NoHolesAreNotTold(self) -> None:
        recording = self.load(foreign_file())

        self.assertEqual((recording.losses, recording.lost_scans), ((), 0))
        self.assertNotIn("lost", str(recording))

    def test_EachSampleMayHaveItsStamp(self) -> None:
        rows = b"".join(b"\x08" + struct.pack("<dhh", time_s, 1, -1) for time_s in (1.0, 1.5, 9.0))

        stream = self.load(foreign_file(b"\x04\x03\0\0\0" + rows, form="int16", rate="0"))["EEG"]

        np.testing.assert_array_equal(stream.stamps_s, [1.0, 1.5, 9.0])
        self.assertEqual((stream.values.dtype, stream.rate), (np.int16, None))

    def test_TextsBecomeMarkers(self) -> None:
        text = "début".encode()
        sample = b"\x01\x01" + b"\x08" + struct.pack("<d", 2.0) + bytes([1, len(text)]) + text

        recording = self.load(foreign_file(sample, form="string", channels=1, rate="0"))

        (event,) = recording.events
        self.assertEqual((event.kind, event.fields, event.time_s), ("marker", {"text": "début"}, 2.0))
        self.assertIsNone(recording.session)

    def test_OffsetsMapToTheHostsClock(self) -> None:
        sample = b"\x01\x01" + b"\x08" + struct.pack("<dff", 10.0, 1, 2)
        offsets = b"".join(chunk(4, struct.pack("<Idd", 9, at, value)) for at, value in ((8.0, 1.0), (12.0, 2.0)))

        stream = self.load(foreign_file(sample) + offsets)["EEG"]

        self.assertEqual((stream.stamps_s[0], stream.time_s[0]), (10.0, 11.5))

    def test_CountsThatDoNotFitAreRefusedWithTheirPlace(self) -> None:
        row = b"\x08" + struct.pack("<dff", 10.0, 1, 2)
        cases = {
            "samples declared": b"\x08" + struct.pack("<Q", 2**62) + row,
            "no count": b"\x03",
            "left over": b"\x01\x01" + row + b"\0",
            "neither 0 nor 8": b"\x01\x01" + b"\x05" + row[1:],
        }
        for problem, content in cases.items():
            with self.subTest(problem):
                recording = self.load(foreign_file(content))
                self.assertIn(problem, recording.damage)
                self.assertRegex(recording.damage, r"samples damaged at byte \d+")

    def test_HeadersThatCannotBeAreRefused(self) -> None:
        sample = b"\x01\x01" + b"\x08" + struct.pack("<dff", 10.0, 1, 2)
        for keywords in ({"form": "float16"}, {"channels": 0}, {"channels": 10**6}, {"rate": "-5"}, {"rate": "nan"}, {"rate": "x"}):
            with self.subTest(keywords=keywords):
                self.assertIn("stream header damaged", self.load(foreign_file(sample, **keywords)).damage)  # type: ignore[arg-type]

    def test_FactsThatAreNoNumbersAreDamage(self) -> None:
        for number in ("--5", "0" * 22 + "9" * 30, "1" * 5000, "x"):
            with self.subTest(number=number[:30]):
                facts = f"<dts><fact name='format_version'>1</fact><fact name='part'>{number}</fact></dts>"
                recording = self.load(b"XDF:" + chunk(1, f"<info><version>1.0</version><desc>{facts}</desc></info>".encode()))

                self.assertIn("the fact part is no number", recording.damage)
                self.assertIsNone(recording.session)

    def test_EntitiesAreRefused(self) -> None:
        bomb = b"<!DOCTYPE x [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]><info><version>1.0</version></info>"

        with self.assertRaisesRegex(dts.DataDamaged, "document type"):
            self.load(b"XDF:" + chunk(1, bomb))

    def test_WhatIsNoXdfIsSaidSo(self) -> None:
        with self.assertRaisesRegex(dts.DataDamaged, "is no XDF file"):
            self.load(b"RIFF")
        with self.assertRaises(dts.NotFound):
            dts.load(self.file.with_name("nothing.xdf"))
        with self.assertRaises(dts.Failed):
            dts.load(self.file.parent)

    def test_TwoStreamsOfOneNameAreBothThere(self) -> None:
        header = b"<info><name>EEG</name><channel_count>1</channel_count><channel_format>int8</channel_format></info>"

        recording = self.load(foreign_file() + chunk(2, struct.pack("<I", 10) + header))

        self.assertEqual(list(recording.streams), ["EEG", "EEG-2"])


class AgainstPyxdf(WithDaemon):
    def test_ReadingsAgree(self) -> None:
        try:
            import pyxdf
        except ImportError:
            self.skipTest("pyxdf is not installed")
        with self.daemon.start_session("floor") as session:
            self.daemon.record("floor/cop", 1.0)
        file = self.daemon.session(session.id).parts[0].file

        theirs, _ = pyxdf.load_xdf(file, synchronize_clocks=False, dejitter_timestamps=False)

        ours = dts.load(file)
        for stream in theirs:
            mine = ours[stream["info"]["name"][0]]
            np.testing.assert_array_equal(mine.values, np.asarray(stream["time_series"], mine.values.dtype))
            np.testing.assert_allclose(mine.stamps_s, stream["time_stamps"], rtol=0, atol=1e-6)


if __name__ == "__main__":
    unittest.main()
