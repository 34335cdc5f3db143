# SPDX-License-Identifier: Apache-2.0
"""One recording of each kind that analysts receive, made by a real dtsd with simulated rigs."""
import dataclasses
import signal
import time

import dts
from support import DaemonProcess, wait_for

RIGS = """
[[rig]]
name = "platform"
file = "rigs/floor-sim-stack.toml"
device = "sim:stack?seed=7&noise_mv=3"

[[rig]]
name = "plate"
file = "rigs/force-plate-sim-stack.toml"
device = "sim:stack?part=plate&seed=7&height_mm=50"

"""
PAUSE_S = 6.0  # longer than a simulated device keeps scans (4 s)


@dataclasses.dataclass(frozen=True)
class Recorded:
    kind: str
    session_id: str
    files: tuple[str, ...]  # one for each part


def record(process: DaemonProcess) -> list[Recorded]:
    """Records one session of each kind. The daemon must have the rigs of RIGS. Restarts the daemon once."""
    sessions = {
        "floor": _floor(process),
        "chair": _chair(process),
        "gapped": _gapped(process),
        "two-part": _two_part(process),
        "force plate": _force_plate(process),
        "resumed": _resumed(process),
    }
    with process.connect() as daemon:
        return [Recorded(kind, name, tuple(part.file for part in daemon.session(name).parts)) for kind, name in sessions.items()]


def _floor(process: DaemonProcess) -> str:
    with process.connect() as daemon:
        wait_for(lambda: bool(daemon.record("floor/cop", 0.1)["load_n"].mean() > 50), "a person stands on the plate")
        with daemon.start_session("floor", "quiet-standing", subject="P-017", label="first day") as session:
            session.trial("next")
            daemon.record("floor/cop", 1.0)
            session.mark("eyes closed, \"both\" feet & arms ä")
            daemon.record("floor/cop", 0.2)
            session.trial("reject")
        return session.id


def _chair(process: DaemonProcess) -> str:
    with process.connect() as daemon:
        required = [field for field in daemon.protocols()["reaching-short"].fields if field.is_required]
        fields = {field.name: field.choices[0] if field.choices else f"{(field.minimum + field.maximum) / 2:g}" for field in required}
        with daemon.start_session("chair", "reaching-short", subject="P-017", fields=fields) as session:
            session.trial("next")
            daemon.record("chair/transient", 2.0)
        return session.id


def _gapped(process: DaemonProcess) -> str:
    """The daemon stops for longer than its devices keep scans, so that each rig loses some."""
    with process.connect() as daemon:
        session = daemon.start_session("floor", "free", subject="P-018")
        daemon.record("floor/cop", 1.0)
        segment = _segment(daemon)
        process.send(signal.SIGSTOP)
        time.sleep(PAUSE_S)
        process.send(signal.SIGCONT)
        wait_for(lambda: _segment(daemon) > segment, "a new segment begins")  # its event may be missed by this stopped connection
        daemon.record("floor/cop", 1.0)
        session.stop()
        return session.id


def _segment(daemon: dts.Daemon) -> int:
    return next(rig.segment for rig in daemon.status().rigs if rig.rig.name == "floor")


def _two_part(process: DaemonProcess) -> str:
    with process.connect() as daemon:
        session = daemon.start_session("floor", "free", subject="P-018")
        daemon.record("floor/cop", 1.0)
        session.abort("pause")
        session = daemon.resume_session(session.id)
        daemon.record("floor/cop", 1.0)
        session.stop()
        return session.id


def _force_plate(process: DaemonProcess) -> str:
    with process.connect() as daemon:
        with daemon.start_session("platform", "free", companions=["plate"]) as session:
            session.mark("over two rigs")
            daemon.record("plate/force", 1.0)
        return session.id


def _resumed(process: DaemonProcess) -> str:
    """The daemon is killed in the session and started again."""
    with process.connect() as daemon:
        session = daemon.start_session("floor", "free", subject="P-019")
        daemon.record("floor/cop", 2.0)
        process.stop(signal.SIGKILL)
    process.start()
    with process.connect() as daemon:
        wait_for(lambda: daemon.session(session.id).state == "interrupted", "the daemon finds the interrupted session")
        resumed = daemon.resume_session(session.id)
        daemon.record("floor/cop", 1.0)
        resumed.stop()
        return session.id
