# SPDX-License-Identifier: Apache-2.0
"""Checks of the daemon's answers: every value used as a size, a divisor or a name must be valid.

The limits are those of clients/libdts/wire_check.cpp.
"""
import math
from collections.abc import Callable, Sequence
from typing import Any

from .errors import DataDamaged
from .v1 import control_pb2, sessions_pb2, stream_pb2

MAX_MESSAGE_BYTES = 1 << 20  # nothing that the daemon publishes is larger
MAX_ANSWER_BYTES = 4 * MAX_MESSAGE_BYTES  # an answer may hold a whole list: a thousand sessions, ten thousand trials

_MAX_RIGS = 64
_MAX_STREAMS = 64
_MAX_CHANNELS = 256
_MAX_SCANS = 65536
_MAX_TEXTS = 1000
_MAX_SESSIONS = 10_000
_MAX_PARTS = 1000
_MAX_TRIALS = 10_000
_MAX_CORRECTIONS = 10_000
_MAX_MARKERS = 1_000_000
_LONGEST_NAME = 64
_MAX_RATE_TERM = 10**12
_MAX_SCAN = 2**62  # scan indices are signed 64 bits in NumPy


def is_rate(rate: stream_pb2.Rate) -> bool:
    """Checks for a positive rate with both terms within the limits."""
    return 0 < rate.numerator <= _MAX_RATE_TERM and 0 < rate.denominator <= _MAX_RATE_TERM


def is_block(block: stream_pb2.StreamBlock) -> bool:
    """Checks a block. Returns no error text, because it runs for every block."""
    scans, channels = block.scan_count, block.channel_count
    return (
        block.instance_id != 0
        and 0 < scans <= _MAX_SCANS
        and 0 < channels <= _MAX_CHANNELS
        and len(block.values) == scans * channels
        and len(block.quality) == channels
        and block.first_scan <= _MAX_SCAN
        and is_rate(block.rate)
    )


def check_answer(response: control_pb2.Response) -> None:
    """Checks the answer to any command. Raises `DataDamaged` with the reason."""
    result = response.WhichOneof("result")
    check = _CHECKS.get(result) if result else None
    if check is not None:
        check(getattr(response, result))


def check_status(status: control_pb2.StatusSnapshot) -> None:
    """Checks a status of the daemon. Raises `DataDamaged` with the reason."""
    if status.instance_id == 0:
        raise _damaged("the instance ID is missing")
    _check_count(status.rigs, _MAX_RIGS, "rigs")
    _check_count(status.notices, _MAX_TEXTS, "notices")
    for rig in status.rigs:
        _check_rig(rig.rig)
        if rig.session.HasField("trial"):
            _check_trial(rig.session.trial)
    if status.disk.state not in sessions_pb2.DiskState.values():
        raise _damaged("the state of the disk is unknown")
    _check_amount(status.disk.recordable_s, "the recordable time")


def _damaged(what: str) -> DataDamaged:
    return DataDamaged(f"invalid answer of the daemon: {what}", "check that dtsd and this package have the same version")


def _check_count(items: Sequence[Any], limit: int, of_what: str) -> None:
    if len(items) > limit:
        raise _damaged(f"{len(items)} {of_what}, more than the limit of {limit}")


def _check_amount(value: float, of_what: str) -> None:
    """A duration or a length: never negative, never NaN."""
    if not (math.isfinite(value) and value >= 0.0):
        raise _damaged(f"{of_what} is {value}")


def _is_name(text: str) -> bool:
    return 0 < len(text.encode()) <= _LONGEST_NAME and "/" not in text


def _check_rig(rig: control_pb2.RigInfo) -> None:
    if not _is_name(rig.name):
        raise _damaged("a rig has no valid name")
    _check_count(rig.sensors, _MAX_CHANNELS, "sensors")
    _check_count(rig.streams, _MAX_STREAMS, "streams")
    for stream in rig.streams:
        if not _is_name(stream.name):
            raise _damaged("a stream has no valid name")
        if not is_rate(stream.rate):
            raise _damaged(f"stream '{stream.name}' has an invalid rate")
        if not stream.channels:
            raise _damaged(f"stream '{stream.name}' has no channels")
        _check_count(stream.channels, _MAX_CHANNELS, "channels")


def _check_rigs(rigs: control_pb2.ListRigsResponse) -> None:
    _check_count(rigs.rigs, _MAX_RIGS, "rigs")
    for rig in rigs.rigs:
        _check_rig(rig)


def _check_devices(devices: control_pb2.GetDevicesResponse) -> None:
    _check_count(devices.devices, _MAX_TEXTS, "devices")
    _check_count(devices.kinds, _MAX_TEXTS, "kinds of device")


def _check_device_test(test: control_pb2.TestDeviceResponse) -> None:
    _check_count(test.checks, _MAX_TEXTS, "checks")
    _check_count(test.channels, _MAX_CHANNELS, "channels")


