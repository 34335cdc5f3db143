# SPDX-License-Identifier: Apache-2.0
"""Octave, the Python client and the CSV export read the same recording to the last bit."""
import csv
import json
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from typing import Any

import dts
import numpy as np
import recordings
from numpy.typing import NDArray
from support import PATIENCE_S, SOURCE, DaemonProcess
from test_xdf import chunk

OCTAVE = shutil.which("octave-cli")
READER = SOURCE / "clients" / "octave"
HERE = Path(__file__).resolve().parent
OLD_RECORDINGS = SOURCE / "tests" / "unit" / "record" / "recordings_0_1"
CLASSES = {"single": "<f4", "double": "<f8", "int8": "i1", "uint8": "u1", "int16": "<i2", "int32": "<i4", "int64": "<i8"}


def octave(program: str, check: bool = True) -> subprocess.CompletedProcess[str]:
    """Runs a program in Octave without a screen and without the user's settings."""
    command = [str(OCTAVE), "--quiet", "--no-init-file", "--path", str(READER), "--path", str(HERE), "--eval", program]
    done = subprocess.run(command, timeout=5 * PATIENCE_S, capture_output=True, text=True)
    if check and done.returncode != 0:
        raise AssertionError(f"{program} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return done


class Dumped:
    """A recording as Octave has read it."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.all: Any = json.loads(Path(f"{file}.json").read_text())
        if isinstance(self.all, str):
            raise AssertionError(f"{file}: {self.all}")
        self.streams: dict[str, dict[str, Any]] = {stream["name"]: stream for stream in as_list(self.all["streams"])}

    def numbers(self, stream: str, what: str) -> NDArray[Any]:
        described = self.streams[stream]
        form = CLASSES[described["class"]] if what == "values" else "<f8"
        numbers = np.fromfile(f"{self.file}.{described['field']}.{what}", form)
        return numbers.reshape(-1, len(as_list(described["channels"]))) if what == "values" else numbers


def as_list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def made_file() -> bytes:
    """What recordings of two seconds do not have: clock offsets, a rate that is a fraction, whole numbers of 64 bits, stamps in each layout, an
    event of another program."""

    def header(number: int, name: str, form: str, channels: int, rate: str) -> bytes:
        described = "".join(f"<channel><label>c{k}</label><unit>V</unit></channel>" for k in range(channels))
        return chunk(2, struct.pack("<I", number) + (
            f"<info><name>made/{name}</name><type>X</type><channel_count>{channels}</channel_count><channel_format>{form}</channel_format>"
            f"{rate}<desc><channels>{described}</channels></desc></info>").encode())

    def samples(number: int, rows: list[tuple[float | None, bytes]]) -> bytes:
        content = b"".join(b"\0" + row if stamp_s is None else b"\x08" + struct.pack("<d", stamp_s) + row for stamp_s, row in rows)
        return chunk(3, struct.pack("<IBI", number, 4, len(rows)) + content)

    random = np.random.default_rng(28)
    fraction = "<nominal_srate>142.85714285714286</nominal_srate>"
    exact = fraction + '<desc><dts><rate numerator="2000" denominator="14"/></dts></desc>'
    content = b"XDF:" + chunk(1, b"<info><version>1.0</version></info>") + header(1, "raw", "double64", 3, exact)
    content += header(2, "counts", "int64", 1, fraction) + header(3, "notes", "string", 1, "<nominal_srate>0</nominal_srate>")
    at_s = 5000.1
    for number in range(40):
        rows: list[tuple[float | None, bytes]] = [(None, random.standard_normal(3).tobytes()) for _ in range(20)]
        if number % 3 == 0:
            rows = [(at_s + random.uniform(0, 0.001) + k * 0.007, row) for k, (_, row) in enumerate(rows)]
        elif number % 3 == 1:
            rows[0] = (at_s, rows[0][1])
            rows[number % 20] = (at_s + 0.007 * (number % 20), rows[number % 20][1])
        content += samples(1, rows) + samples(2, [(at_s, struct.pack("<q", (1 << 62) + number))])
        content += chunk(4, struct.pack("<Idd", 1, at_s + 0.03, 1e-3 * random.uniform()))
        at_s += 0.14 if number != 20 else 3.3
    text = "eyes \u00e4 &amp; closed".encode()
    return content + samples(3, [(5001.0, struct.pack("<BB", 1, len(text)) + text)])


def raw_samples(count: int, content: bytes) -> bytes:
    """A chunk of the stream raw of `made_file`."""
    return chunk(3, struct.pack("<IBI", 1, 4, count) + content)


ROW = b"\0" + bytes(24)
DAMAGE = {  # what follows a sound file; by a part of the reader's message
    "left over": raw_samples(2, ROW + ROW + b"1234567"),
    "has room for": raw_samples(1 << 30, ROW),
    "impossible time stamp": raw_samples(2, ROW + b"\x07" + bytes(24)),
    "neither 0 nor 8 bytes": raw_samples(2, b"\x07" + ROW[1:] + ROW + bytes(8)),
    "a length has neither": b"\x03\0\0\0",
    "the chunk is torn": b"\x08" + struct.pack("<QH", 1 << 63, 3),
    "has no header": chunk(3, struct.pack("<I", 77)),
    "or a second one": chunk(2, struct.pack("<I", 1) + b"<info/>"),
    "one file header": chunk(1, b"<info><version>1.0</version></info>"),
    "channel_format 'float16'": chunk(2, struct.pack("<I", 8) + b"<info><channel_format>float16</channel_format></info>"),
}


class Reader(unittest.TestCase):
    folder: Path
    recorded: list[recordings.Recorded]
    process: DaemonProcess

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.process = DaemonProcess(further=recordings.RIGS)
        cls.addClassCleanup(cls.process.close)
        cls.recorded = recordings.record(cls.process)
        for file in [*(file for session in cls.recorded for file in session.files), *OLD_RECORDINGS.glob("*.xdf")]:
            shutil.copy(file, cls.folder)
        (cls.folder / "made.xdf").write_bytes(made_file())
        whole = Path(cls.recorded[0].files[0]).read_bytes()
        for cut, end in enumerate((len(whole) * 7 // 10, len(whole) * 8 // 10, len(whole) - 7)):
            (cls.folder / f"cut-{cut}.xdf").write_bytes(whole[:end])
        for number, (problem, content) in enumerate(DAMAGE.items()):
            (cls.folder / f"damaged-{number}.xdf").write_bytes(made_file() + content)
        octave(f"dump_recordings('{cls.folder}')")  # one run: Octave takes seconds to start

    def test_EveryNumberIsThatOfPython(self) -> None:
        # requirement: LIB-3
        files = sorted(self.folder.glob("*.xdf"))
        self.assertGreaterEqual(len(files), 16)
        for file in files:
            with self.subTest(file.name):
                dumped = Dumped(file)
                recording = dts.load(file)
                wanted = {name: stream for name, stream in recording.streams.items() if stream.values.dtype != object}
                self.assertEqual(list(dumped.streams), list(wanted))
                for name, stream in wanted.items():
                    self.compare_stream(dumped, name, stream)
                self.compare_rest(dumped, recording)

    def compare_stream(self, dumped: Dumped, name: str, stream: dts.RecordedStream) -> None:
        described = dumped.streams[name]
        self.assertEqual((described["channels"], described["units"]), (list(stream.channels), list(stream.units)), name)
        self.assertEqual((described["rate_hz"], described["delay_s"]), (float(stream.rate or 0), stream.delay_s), name)
        self.assertEqual(as_list(described["gaps"]), [gap.index + 1 for gap in stream.gaps], name)
        values = dumped.numbers(name, "values")
        self.assertEqual(values.dtype, stream.values.dtype)
        self.assertEqual(values.tobytes().hex(), np.ascontiguousarray(stream.values).tobytes().hex(), name)
        self.assertEqual(dumped.numbers(name, "stamp_s").tobytes().hex(), stream.stamps_s.tobytes().hex(), name)
        np.testing.assert_array_equal(dumped.numbers(name, "segment"), stream.segments, name)
        np.testing.assert_array_equal(dumped.numbers(name, "scan"), stream.scans, name)
        # Interpolated: processors that multiply and add at once round the last digit in another way.
        np.testing.assert_allclose(dumped.numbers(name, "time_s"), stream.time_s, rtol=0, atol=1e-9, err_msg=name)

    def compare_rest(self, dumped: Dumped, recording: dts.Recording) -> None:
        facts = dumped.all["facts"]
        self.assertEqual(dict(zip(facts[::2], facts[1::2])), recording.session.all if recording.session else {})
        self.assertEqual("damaged at byte" in dumped.all["damage"], "at byte" in recording.damage)
        if "at byte" not in recording.damage:
            self.assertEqual(dumped.all["damage"], recording.damage)
        events = as_list(dumped.all["events"])
        self.assertEqual(
            [(event["rig"], event["kind"], event["segment"], event["scan"]) for event in events],
            [(event.rig, event.kind, event.segment, event.scan) for event in recording.events],
        )
        times_s = [event["time_s"] for event in events]
        np.testing.assert_allclose(times_s, [event.time_s for event in recording.events], rtol=0, atol=1e-4)  # JSON has few digits
        texts = [event["text"] for event in events if event["kind"] == "marker"]
        self.assertEqual(texts, [event.fields["text"] for event in recording.events_of("marker")])

    def test_TheRecordingsShowWhatTheyShould(self) -> None:
        """Without a special letter, a gap and damage, the comparison would show little."""
        kinds = {session.kind: [dts.load(file) for file in session.files] for session in self.recorded}

        self.assertIn("ä", kinds["floor"][0].events_of("marker")[0].fields["text"])
        self.assertEqual(len(kinds["gapped"][0]["raw"].gaps), 1)
        self.assertTrue(kinds["resumed"][0].damage)
        made = dts.load(self.folder / "made.xdf")
        self.assertGreater(np.ptp(made["raw"].time_s - made["raw"].stamps_s), 1e-5)
        self.assertEqual(len(made["raw"].gaps), 1)

    def test_EveryNumberIsThatOfTheCsvExport(self) -> None:
        for session in self.recorded:
            folder = self.folder / session.kind
            self.process.dtsctl("session", "export", session.session_id, "--format", "csv", "--out", str(folder))
            for part, file in enumerate(session.files, 1):
                dumped = Dumped(self.folder / Path(file).name)
                stem = session.session_id + (f".{part}" if part > 1 else "")
                for name, described in dumped.streams.items():
                    with self.subTest(f"{session.kind} {part} {name}"):
                        with (folder / f"{stem}_{name.split('/')[1]}.csv").open(newline="") as lines:
                            rows = list(csv.reader(lines))[1:]
                        values = dumped.numbers(name, "values")
                        exported = np.array([[float(cell) if cell else np.nan for cell in row[3:]] for row in rows])
                        is_quality = name.endswith("/quality")  # in CSV, its bytes have a sign
                        wanted = exported.astype(np.int8).view(np.uint8) if is_quality else exported.astype(values.dtype)
                        np.testing.assert_array_equal(values, wanted)
                        np.testing.assert_array_equal(dumped.numbers(name, "segment"), [int(row[1]) for row in rows])
                        np.testing.assert_array_equal(dumped.numbers(name, "scan"), [int(row[2]) for row in rows])

    def test_ACutFileIsReadUpToTheCut(self) -> None:
        full = dts.load(self.recorded[0].files[0])
        for cut in range(3):
            dumped = Dumped(self.folder / f"cut-{cut}.xdf")
            self.assertIn("damaged at byte", dumped.all["damage"])
            for name in dumped.streams:
                values = dumped.numbers(name, "values")
                np.testing.assert_array_equal(values, full[name].values[: len(values)])
        self.assertTrue(len(values))

    def test_DamageIsNamed(self) -> None:
        for number, problem in enumerate(DAMAGE):
            self.assertIn(problem, Dumped(self.folder / f"damaged-{number}.xdf").all["damage"])

    def test_WhatIsNoRecordingIsSaidSo(self) -> None:
        other = self.folder / "other.xdf"
        other.write_text("time,value\n")
        for file, problem in ((other, "is not an XDF file"), (self.folder / "none.xdf", "Cannot read")):
            done = octave(f"dts_read_xdf('{file}')", check=False)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(problem, done.stderr)

    def test_TheReaderHasNoSyntaxThatOnlyOctaveHas(self) -> None:
        """MATLAB is not at hand. Octave names each place with syntax that MATLAB does not have."""
        file = self.recorded[0].files[0]
        done = octave(f"warning('on', 'Octave:language-extension'); recording = dts_read_xdf('{file}'); disp(numel(recording.events))")

        self.assertIn("language extension used", done.stderr, "of Octave's own functions: it does warn")
        self.assertEqual(re.findall(r"language extension used: .*dts_read_xdf\.m", done.stderr), [])


if __name__ == "__main__":
    if OCTAVE is None:
        print("skipped: Octave is not installed: apt-get install octave")
        sys.exit(77)
    unittest.main()
