# SPDX-License-Identifier: Apache-2.0
import csv
import json
import random
import shutil
import struct
import tempfile
import unittest
from pathlib import Path
from typing import Any

import numpy as np
from support import WithDaemon

import dts
from dts.xdf import samples
from dts.xdf_header import stream_header


class OwnRecording(WithDaemon):
    """A recording just made, beside what the C++ programs say of it."""

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        with cls.process.connect() as daemon:
            with daemon.start_session("chair", "free", label="for the tests") as session:
                session.mark("comma, and \"quotes\"")
                daemon.record("chair/transient", 6.0)
            cls.file = daemon.session(session.id).parts[0].file
        cls.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.process.dtsctl("session", "export", cls.file, "--format", "csv", "--out", str(cls.folder))

    def test_EveryValueIsThatOfTheCsvExport(self) -> None:
        # requirement: LIB-1
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
                wanted = values.astype(np.int8).view(np.uint8) if name == "quality" else values.astype(stream.values.dtype)
                np.testing.assert_array_equal(stream.values, wanted)  # the quality in CSV has a sign
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
        with self.daemon.start_session("floor", "free") as session:
            live = self.daemon.record("floor/cop", 1.0)

        recorded = dts.load(self.daemon.session(session.id).parts[0].file)["cop"]

        rows = np.searchsorted(recorded.scans, live.scans)
        np.testing.assert_array_equal(recorded.values[rows], live.values)
        np.testing.assert_allclose(recorded.time_s[rows], live.time_s, atol=2e-6)


def chunk(tag: int, content: bytes) -> bytes:
    return b"\x04" + struct.pack("<IH", len(content) + 2, tag) + content


def foreign_file(*samples: bytes, form: str = "float32", channels: int = 2, rate: str = "50", version: str = "1.0", desc: str = "") -> bytes:
    """As another program would write it: no description, no exact rate, no footer."""
    header = (
        f"<?xml version='1.0'?><info><name>EEG</name><type>EEG</type><channel_count>{channels}</channel_count>"
        f"<nominal_srate>{rate}</nominal_srate><channel_format>{form}</channel_format><desc>{desc}</desc></info>"
    )
    start = b"XDF:" + chunk(1, f"<info><version>{version}</version></info>".encode()) + chunk(2, struct.pack("<I", 9) + header.encode())
    return start + b"".join(chunk(3, struct.pack("<I", 9) + content) for content in samples)


def event_file(*rows: tuple[float, str]) -> bytes:
    """A stream of texts, as dtsd writes its events."""
    form = "<channel_count>1</channel_count><channel_format>string</channel_format>"
    content = chunk(2, struct.pack("<I", 10) + f"<info><name>floor/events</name><type>Markers</type>{form}</info>".encode())
    for time_s, text in rows:
        content += chunk(3, struct.pack("<I", 10) + b"\x01\x01\x08" + struct.pack("<dBI", time_s, 4, len(text)) + text.encode())
    return content


def facts_file(**facts: str) -> bytes:
    named = "".join(f"<fact name='{name}'>{text}</fact>" for name, text in {"format_version": "1", **facts}.items())
    return b"XDF:" + chunk(1, f"<info><version>1.0</version><desc><dts>{named}</dts></desc></info>".encode())


