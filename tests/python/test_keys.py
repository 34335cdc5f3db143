# SPDX-License-Identifier: Apache-2.0
"""A daemon on another machine: with a key, and with what is none."""
import os
import unittest
from pathlib import Path

import dts
from support import PATIENCE_S, DaemonProcess, free_ports


class KeyTest(unittest.TestCase):
    process: DaemonProcess
    folder: Path

    @classmethod
    def setUpClass(cls) -> None:
        control, data = free_ports(2)
        network = f'[network]\ncontrol = "tcp://127.0.0.1:{control}"\ndata = "tcp://127.0.0.1:{data}"\n\n'
        cls.process = DaemonProcess(further=network)
        cls.addClassCleanup(cls.process.close)
        relay = cls.process.start_relay()
        cls.addClassCleanup(relay.wait, PATIENCE_S)
        cls.addClassCleanup(relay.terminate)
        cls.folder = cls.process.folder

    def new_key(self, name: str, role: str) -> Path:
        file = self.folder / f"{name}.key"
        self.process.dtsctl("key", "new", name, "--role", role, "--out", str(file))
        return file

    def test_a_viewer_sees_and_does_nothing(self) -> None:
        with dts.connect(key=self.new_key("eve", "viewer"), timeout=PATIENCE_S) as daemon:
            block = next(daemon.stream("floor/cop"))
            self.assertGreater(len(block), 0)
            with self.assertRaisesRegex(dts.NotAllowed, "needs the role operator"):
                daemon.start_session("floor", "free")

    def test_an_operator_runs_a_session(self) -> None:
        with dts.connect(key=self.new_key("otto", "operator"), timeout=PATIENCE_S) as daemon:
            session = daemon.start_session("floor", "free", duration_s=60)
            session.stop()

    def test_a_key_that_the_daemon_does_not_know_stays_outside(self) -> None:
        file, other = self.new_key("gone", "viewer"), self.new_key("kept", "viewer")
        with dts.connect(key=file, timeout=PATIENCE_S):
            pass
        self.process.dtsctl("key", "revoke", "gone")
        with self.assertRaises(dts.Unreachable):
            dts.connect(key=file, timeout=1)
        with dts.connect(key=other, timeout=PATIENCE_S):
            pass  # the relay answers

    def test_what_is_no_key_file_is_reported(self) -> None:
        file = self.new_key("bad", "viewer")
        text = file.read_text()
        with self.assertRaisesRegex(dts.InvalidArgument, "not a key of 40 characters"):
            file.write_text(text.replace("secret_key = \"", "secret_key = \"x"))
            dts.read_key(file)
        with self.assertRaisesRegex(dts.InvalidArgument, "at line 1"):
            file.write_text("[[[")
            dts.read_key(file)
        file.write_text(text)
        os.chmod(file, 0o640)
        with self.assertRaisesRegex(dts.NotAllowed, "chmod 0600"):
            dts.read_key(file)
        with self.assertRaises(dts.InvalidArgument):
            dts.read_key(self.folder / "nowhere.key")
        os.mkfifo(self.folder / "pipe.key", 0o600)
        with self.assertRaisesRegex(dts.InvalidArgument, "not a regular file"):
            dts.read_key(self.folder / "pipe.key")

    def test_no_secret_is_shown(self) -> None:
        key = dts.read_key(self.new_key("quiet", "viewer"))
        self.assertNotIn(key.secret_key, repr(key))


if __name__ == "__main__":
    unittest.main()
