# SPDX-License-Identifier: Apache-2.0
"""A running dtsd: its state, its streams and events, its sessions."""
import os
import time
from collections.abc import Iterable, Mapping
from types import TracebackType
from typing import Literal, Self

import numpy as np
import zmq
from numpy.typing import NDArray

from .control import ControlClient
from .endpoints import Endpoints, find_endpoints
from .errors import Error, InvalidArgument, NotFound, Timeout, WrongState
from .key import Key, read_key
from .live import Collector, EventStream, Stream, no_news
from .options import COMMANDS, EVENT_TOPICS
from .streams import Samples
from .subscriber import Subscriber, check_timeout
from .v1 import control_pb2, sessions_pb2, stream_pb2

TrialAction = Literal["next", "redo", "reject", "undo"]
Outcome = Literal["done", "redone", "rejected", "aborted"]

_SUBSCRIBED_S = 5.0  # a daemon that runs answers a subscription at once
_OVER = (stream_pb2.SESSION_STATE_UNSPECIFIED, stream_pb2.SESSION_STATE_IDLE, stream_pb2.SESSION_STATE_FAILED)


def connect(control: str = "", data: str = "", timeout: float | None = None, key: str | os.PathLike[str] = "") -> "Daemon":
    """Connects to a daemon and returns it. Raises `Unreachable` at once if no daemon answers.

    `control` and `data` are ZeroMQ addresses; empty ones are looked up, see `find_endpoints`.

    `timeout` is the time limit of a command in seconds, over all tries (0.03 to 86400). Default: 3 s, but 15 s for `tare` and 20 s for the
    end of a session.

    `key` is the key file for a daemon on another machine (`dtsctl key new` makes it); it contains the addresses. Default: the file in the
    environment variable DTSD_KEY, if set. Raises `InvalidArgument` or `NotAllowed` if the file is not usable.
    """
    file = key or os.environ.get("DTSD_KEY", "")
    found = read_key(file) if file else None
    if found and not control and not data:
        if not found.control and not os.environ.get("DTSD_CONTROL"):
            raise InvalidArgument(
                f"key file {file} contains no address", "give control and data, or make a new key when [network] is set: dtsctl key new"
            )
        control, data = found.control, found.data
    daemon = Daemon(find_endpoints(control, data), timeout, found)
    try:
        daemon.status()
    except BaseException:
        daemon.close()
        raise
    return daemon