class Foreign(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory(prefix="dts-")
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "file.xdf"

    def load(self, content: bytes) -> dts.Recording:
        self.file.write_bytes(content)
        return dts.load(self.file)

    def test_StampsAreCountedOnOverChunks(self) -> None:
        def row(value: float, stamp_s: float | None = None) -> bytes:
            stamp = b"\0" if stamp_s is None else b"\x08" + struct.pack("<d", stamp_s)
            return stamp + struct.pack("<ff", value, value + 1)

        chunks = (b"\x01\x03" + row(1, 10.0) + row(3) + row(5), b"\x01\x01" + row(7), b"\x01\0", b"\x01\x02" + row(9) + row(11, 40.0))
        recording = self.load(foreign_file(*chunks, rate="0.4"))

        stream = recording["EEG"]
        self.assertRegex(recording.damage, "^no footer")
        np.testing.assert_allclose(stream.stamps_s, [10.0, 12.5, 15.0, 17.5, 20.0, 40.0], atol=1e-12)
        np.testing.assert_array_equal(stream.values, np.arange(1, 13).reshape(6, 2))
        np.testing.assert_array_equal(stream.segments, [0, 0, 0, 0, 0, 1])
        np.testing.assert_array_equal(stream.scans, [0, 1, 2, 3, 4, 0])
        self.assertEqual([gap.index for gap in stream.gaps], [5])

    def test_HolesAreCountedWithTheirReasons(self) -> None:
        events = event_file(
            (1.0, '{"event":"segment","segment":3,"scan":0,"reason":"unplugged","missing_scans":900,"is_exact":false}'),
            (3.0, '{"event":"segment","segment":4,"scan":0,"reason":"silence","missing_scans":75,"is_exact":true}'),
            (4.0, '{"event":"loss","segment":4,"scan":50,"scans":25}'),
            (5.0, '{"event":"segment","segment":5,"scan":0,"reason":"silence","missing_scans":"many"}'),
        )

        stamps_s = (0.991, 1.02, 3.0, 3.02, 5.0)
        recording = self.load(foreign_file(b"\x01\x05" + b"".join(b"\x08" + struct.pack("<dff", at, 1, 2) for at in stamps_s)) + events)

        stream = recording["EEG"]
        np.testing.assert_array_equal(stream.segments, [3, 3, 4, 4, 5])
        np.testing.assert_array_equal(stream.scans, [0, 1, 0, 1, 0])
        self.assertEqual(stream.gaps, (dts.Missing(2, 75, True, "silence"), dts.Missing(4, 0, False, "silence")))
        self.assertEqual(recording.losses, (dts.Loss("silence", 2, 75), dts.Loss("ring_full", 1, 25)))
        self.assertEqual((recording.lost_scans, recording.lost_in_gaps), (100, 3))
        self.assertIn("100 scans lost in 3 gaps: silence 2, ring_full 1", str(recording))

    def test_GapsOfASlowerStreamAreCountedInItsScans(self) -> None:
        def stream(number: int, name: str, rate: int, form: str, stamps_s: list[float], value: bytes) -> bytes:
            about = f"<name>{name}</name><type>{'Quality' if form == 'int8' else 'DTS'}</type><channel_count>1</channel_count>"
            header = f"<info>{about}<nominal_srate>{rate}</nominal_srate><channel_format>{form}</channel_format></info>"
            rows = b"".join(b"\x08" + struct.pack("<d", at) + value for at in stamps_s)
            content = struct.pack("<IBI", number, 4, len(stamps_s)) + rows
            return chunk(2, struct.pack("<I", number) + header.encode()) + chunk(3, content)

        # 1000 Hz and every tenth scan; 2 scans are missing after the last scan at 1.000 s, and 1,990 after 1.013 s.
        raw_s = [1.000] + [1.003 + 0.001 * scan for scan in range(11)] + [3.004]
        slow_s = [0.990, 1.000, 1.003, 1.013, 3.004]
        events = event_file(
            (0.9, '{"event":"segment","segment":0,"scan":0}'),
            (1.003, '{"event":"segment","segment":1,"scan":0,"reason":"overrun","missing_scans":2,"is_exact":true}'),
            (3.004, '{"event":"segment","segment":2,"scan":0,"reason":"unplugged","missing_scans":1990,"is_exact":true}'),
        )
        value = struct.pack("<f", 1.0)
        streams = stream(1, "floor/raw", 1000, "float32", raw_s, value) + stream(2, "floor/cop", 100, "float32", slow_s, value)

        recording = self.load(facts_file() + streams + stream(3, "floor/quality", 100, "int8", slow_s, b"\x81") + events)

        cop = recording["cop"]
        np.testing.assert_array_equal(cop.segments, [0, 0, 1, 1, 2])
        np.testing.assert_array_equal(cop.scans, [9, 10, 0, 1, 0])
        self.assertEqual(cop.gaps, (dts.Missing(2, 0, True, "overrun"), dts.Missing(4, 199, True, "unplugged")))
        np.testing.assert_array_equal(recording["quality"].values, 0x81)

    def test_HolesOfOtherProgramsAreCountedByTheStamps(self) -> None:
        rows = b"".join(b"\x08" + struct.pack("<dff", time_s, 1, 2) for time_s in (10.0, 10.02, 10.1, 10.12, 10.11, 10.13))

        recording = self.load(foreign_file(b"\x01\x06" + rows))

        self.assertEqual([gap.index for gap in recording["EEG"].gaps], [2, 4])
        self.assertEqual(recording.losses, (dts.Loss("none", 2, 3),), "a stamp that goes back hides no scan")
        self.assertIn("3 scans lost in 2 gaps: none 2", str(recording))

    def test_ChunkOfTheShortestSamplesIsBounded(self) -> None:
        header = stream_header(b"<info><channel_count>1</channel_count><channel_format>int8</channel_format></info>")

        with self.assertRaisesRegex(dts.DataDamaged, "too many to hold"):
            samples(b"\x08" + struct.pack("<Q", (1 << 24) + 1) + bytes(2 * (1 << 24) + 2), header)

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
            "end within a value": b"\x01\x02\0" + struct.pack("<ff", 1, 2) + row[:12],
        }
        for problem, content in cases.items():
            with self.subTest(problem):
                recording = self.load(foreign_file(content))
                self.assertIn(problem, recording.damage)
                self.assertRegex(recording.damage, r"samples damaged at byte \d+")

    def test_HeadersAreBounded(self) -> None:
        def exact(numerator: object, denominator: object) -> str:
            return f"<dts><rate numerator='{numerator}' denominator='{denominator}'/></dts>"

        cases: list[tuple[bool, dict[str, Any]]] = [
            *((True, {"form": form}) for form in ("float32", "double64", "int8", "int16", "int32", "int64", "string")),
            (False, {"form": "float16"}),
            *((good, {"channels": count}) for good, count in ((True, 1), (True, 4096), (False, 4097), (False, 0), (False, 10**6))),
            *((True, {"rate": rate}) for rate in ("", "0", "1e-6", "1e6")),
            *((False, {"rate": rate}) for rate in ("-5", "nan", "x", "9.9e-7", "1.01e6", "inf")),
            *((True, {"desc": exact(*terms)}) for terms in ((50, 1), (100, 2), (50 * 10**9, 10**9))),
            *((False, {"desc": exact(*terms)}) for terms in (("", 1), (50, 0), (-50, -1), (50_000_001, 10**6), (10**12 + 50, 2 * 10**10 + 1))),
            *((False, {"desc": f"<dts><delay_ns>{text}</delay_ns></dts>"}) for text in ("1.5", "--5", "-", "1" * 20)),
        ]
        for is_good, keywords in cases:
            with self.subTest(keywords=keywords):
                damage = self.load(foreign_file(**keywords)).damage
                self.assertRegex(damage, "^no footer" if is_good else "^stream header damaged")

        self.assertEqual([self.load(foreign_file(rate=rate))["EEG"].rate for rate in ("", "0", "0.5")], [None, None, 0.5])
        for version, is_known in (("1", True), ("1.3", True), ("2.0", False), ("10", False)):
            with self.subTest(version=version):
                if is_known:
                    self.load(foreign_file(version=version))
                else:
                    self.assertRaises(dts.DataDamaged, self.load, foreign_file(version=version))

    def test_DescriptionsAreTaken(self) -> None:
        channels = "".join(f"<channel><label>c{i}</label><unit>mm</unit></channel>" for i in range(3))
        desc = f"<channels>{channels}</channels><dts><delay_ns>-2000000</delay_ns><fact name='a'>b</fact></dts><other>text</other>"

        narrow, wide = (self.load(foreign_file(desc=desc, channels=count))["EEG"] for count in (2, 4))

        self.assertEqual((narrow.channels, narrow.units, narrow.delay_s), (("c0", "c1"), ("mm", "mm"), -0.002))
        self.assertEqual((wide.channels, wide.units), (("c0", "c1", "c2", ""), ("mm", "mm", "mm", "")))
        self.assertEqual((narrow.facts["a"], narrow.facts["other"], narrow.content), ("b", "text", "EEG"))

    def test_FactsThatDoNotFitAreDamage(self) -> None:
        good = {"part": ("0", "-9223372036854775808", "9223372036854775807"), "stages": ("0", "256"), "format_version": ("1",)}
        bad = {
            "part": ("--5", "0" * 22 + "9" * 30, "1" * 5000, "x", "9223372036854775808", "-9223372036854775809"),
            "stages": ("-1", "257"),
            "format_version": ("2",),
        }
        for is_good, given in ((True, good), (False, bad)):
            for name, texts in given.items():
                for text in texts:
                    with self.subTest(name, text=text[:30]):
                        recording = self.load(facts_file(**{name: text}))
                        self.assertEqual((recording.session is not None, f"the fact {name} " in recording.damage), (is_good, not is_good))

        session = self.load(facts_file(**{"stages": "2", "stage.1": "a", "stage.2": "b", "field.age": "7", "started_utc_ns": "5", "rig": "floor"})).session
        assert session is not None
        self.assertEqual((session.stages, session.fields, session.rig), (("a", "b"), {"age": "7"}, "floor"))
        self.assertEqual(session.started_utc, np.datetime64(5, "ns"))
        event = self.load(facts_file(utc_minus_monotonic_ns="7") + event_file((2.0, '{"event":"own","value":null}'))).events[0]
        self.assertEqual((event.utc, event.fields["value"] != event.fields["value"]), (np.datetime64(2_000_000_007, "ns"), True))

    def test_EventsOfBothFormsAreRead(self) -> None:
        new = '{"segment":1,"scan":"3","reach":{"step":"REACH_STEP_P1","number":2,"p1":{"scan":"12","value_mm":3.5},"later":[1]}}'
        result = '{"trial_result":{"trial":4,"movement":{"trunk_class":2,"probability":[0,1,0],"reasons":16}}}'
        bad = ['{"reach":{"flags":-1}}', '{"scan":"4611686018427387904","reach":{}}', '{"reach":3}', '{"later":{}}', '{"reach":' * 7000]

        events = self.load(foreign_file() + event_file(*((float(i), text) for i, text in enumerate([new, result, *bad])))).events

        self.assertEqual([event.kind for event in events], ["reach", "result"] + ["marker"] * len(bad))
        reach, told = events[:2]
        self.assertEqual((reach.segment, reach.scan, reach.fields["step"], reach.fields["p1"]), (1, 3, "p1", {"scan": 12, "value_mm": 3.5}))
        self.assertNotIn("p2", reach.fields)
        self.assertTrue(np.isnan(reach.fields["d1_mm"]))
        self.assertIsNone(told.fields["expected_class"])
        self.assertEqual(told.fields["movement"]["reasons"], ["calibrated"])
        assert reach.message is not None
        self.assertEqual(reach.message.reach.number, 2)

    def test_EventsOfALaterVersionKeepTheirKind(self) -> None:
        begin, later_reason = '{"scan":"0","segment_start":{}}', '{"segment":1,"segment_start":{"reason":"GAP_REASON_LATER","missing_scans":"7"}}'
        known = ['{"scan":"3","reach":{"step":"REACH_STEP_LATER","number":2}}', '{"scan":"4","trial_result":{"reach":{"step":"REACH_STEP_LATER"}}}']
        unknown = ['{"segment":1,"scan":"5","posture":{"sway_mm":2.5,"scan":"x"}}', '{"host_time_ns":"5","posture":{}}']
        other = ['{"scan":"5","posture":3}', '{"scan":"5","posture":{},"more":{}}', '{"posture":{}}', '{"scan":"4611686018427387904","posture":{}}']

        rows = [begin, later_reason, *known, *unknown, *other]
        recording = self.load(foreign_file() + event_file(*((float(i), text) for i, text in enumerate(rows))))

        kinds = ["segment", "segment", "reach", "result", "posture", "posture"]
        self.assertEqual([event.kind for event in recording.events], kinds + ["marker"] * len(other))
        self.assertEqual(recording.losses, (dts.Loss("unknown", 1, 7),))
        _, _, reach, result, posture, *_ = recording.events
        self.assertEqual((reach.fields["step"], reach.fields["number"], result.fields["reach"]["step"]), ("unknown", 2, "unknown"))
        self.assertEqual((posture.segment, posture.scan, posture.fields), (1, 5, {"sway_mm": 2.5}))

    def test_RecordingsOf0_1_0AreRead(self) -> None:
        folder = Path(__file__).resolve().parent.parent / "unit" / "record" / "recordings_0_1"
        standing = dts.load(folder / "standing.xdf")
        self.assertEqual([(loss.reason, loss.gaps, loss.scans) for loss in standing.losses], [("unplugged", 1, 38)])
        self.assertEqual([event.fields["measures"]["MVELO"]["unit"] for event in standing.events_of("sway")], ["mm/s"] * 2)
        self.assertEqual(standing.events_of("trial")[0].fields["phase"], "ready")
        reaching = dts.load(folder / "reaching.xdf")
        self.assertEqual(len(reaching.events_of("class")), 6)
        self.assertEqual([event.fields["class"] for event in reaching.events_of("result")][-4:], [3, 3, 3, 1])
        self.assertEqual([event.fields["text"] for event in dts.load(folder / "free.xdf").events_of("marker")], ['coughed; "twice"'])

    def test_TextsThatAreNoEventsOfOursAreMarkers(self) -> None:
        def long(size: int) -> str:
            return '{"event":"own","text":"' + "x" * (size - 25) + '"}'

        def wide(keys: int) -> str:
            return json.dumps({"event": "own", **{f"k{i}": i for i in range(keys - 1)}})

        good = ['{"event":"own"}', long(64 << 10), wide(64), json.dumps({"event": "own", "scan": 2**62 - 1, "segment": 0})]
        bad = ["[]", "{", '{"event":7}', "[" * 9000, long((64 << 10) + 1), wide(65)]
        bad += [json.dumps({"event": "own", "scan": scan}) for scan in (-1, 2**62, 1.5, True)]

        events = self.load(foreign_file() + event_file(*((float(i), text) for i, text in enumerate(good + bad)))).events

        self.assertEqual([event.kind for event in events], ["own"] * len(good) + ["marker"] * len(bad))
        self.assertEqual([event.fields["text"] for event in events[len(good) :]], bad)
        self.assertEqual((events[3].scan, events[0].rig), (2**62 - 1, "floor"))
        self.assertTrue(np.isnat(events[0].utc), "a file of another program does not say it")

    def test_ChunksThatCannotBeEndTheFileThere(self) -> None:
        row = b"\x08" + struct.pack("<dff", 10.0, 1, 2)
        good = foreign_file(b"\x01\x01" + row)
        footer = struct.pack("<I", 9) + b"<info><sample_count>1</sample_count></info>"
        cases: dict[str, bytes] = {
            "^$": b"\x01" + bytes([2 + len(footer)]) + b"\x06\x00" + footer,
            "recovered, at most 2.5 s": chunk(6, footer.replace(b"</info>", b"<desc><dts><fact name='recovered'>yes</fact>"
                                              b"<fact name='lost_s_at_most'>2.5</fact></dts></desc></info>")),
            "^no footer": b"\x08" + struct.pack("<QH", 2 + 16, 5) + b"0" * 16,
            "no chunk at byte": b"\x03\0\0\0",
            "chunk torn at byte": b"\x04\0\0",
            "torn at byte": b"\x01\x09\x05",
            "without a tag": b"\x01\x01\x05",
            "at most 64 MiB": b"\x04" + struct.pack("<I", (64 << 20) + 1),
            "file header damaged": chunk(1, b"<info><version>1.0</version></info>"),
            "a second header of stream 9": chunk(2, struct.pack("<I", 9) + b"<info/>"),
            "no stream number": chunk(3, b"\x09\0\0"),
            "stream 8 has no header": chunk(3, struct.pack("<I", 8)),
            "not two numbers": chunk(4, struct.pack("<Id", 9, 1.0)),
        }
        for problem, added in cases.items():
            with self.subTest(problem):
                recording = self.load(good + added)
                self.assertRegex(recording.damage, problem)
                self.assertEqual(len(recording["EEG"]), 1)

    def test_WhatIsNoXdfIsSaidSo(self) -> None:
        bomb = b"<!DOCTYPE x [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]><info><version>1.0</version></info>"
        for content, problem in ((b"RIFF", "is not an XDF file"), (b"XDF:", "ends before"), (b"XDF:" + chunk(5, b""), "starts with a file header"), (b"XDF:" + chunk(1, bomb), "document type")):
            with self.assertRaisesRegex(dts.DataDamaged, problem):
                self.load(content)
        with self.assertRaises(dts.NotFound):
            dts.load(self.file.with_name("nothing.xdf"))
        with self.assertRaises(dts.Failed):
            dts.load(self.file.parent)

    def test_TwoStreamsOfOneNameAreBothThere(self) -> None:
        header = b"<info><name>EEG</name><channel_count>1</channel_count><channel_format>int8</channel_format></info>"

        recording = self.load(foreign_file() + chunk(2, struct.pack("<I", 10) + header))

        self.assertEqual(list(recording.streams), ["EEG", "EEG-2"])
        self.assertEqual([name in recording for name in ("EEG", "EEG-2", "EEG-3")], [True, True, False])
        with self.assertRaisesRegex(KeyError, "EEG, EEG-2"):
            recording["EEG-3"]
        self.assertEqual((recording.losses, recording.lost_scans, "lost" in str(recording)), ((), 0, False))


if __name__ == "__main__":
    unittest.main()
