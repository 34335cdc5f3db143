# SPDX-License-Identifier: Apache-2.0
"""Reads the C3D files that dtslab and dtsctl write with an independent reader, made from the description of the format (c3d.org), and compares
them with what the same programs say as CSV: the same float32."""

import csv
import os
import shutil
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

BIN = Path(os.environ["DTS_BIN_DIR"])


class C3d:
    """Header, parameters and analogue channels of a little-endian file of real numbers."""

    def __init__(self, file: Path) -> None:
        data = file.read_bytes()
        block, key = data[0], data[1]
        assert key == 0x50
        points, analogue, self.first, self.last, _gap = struct.unpack_from("<5H", data, 2)
        scale, start, each, rate = struct.unpack_from("<fHHf", data, 12)
        assert scale < 0 and points == 0 and data[512 * (block - 1) + 3] == 84
        self.rate = rate * each
        self.parameters = self.read_parameters(data, 512 * (block - 1))
        frames = self.last - self.first + 1
        values = np.frombuffer(data, "<f4", frames * analogue, 512 * (start - 1))
        self.analogue = values.reshape(frames * each, analogue // each)
        assert 512 * (start - 1) + 4 * frames * analogue == len(data)

    @staticmethod
    def read_parameters(data: bytes, at: int) -> dict[str, object]:
        groups: dict[int, str] = {}
        found: dict[str, object] = {}
        at += 4
        while data[at] != 0:
            length, number = abs(struct.unpack_from("<b", data, at)[0]), struct.unpack_from("<b", data, at + 1)[0]
            name = data[at + 2:at + 2 + length].decode()
            at += 2 + length
            offset = struct.unpack_from("<h", data, at)[0]
            if number < 0:
                groups[-number] = name
            else:
                kind, count = struct.unpack_from("<bB", data, at + 2)
                sizes = list(data[at + 4:at + 4 + count])
                total = int(np.prod(sizes)) if sizes else 1
                begin = at + 4 + count
                value: object
                if kind == -1:
                    text = data[begin:begin + total].decode()
                    width = sizes[0] if sizes else 1
                    value = [text[k:k + width].rstrip() for k in range(0, total, width)] if len(sizes) > 1 else text.rstrip()
                else:
                    kinds = {1: "u1", 2: "<i2", 4: "<f4"}
                    value = np.frombuffer(data, kinds[kind], total, begin).reshape(sizes, order="F")
                found[f"{groups[number]}:{name}"] = value
            if offset == 0:
                break
            at += offset
        return found


def columns(file: Path) -> dict[str, np.ndarray]:
    with file.open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}


class WrittenC3d(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="dts-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def run_program(self, *words: str) -> None:
        subprocess.run([BIN / words[0], *words[1:]], cwd=self.folder, check=True, capture_output=True)

    def assert_same(self, found: np.ndarray, expected: np.ndarray) -> None:
        np.testing.assert_array_equal(found, expected.astype(np.float32))

    def test_ForceAsC3dHasTheFloatsOfItsCsv(self) -> None:
        random = np.random.default_rng(26)
        count = 70_000  # more than a header counts
        loads = random.normal(700, 20, count)
        loads[100:200] = 3
        lines = ["time,Fx,Fy,Fz,Mx,My,Mz"]
        lines += [",".join(repr(float(value)) for value in (k / 1000, *random.normal(0, 5, 2), loads[k], *random.normal(0, 30, 3))) for k in range(count)]
        (self.folder / "in.csv").write_text("\n".join(lines) + "\n")
        self.run_program("dtslab", "force", "in.csv", "--csv", "out.csv", "--to", "out.c3d")

        file = C3d(self.folder / "out.c3d")
        table = columns(self.folder / "out.csv")
        self.assertEqual(file.rate, 1000.0)
        self.assertEqual(len(file.analogue), count)
        for channel, name in enumerate(("fx_n", "fy_n", "fz_n", "copx_mm", "copy_mm")):
            self.assert_same(file.analogue[:, channel], table[name])
        np.testing.assert_allclose(file.analogue[:, 5], 1000 * table["tz_nm"], rtol=2e-7)
        self.assertEqual(int(np.isnan(file.analogue[:, 3]).sum()), 100)
        self.assertEqual(file.parameters["FORCE_PLATFORM:TYPE"].tolist(), [1])
        self.assertEqual(file.parameters["FORCE_PLATFORM:CHANNEL"].ravel(order="F").tolist(), [1, 2, 3, 4, 5, 6])
        self.assertEqual(file.parameters["ANALOG:LABELS"], ["Fx1", "Fy1", "Fz1", "Px1", "Py1", "Mz1"])

    def test_SessionAsC3dHasTheFloatsOfItsCsv(self) -> None:
        # requirement: REP-6
        self.run_program("dtslab", "simulate", "floor", "--duration", "10", "--out", "standing.xdf")
        for kind in ("csv", "c3d"):
            self.run_program("dtsctl", "session", "export", "standing.xdf", "--format", kind, "--out", kind)

        file = C3d(next((self.folder / "c3d").glob("*.c3d")))
        table = columns(next((self.folder / "csv").glob("*_cop.csv")))
        first = round(float(table["t_s"][0]) * file.rate)  # C3D begins with the recording, the stream when its filter is full
        self.assertEqual(len(file.analogue) - first, len(table["t_s"]))
        self.assertTrue(np.isnan(file.analogue[:first]).all())
        for channel, name in ((2, "load_n"), (3, "ml_mm"), (4, "ap_mm")):
            self.assert_same(file.analogue[first:, channel], table[name])
        self.assertTrue(np.isnan(file.analogue[:, 0]).all())
        self.assertFalse(np.isnan(file.analogue[-1, 3]))


if __name__ == "__main__":
    unittest.main()
