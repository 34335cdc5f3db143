# SPDX-License-Identifier: Apache-2.0
"""A clinic on this machine: dtsd with simulated rigs and dts-forward, behind a line that can be limited and cut."""
import contextlib
import json
import os
import shutil
import sqlite3

from centre import Centre
from child import PATIENCE_S, REPOSITORY, Child, Failure, program, run, wait_until
from line import Line

FLOOR = ("floor", "floor-sim.toml", "sim:floor")
CHAIR = ("chair", "chair-sim.toml", "sim:chair")
# 16 channels at 1500 Hz: 0.2 MB/s of recording, so that an upload takes a while.
LARGE_FLOOR = ("floor", "floor16-fast.toml", "sim:floor")


class Clinic:
    """`start` enrols it and starts its programs. `daemon` and `forwarder` may be killed and started again."""

    def __init__(self, centre: Centre, name: str, rigs: tuple[tuple[str, str, str], ...] = (FLOOR, CHAIR), seed: int = 1,
                 bytes_per_s: float | None = None, settings: str = "", daemon_settings: str = "", has_line: bool = True) -> None:
        self.name = name
        self.centre = centre
        self.folder = centre.folder / name
        # One to each machine of the centre. Without, the clinic connects by itself: for measurements.
        self.lines = [Line(port, bytes_per_s) for port in centre.nats_ports if has_line]
        self.config = self.folder / "forward.toml"
        self.public_key = ""
        self.protocols: dict[str, str] = {}  # more of them, by name: the text of the file
        self._rigs = rigs
        self._seed = seed
        self._settings = settings
        self._daemon_settings = daemon_settings
        self._environment = os.environ | {"DTSD_RUNTIME_DIR": str(self.folder / "run"), "DTSD_STATE_DIR": str(self.folder / "state")}
        for variable in ("DTSD_CONTROL", "DTSD_DATA"):
            self._environment.pop(variable, None)
        self.daemon = Child(f"dtsd of {name}", [program("dtsd"), "--config", self.folder / "config/dtsd.toml", "--foreground"],
                            centre.folder / f"{name}-dtsd.log", env=self._environment)
        self.forwarder = Child(f"dts-forward of {name}", [program("dts-forward"), "run", "--config", self.config],
                               centre.folder / f"{name}-forward.log", env=self._environment)

    @property
    def line(self) -> Line:
        return self.lines[0]

    def start(self, title: str = "") -> None:
        self.folder.mkdir()
        self._write_settings()
        self.public_key = self.forward("key").split()[-1]
        self.centre.enrol(self.name, title or self.name.capitalize(), self.public_key, [line.port for line in self.lines] or self.centre.nats_ports,
                          self.folder / f"{self.name}.enrolment.toml")
        self.daemon.start()
        wait_until(f"{self.daemon.name} answers", lambda: self.daemon.expect_alive() and self.answers())
        self.forwarder.start()

    def close(self) -> None:
        self.forwarder.stop()
        self.daemon.stop()
        for line in self.lines:
            line.close()

    # What a person at the clinic does

    def dtsctl(self, *words: str) -> str:
        patient = words if words[0] == "--timeout" else ("--timeout", f"{PATIENCE_S:g}", *words)
        return run(program("dtsctl"), *patient, env=self._environment)

    def forward(self, command: str, *words: str) -> str:
        return run(program("dts-forward"), command, *words, "--config", self.config, env=self._environment)

    def problem(self) -> str:
        """Returns why dts-forward does not deliver; empty: it does."""
        return str(json.loads(self.forward("status", "--json")).get("problem", ""))

    def record(self, seconds: float, rig: str = "floor", *words: str) -> str:
        """Records a session that ends by itself. Returns its ID at once."""
        return self.dtsctl("session", "start", "--rig", rig, "--protocol", "free", "--duration", f"{seconds:g}", *words).strip()

    def recorded(self) -> dict[str, dict]:
        """Returns the closed parts, with the file's SHA-256 as key."""
        parts = {}
        for session in json.loads(self.dtsctl("session", "list", "--limit", "1000", "--json"))["sessions"]:
            for part in session.get("parts", []):
                if part.get("sha256"):
                    parts[part["sha256"]] = part | {"session_id": session["session_id"]}
        return parts

    def sent(self) -> list[dict]:
        """Returns what dts-forward has noted of each recording: sha256 of what is sent ("" before it is known), recorded_sha256, receipt."""
        path = self.folder / "forward/sent.sqlite"
        try:
            with contextlib.closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True, timeout=PATIENCE_S)) as database:
                rows = database.execute("SELECT sent, recorded, state = 1 FROM file").fetchall()
        except sqlite3.OperationalError:  # dts-forward has not made it yet
            return []
        return [{"sha256": sent, "recorded_sha256": recorded, "receipt": bool(receipt)} for sent, recorded, receipt in rows]

    def undelivered(self) -> set[str]:
        """Returns the recordings without a receipt, by their SHA-256."""
        return set(self.recorded()) - {row["recorded_sha256"] for row in self.sent() if row["receipt"]}

    def is_recording(self) -> bool:
        return any(session["state"] == "running" for session in json.loads(self.dtsctl("session", "list", "--limit", "5", "--json"))["sessions"])

    def answers(self) -> bool:
        try:
            self.dtsctl("--timeout", "1", "status")
        except Failure:
            return False
        return True

    def _write_settings(self) -> None:
        configuration = self.folder / "config"
        shutil.copytree(REPOSITORY / "config", configuration)
        large = (configuration / "rigs/floor16-sim.toml").read_text()
        (configuration / "rigs/floor16-fast.toml").write_text(large.replace("rate_hz = 100.0", "rate_hz = 1500.0"))
        for name, text in self.protocols.items():
            (configuration / "protocols" / f"{name}.toml").write_text(text)
        (self.folder / "run").mkdir(mode=0o750)
        lines = ["[realtime]", "fifo_priority = 0", "lock_memory = false", "[storage]", "refuse_below_min = 0.1", self._daemon_settings]
        for number, (name, file, device) in enumerate(self._rigs):
            lines += ["[[rig]]", f'name = "{name}"', f'file = "rigs/{file}"', f'device = "{device}?seed={self._seed + number}"']
        (configuration / "dtsd.toml").write_text("\n".join(lines) + "\n")
        self.config.write_text(f"""\
enrolment = "{self.name}.enrolment.toml"
key = "{self.name}.nk"
state = "{self.folder}/forward"
{self._settings}""")
