# SPDX-License-Identifier: Apache-2.0
"""Changes a copy of the protocol and looks what protocol_freeze.py says."""
import contextlib
import io
import shutil
import tempfile
import unittest
from pathlib import Path

import protocol_freeze

SOURCE = Path(__file__).resolve().parent.parent.parent.parent


class Freeze(unittest.TestCase):
    def setUp(self) -> None:
        self.root = Path(tempfile.mkdtemp(prefix="dts-"))
        self.addCleanup(shutil.rmtree, self.root)
        (self.root / "proto" / "dts" / "v1").mkdir(parents=True)
        self.write('message A { float x = 1; optional string y = 2; oneof z { int32 p = 3; } } enum E { E_UNSPECIFIED = 0; E_ONE = 1; }')
        self.assertEqual(self.call("add")[0], 0)

    def write(self, text: str) -> None:
        (self.root / "proto" / "dts" / "v1" / "a.proto").write_text(f'syntax = "proto3"; package dts.v1; {text}')

    def call(self, action: str) -> tuple[int, str]:
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            status = protocol_freeze.main([action, str(self.root)])
        return status, out.getvalue()

    def changed(self, old: str, new: str) -> tuple[int, str]:
        file = self.root / "proto" / "dts" / "v1" / "a.proto"
        text = file.read_text()
        self.assertIn(old, text)
        file.write_text(text.replace(old, new))
        return self.call("check")

    def test_UnchangedProtocolPasses(self) -> None:
        self.assertEqual(self.call("check"), (0, ""))

    def test_EveryBreakingChangeFailsAndIsNotAdded(self) -> None:
        # requirement: PUB-8
        original = (self.root / "proto" / "dts" / "v1" / "a.proto").read_text()
        for old, new, named in [
            ("x = 1", "x = 9", "field dts.v1.A 1 x: float"),  # another number
            ("float x", "float w", "field dts.v1.A 1 x: float"),  # another name
            ("float x", "double x", "field dts.v1.A 1 x: float"),  # another type
            ("float x", "repeated float x", "field dts.v1.A 1 x: float"),
            ("optional string", "string", "field dts.v1.A 2 y: optional string"),  # absence is not visible any more
            ("oneof z { int32 p = 3; }", "int32 p = 3;", "field dts.v1.A 3 p: int32 in z"),
            ("E_ONE = 1", "E_ONE = 2", "value dts.v1.E 1 E_ONE"),
            ("optional string y = 2;", "", "field dts.v1.A 2 y: optional string"),  # removed
            ("message A", "message B", "message dts.v1.A"),
        ]:
            with self.subTest(f"{old} -> {new}"):
                (self.root / "proto" / "dts" / "v1" / "a.proto").write_text(original)
                status, said = self.changed(old, new)
                self.assertEqual(status, 1)
                self.assertIn(f"no longer has '{named}'", said)
                self.assertEqual(self.call("add")[0], 1)

    def test_NewFieldFailsUntilItIsAdded(self) -> None:
        status, said = self.changed("float x = 1;", "float x = 1; bool is_new = 4;")

        self.assertEqual(status, 1)
        self.assertIn("'field dts.v1.A 4 is_new: bool' is not listed: run python3 tests/unit/protocol/protocol_freeze.py add .", said)
        self.assertEqual(self.call("add"), (0, "proto/frozen.txt: 1 new lines\n"))
        self.assertEqual(self.call("check"), (0, ""))

    def test_TheListHasTheProtocolOfThisTree(self) -> None:
        # requirement: PUB-8
        lines = (SOURCE / protocol_freeze.FROZEN).read_text().splitlines()

        self.assertIn("field dts.v1.StreamBlock", "\n".join(lines))
        self.assertEqual(len(lines), len(set(lines)))


if __name__ == "__main__":
    unittest.main()