class Daemon:
    """A running dtsd. `connect` returns it; use it in a `with`, or call `close`.

    Threads: any thread may send commands; one command is sent at a time. Only one thread may iterate a stream.

    Commands return messages of dts.v1; proto/dts/v1/*.proto explains every field. Every command raises `Unreachable` if no answer arrives
    in time, `DataDamaged` if the answer contradicts itself, and otherwise the error that the daemon sent.
    """

    def __init__(self, endpoints: Endpoints, timeout: float | None = None, key: Key | None = None) -> None:
        self.endpoints = endpoints
        self._context: "zmq.Context[zmq.Socket[bytes]]" = zmq.Context()
        if key:
            key.use(self._context)
        self._control = ControlClient(self._context, endpoints.control, timeout)

    def close(self) -> None:
        """Closes the connection and all streams. Later commands and iterations raise `InvalidArgument`.

        Call it when no other thread waits for a stream: closing a socket under a waiting thread ends that wait with an error of libzmq.
        """
        self._control.close()
        self._context.destroy(linger=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    # Live data

    def stream(self, *topics: str, timeout: float = 5.0) -> Stream:
        """Returns an iterator over the blocks of one or more streams ("floor/cop"), from now on.

        The iterator raises `Timeout` if no block arrives for `timeout` seconds (0 to 86400), and `Unreachable` if the daemon sends nothing
        at all; iterate again to wait longer. Raises `NotFound` if the daemon does not publish a stream.
        """
        check_timeout(timeout)
        self._check_streams(topics)
        return Stream(self._subscribe(topics), f"block of {' or '.join(topics)}", timeout)

    def events(self, *prefixes: str, timeout: float = 60.0) -> EventStream:
        """Returns an iterator over events, from now on: all events, or those of topics that begin with a prefix: "floor/", "chair/reach".

        The iterator raises `Timeout` if no event arrives for `timeout` seconds (0 to 86400), and `Unreachable` if the daemon sends nothing
        at all; iterate again to wait longer. Raises `NotFound` if no event topic begins with one of the prefixes.
        """
        check_timeout(timeout)
        known = [f"{rig}/{name}" for rig in self.rigs for name in sorted(EVENT_TOPICS)]
        topics = [topic for topic in known if topic.startswith(prefixes or "")]
        for prefix in prefixes or ("",):
            if not any(topic.startswith(prefix) for topic in known):
                raise NotFound(f"no events begin with {prefix}", f"the event topics are {', '.join(known)}")
        return EventStream(self._subscribe(topics), f"event of {' or '.join(prefixes) or 'any rig'}", timeout)

    def record(self, topic: str, seconds: float, timeout: float = 5.0) -> Samples:
        """Receives the next `seconds` of a stream and returns them as one object, with a list of its gaps.

        Raises `Timeout` if no block arrives for `timeout` seconds, `Unreachable` if the daemon sends nothing at all, `NotFound` if the
        daemon does not publish the stream, and `InvalidArgument` if `seconds` is not positive.
        """
        self._check_streams((topic,))
        rates = {rig.rig.name: rig.nominal_rate_hz for rig in self.status().rigs}
        collector = Collector(seconds, rates.get(topic.partition("/")[0], 0.0))
        subscriber = self._subscribe((topic, f"{topic.partition('/')[0]}/gap"))
        try:
            while not collector.is_complete:
                item = subscriber.receive(check_timeout(timeout))
                if item is None:
                    raise no_news(subscriber, f"block of {topic}", timeout)
                collector.add(item)
        finally:
            subscriber.close()
        return collector.samples()

    # State

    def status(self) -> control_pb2.StatusSnapshot:
        """Returns the present state of the daemon, its rigs, devices and sessions."""
        return self._control.call(control_pb2.Request(status=control_pb2.StatusRequest())).status

    @property
    def rigs(self) -> dict[str, control_pb2.RigInfo]:
        """The rigs by name, with plate, sensors, streams and stages. Every access asks the daemon."""
        response = self._control.call(control_pb2.Request(list_rigs=control_pb2.ListRigsRequest()))
        return {rig.name: rig for rig in response.rigs.rigs}

    def devices(self) -> control_pb2.GetDevicesResponse:
        """Returns the connected devices, and the kinds of device that a rig can use."""
        return self._control.call(control_pb2.Request(get_devices=control_pb2.GetDevicesRequest())).devices

    def test_device(self, rig: str) -> control_pb2.TestDeviceResponse:
        """Returns statistics of each channel of the rig's device over the last second.

        If the device does not stream, but the checks of its last start are known, the answer has them, the cause in `.problem`, and no
        channels. Raises `NotFound` for an unknown rig, `DeviceGone` if the device does not stream and no checks are known, and `WrongState`
        in its first second.
        """
        return self._control.call(control_pb2.Request(test_device=control_pb2.TestDeviceRequest(rig=rig))).device_test

    # Sessions

    def start_session(
        self,
        rig: str,
        protocol: str,
        subject: str = "",
        label: str = "",
        duration_s: float = 0.0,
        settle_s: float = 0.0,
        fields: Mapping[str, object] | None = None,
        companions: Iterable[str] = (),
    ) -> "Session":
        """Starts a session and its recordings, and returns the session.

        `protocol` is a name from `protocols`; "free" records until stopped. `subject` is the subject ID, never a name. `label` is a note, never a
        name. `duration_s` stops the session automatically; 0 means the duration of the protocol, or no limit. `settle_s` is the settling
        time before the measurement; 0 means the time of the protocol. Both are in seconds. `fields` are the values that the protocol
        requires. `companions` are further rigs that record the same session; its trials and results are those of `rig`.

        Raises `NotFound` for an unknown rig, `InvalidArgument` for an unknown protocol or an invalid value, and `WrongState` if the rig has
        a session.
        """
        if isinstance(companions, str):  # it would be taken letter by letter
            raise TypeError("companions is a list of rigs, not a text")
        wanted = control_pb2.StartSessionRequest(
            rig=rig,
            protocol=protocol,
            subject=subject,
            label=label,
            duration_s=duration_s,
            settle_s=settle_s,
            fields={name: str(value) for name, value in (fields or {}).items()},
            companions=companions,
        )
        return Session(self, self._control.call(control_pb2.Request(start_session=wanted)).session)

    def resume_session(self, session_id: str) -> "Session":
        """Resumes an interrupted session as a new part of its recording. Raises `NotFound` for an unknown ID."""
        wanted = sessions_pb2.ResumeSessionRequest(session_id=session_id)
        return Session(self, self._control.call(control_pb2.Request(resume_session=wanted)).session)

    def stop_session(self, rig: str = "", is_abort: bool = False, reason: str = "") -> control_pb2.SessionInfo:
        """Stops the session of a rig, on all its rigs, waits until its recordings are closed, and returns its state.

        An empty `rig` means the only session. `is_abort` lists the session as aborted, with `reason` (never a name). Raises
        `WrongState` if there is no session.
        """
        wanted = control_pb2.StopSessionRequest(rig=rig, is_abort=is_abort, reason=reason)
        return self._control.call(control_pb2.Request(stop_session=wanted)).session

    def mark(self, text: str, rig: str = "") -> list[control_pb2.MarkResponse.At]:
        """Puts a marker at the newest scan of a rig and of the other rigs of its session, or of every rig if `rig` is empty. Returns the
        marked scans. `text` has 1 to 200 bytes.
        """
        return list(self._control.call(control_pb2.Request(mark=control_pb2.MarkRequest(text=text, rig=rig))).mark.marks)

    def trial(self, action: TrialAction, rig: str = "") -> sessions_pb2.TrialStatus:
        """Executes one step of the protocol's trials and returns the state of the trials.

        "next" starts the next trial, or ends a trial without a fixed duration; "redo" discards the present or last trial and repeats it;
        "reject" discards it and continues without it; "undo" takes back the last of both for 5 s. An empty `rig` means the only rig that has a session. Raises `WrongState` if the rig
        has no session with trials.
        """
        actions = {
            "next": sessions_pb2.TRIAL_ACTION_NEXT,
            "redo": sessions_pb2.TRIAL_ACTION_REDO,
            "reject": sessions_pb2.TRIAL_ACTION_REJECT,
            "undo": sessions_pb2.TRIAL_ACTION_UNDO,
        }
        return self._control.call(control_pb2.Request(trial=sessions_pb2.TrialRequest(rig=rig, action=actions[action]))).trial

    def tare(self, rig: str) -> NDArray[np.float64]:
        """Tares a rig: what the empty rig reads now becomes zero. Returns the baseline of each sensor in mm; of a force plate, that of
        each channel in V.

        The plate or chair must be empty. Raises `WrongState` if the device does not stream, if the rig has a session, or if the
        values are not steady or show a load.
        """
        return np.array(self._control.call(control_pb2.Request(tare=control_pb2.TareRequest(rig=rig))).tare.baseline)

    def protocols(self) -> dict[str, sessions_pb2.ProtocolInfo]:
        """Returns the protocols by name, with their conditions and required fields."""
        response = self._control.call(control_pb2.Request(list_protocols=sessions_pb2.ListProtocolsRequest()))
        return {protocol.name: protocol for protocol in response.protocols.protocols}

    def sessions(
        self, rig: str = "", subject: str = "", protocol: str = "", limit: int = 0, deleted: bool = False
    ) -> list[sessions_pb2.SessionRecord]:
        """Returns sessions of the catalogue, newest first, with their parts and without their trials.

        `rig`, `subject` (subject ID) and `protocol` select; empty means all. At most `limit` sessions; 0 means 100. `deleted` lists the
        deleted sessions instead.
        """
        wanted = sessions_pb2.ListSessionsRequest(rig=rig, subject=subject, protocol=protocol, limit=limit, deleted=deleted)
        return list(self._control.call(control_pb2.Request(list_sessions=wanted)).sessions.sessions)

    def session(self, session_id: str) -> sessions_pb2.SessionRecord:
        """Returns one session of the catalogue with its parts, trials and results. Raises `NotFound` for an unknown ID.

        `.parts` has the files of the recordings, on the daemon's machine.
        """
        wanted = sessions_pb2.ShowSessionRequest(session_id=session_id)
        return self._control.call(control_pb2.Request(show_session=wanted)).session_record

    def correct_session(
        self,
        session_id: str,
        reason: str,
        subject: str | None = None,
        label: str | None = None,
        notes: str | None = None,
        trial: int = 0,
        attempt: int = 0,
        part: int = 0,
        outcome: Outcome | None = None,
        marker: int = 0,
        marker_text: str | None = None,
    ) -> sessions_pb2.SessionRecord:
        """Corrects a closed session and returns it. The recording stays as it is; `.corrections` of the session has both values.

        None leaves a value as it is, "" removes it. `trial` and `outcome` correct the outcome of a trial: of its newest attempt, or of
        `attempt`; `part` is needed if several parts have this attempt. `marker` (its number in `.markers`) and `marker_text` correct the
        text of a marker. `reason` has 1 to 200 bytes and no name. Raises `NotFound` for an unknown session, trial or marker,
        `InvalidArgument` for a value that is not allowed or if nothing would change, and `WrongState` while the session runs.
        """
        wanted = sessions_pb2.CorrectSessionRequest(
            session_id=session_id,
            subject=subject,
            label=label,
            notes=notes,
            trial=trial,
            attempt=attempt,
            part=part,
            outcome=outcome or "",
            marker=marker,
            marker_text=marker_text,
            reason=reason,
        )
        return self._control.call(control_pb2.Request(correct_session=wanted)).session_record

    def delete_session(self, session_id: str, reason: str) -> sessions_pb2.SessionRecord:
        """Hides a closed session from all lists and returns it. `restore_session` shows it again. Raises `WrongState` while it runs."""
        wanted = sessions_pb2.DeleteSessionRequest(session_id=session_id, reason=reason)
        return self._control.call(control_pb2.Request(delete_session=wanted)).session_record

    def restore_session(self, session_id: str, reason: str = "") -> sessions_pb2.SessionRecord:
        """Shows a deleted session again and returns it. Raises `WrongState` if it is not deleted."""
        wanted = sessions_pb2.DeleteSessionRequest(session_id=session_id, reason=reason, is_restore=True)
        return self._control.call(control_pb2.Request(delete_session=wanted)).session_record

    def subjects(self) -> list[sessions_pb2.SubjectInfo]:
        """Returns all subject IDs with the number of their sessions."""
        return list(self._control.call(control_pb2.Request(list_subjects=sessions_pb2.ListSubjectsRequest())).subjects.subjects)

    def subject(self, subject: str) -> sessions_pb2.SubjectRecord:
        """Returns everything that has this subject ID. Raises `NotFound` if nothing has it."""
        wanted = sessions_pb2.ShowSubjectRequest(subject=subject)
        return self._control.call(control_pb2.Request(show_subject=wanted)).subject

    def subject_results(self, subject: str) -> sessions_pb2.SubjectRecord:
        """The same with the results of its newest 200 sessions."""
        wanted = sessions_pb2.ShowSubjectRequest(subject=subject, with_results=True)
        return self._control.call(control_pb2.Request(show_subject=wanted)).subject

    def erase_subject(self, subject: str) -> sessions_pb2.EraseSubjectResponse:
        """Erases a subject for ever: recordings, catalogue, corrections. Waits until the files are removed.

        `.left` of the answer names what a person must look at, `.backups` what to do with backups. Raises `NotFound` if nothing has this
        subject ID, and `WrongState` while one of its sessions runs.
        """
        wanted = sessions_pb2.EraseSubjectRequest(subject=subject)
        return self._control.call(control_pb2.Request(erase_subject=wanted)).erased

    def audit(self, limit: int = 0) -> sessions_pb2.GetAuditResponse:
        """Returns the newest entries of the audit trail; a `limit` of 0 means 100. A broken chain raises nothing: see `problem` in the
        answer.
        """
        return self._control.call(control_pb2.Request(get_audit=sessions_pb2.GetAuditRequest(limit=limit))).audit

    def _check_streams(self, topics: tuple[str, ...]) -> None:
        known = [f"{rig.name}/{name}" for rig in self.rigs.values() for name in rig.published]
        for topic in topics or ("",):
            if topic not in known:
                hint = "to publish a stream, add it to streams in [publish] of the rig file"
                raise NotFound(f"no stream '{topic}'; the streams are {', '.join(known)}", hint)

    def _subscribe(self, topics: tuple[str, ...] | list[str]) -> Subscriber:
        subscriber = Subscriber(self._context, self.endpoints.data, topics, frozenset(topics).__contains__)
        try:
            subscriber.wait_until_subscribed(_SUBSCRIBED_S)
        except BaseException:
            subscriber.close()
            raise
        return subscriber


class Session:
    """A running session. `Daemon.start_session` returns it.

    At the end of a `with`, the session is stopped. If an exception ends the `with`, the session is aborted; its recording stays.

    `mark`, `trial`, `stop` and `abort` raise `WrongState` if the session has ended. They ask the daemon first, because these commands name
    the rig and not the session: if the session ends between the question and the command, and another one begins on the rig, the command
    goes to the other session.
    """

    def __init__(self, daemon: Daemon, info: control_pb2.SessionInfo) -> None:
        self._daemon = daemon
        self.id = info.session_id
        self.rig = info.rig

    def info(self) -> control_pb2.SessionInfo:
        """Returns the present state. Raises `WrongState` if the session has ended."""
        for rig in self._daemon.status().rigs:
            session: control_pb2.SessionInfo = rig.session
            if rig.rig.name == self.rig and session.session_id == self.id and session.state not in _OVER:
                return session
        raise WrongState(f"session {self.id} has ended", f"read its results: daemon.session('{self.id}')")

    @property
    def is_running(self) -> bool:
        """True until the session has ended. Every access asks the daemon."""
        try:
            self.info()
        except WrongState:
            return False
        return True

    def wait(self, timeout: float) -> sessions_pb2.SessionRecord:
        """Waits until a session with a duration ends and its recording is closed; returns the session with its results.

        Raises `Timeout` after `timeout` seconds (0 to 86400).
        """
        deadline_s = time.monotonic() + check_timeout(timeout)
        while True:
            if not self.is_running:
                record = self._daemon.session(self.id)
                if record.state != "running":  # as it stays until the file is closed
                    return record
            if time.monotonic() > deadline_s:
                raise Timeout(f"session {self.id} has not ended after {timeout:g} s", "wait longer, or stop it: session.stop()")
            time.sleep(0.1)

    def mark(self, text: str) -> control_pb2.MarkResponse.At:
        """Puts a marker at the newest scan of all rigs of the session; returns that of `rig`. `text` has 1 to 200 bytes."""
        self.info()
        return self._daemon.mark(text, self.rig)[0]

    def trial(self, action: TrialAction) -> sessions_pb2.TrialStatus:
        """Executes one step of the protocol's trials: see `Daemon.trial`."""
        self.info()
        return self._daemon.trial(action, self.rig)

    def stop(self) -> sessions_pb2.SessionRecord:
        """Stops the session, waits until its recording is closed, and returns the session with its results."""
        self.info()
        self._daemon.stop_session(self.rig)
        return self._daemon.session(self.id)

    def abort(self, reason: str) -> sessions_pb2.SessionRecord:
        """Aborts the session and returns it. It is listed as aborted, with `reason` (never a name); its recording stays.

        The daemon leaves out a reason that the clinic does not allow as a label: the answer of `Daemon.stop_session` says so in `message`.
        """
        self.info()
        self._daemon.stop_session(self.rig, is_abort=True, reason=reason)
        return self._daemon.session(self.id)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        try:
            self._leave(kind)
        except Error as problem:
            if error is None:
                raise
            error.add_note(f"session {self.id} was not aborted: {problem}")  # the error of the program, or Ctrl-C, counts

    def _state(self) -> str:
        """Returns the state in the catalogue; "" if the session is not there any more."""
        try:
            return self._daemon.session(self.id).state
        except NotFound:
            return ""

    def _leave(self, kind: type[BaseException] | None) -> None:
        if not self.is_running:
            if kind is None and self._state() == "interrupted":
                raise WrongState(f"session {self.id} was interrupted: the daemon or the power failed", "see its parts: daemon.session(ID)")
            return
        try:
            if kind is None:
                self.stop()
            else:
                self.abort(f"{kind.__name__} in a program")  # a second word with a capital letter would look like a name
        except WrongState:  # it ends by itself in this moment
            self.wait(COMMANDS["stop_session"].timeout_s)

    def __repr__(self) -> str:
        return f"<dts.Session {self.id}>"