def _check_session(session: control_pb2.SessionInfo) -> None:
    if not session.session_id:
        raise _damaged("a session has no ID")
    _check_count(session.rigs, _MAX_RIGS, "rigs")
    if session.HasField("trial"):
        _check_trial(session.trial)


def _check_trial(trial: sessions_pb2.TrialStatus) -> None:
    if trial.phase not in sessions_pb2.TrialPhase.values():
        raise _damaged("the phase of a trial is unknown")
    if trial.last_outcome not in sessions_pb2.TrialOutcome.values():
        raise _damaged("the outcome of a trial is unknown")
    if trial.last_fault not in sessions_pb2.TrialFault.values():
        raise _damaged("the fault of a trial is unknown")
    _check_amount(trial.next_target_cm, "a trial's target")
    _check_amount(trial.next_target_percent, "a trial's target")
    _check_amount(trial.remaining_s, "a trial's time")
    _check_amount(trial.settle_s, "a trial's settling time")
    _check_amount(trial.duration_s, "a trial's duration")
    _check_amount(trial.target_cm, "a trial's target")
    _check_amount(trial.target_percent, "a trial's target")
    _check_amount(trial.undo_s, "a trial's time to undo")


def _check_part(part: sessions_pb2.SessionPart) -> None:
    if part.state == sessions_pb2.PART_STATE_UNSPECIFIED or part.state not in sessions_pb2.PartState.values():
        raise _damaged("the state of a recording is unknown")
    _check_count(part.losses, _MAX_TEXTS, "causes of losses")
    _check_amount(part.duration_s, "the duration of a recording")
    _check_amount(part.lost_s_at_most, "the lost time of a recording")


def _check_record(session: sessions_pb2.SessionRecord) -> None:
    if not session.session_id:
        raise _damaged("a session has no ID")
    _check_count(session.parts, _MAX_PARTS, "parts")
    _check_count(session.trials, _MAX_TRIALS, "trials")
    _check_count(session.corrections, _MAX_CORRECTIONS, "corrections")
    _check_count(session.markers, _MAX_MARKERS, "markers")
    for part in session.parts:
        _check_part(part)


def _check_sessions(sessions: sessions_pb2.ListSessionsResponse) -> None:
    _check_count(sessions.sessions, _MAX_SESSIONS, "sessions")
    for session in sessions.sessions:
        _check_record(session)


def _check_subject(subject: sessions_pb2.SubjectRecord) -> None:
    _check_count(subject.sessions, _MAX_SESSIONS, "sessions")
    _check_count(subject.mentioning_sessions, _MAX_SESSIONS, "sessions")
    for session in subject.sessions:
        _check_record(session)


def _check_protocol(protocol: sessions_pb2.ProtocolInfo) -> None:
    if not _is_name(protocol.name):
        raise _damaged("a protocol has no valid name")
    _check_count(protocol.conditions, _MAX_TEXTS, "conditions")
    _check_count(protocol.fields, _MAX_TEXTS, "fields")
    _check_amount(protocol.settle_s, "a protocol's settling time")
    _check_amount(protocol.duration_s, "a protocol's duration")
    _check_amount(protocol.length_s, "a protocol's length")
    for condition in protocol.conditions:
        _check_amount(condition.settle_s, "a condition's settling time")
        _check_amount(condition.duration_s, "a condition's duration")
        _check_amount(condition.target_percent, "a condition's target")
    for field in protocol.fields:
        if not (math.isfinite(field.minimum) and math.isfinite(field.maximum) and field.minimum <= field.maximum):
            raise _damaged(f"field '{field.name}' has no valid range")
        _check_count(field.choices, _MAX_TEXTS, "choices")


def _check_protocols(protocols: sessions_pb2.ListProtocolsResponse) -> None:
    _check_count(protocols.protocols, _MAX_TEXTS, "protocols")
    for protocol in protocols.protocols:
        _check_protocol(protocol)


def _check_mark(mark: control_pb2.MarkResponse) -> None:
    _check_count(mark.marks, _MAX_RIGS, "marks")
    if not mark.marks:
        raise _damaged("no scan was marked")


_CHECKS: dict[str, Callable[[Any], None]] = {
    "status": check_status,
    "rigs": _check_rigs,
    "session": _check_session,
    "mark": _check_mark,
    "tare": lambda tare: _check_count(tare.baseline, _MAX_CHANNELS, "sensors"),
    "devices": _check_devices,
    "device_test": _check_device_test,
    "sessions": _check_sessions,
    "session_record": _check_record,
    "subjects": lambda subjects: _check_count(subjects.subjects, _MAX_SESSIONS, "subjects"),
    "subject": _check_subject,
    "erased": lambda erased: _check_count(erased.left, _MAX_SESSIONS, "notes"),
    "protocols": _check_protocols,
    "trial": _check_trial,
    "audit": lambda audit: _check_count(audit.entries, _MAX_SESSIONS, "entries"),
}
