# SPDX-License-Identifier: Apache-2.0
"""A running dtsd: its state, its streams and events, its sessions."""
import os
import time
from collections.abc import Mapping
from types import TracebackType
from typing import Literal, Self

import numpy as np
import zmq
from numpy.typing import NDArray

from .control import ControlClient
from .endpoints import Endpoints, find_endpoints
from .errors import NotFound, Timeout, WrongState
from .key import Key, read_key
from .live import Collector, EventStream, Stream, no_news
from .options import EVENT_TOPICS
from .streams import Samples
from .subscriber import Subscriber, check_timeout
from .v1 import control_pb2, sessions_pb2, stream_pb2

TrialAction = Literal["next", "redo", "reject"]

_SUBSCRIBED_S = 5.0  # a daemon that runs answers a subscription at once
_OVER = (stream_pb2.SESSION_STATE_UNSPECIFIED, stream_pb2.SESSION_STATE_IDLE, stream_pb2.SESSION_STATE_FAILED)


def connect(control: str = "", data: str = "", timeout: float | None = None, key: str | os.PathLike[str] = "") -> "Daemon":
    """Finds a daemon (see `find_endpoints`) and asks for its status: who is not there is `Unreachable` at once.

    `key` is a file of `dtsctl key new`, for a daemon on another machine; it knows the addresses. Without it DTSD_KEY is looked at.

    `timeout` is that of a command in seconds, all tries together: 3 s unless given, 15 s for `tare`, 20 s for the end of a session.
    """
    file = key or os.environ.get("DTSD_KEY", "")
    found = read_key(file) if file else None
    if found and not control and not data:
        control, data = found.control, found.data
    daemon = Daemon(find_endpoints(control, data), timeout, found)
    try:
        daemon.status()
    except BaseException:
        daemon.close()
        raise
    return daemon


class Daemon:
    """Made by `connect`. Commands may come from any thread, one is sent at a time; a stream belongs to the thread that iterates it.

    Commands return the messages of dts.v1, where every field is explained (proto/dts/v1/*.proto).
    """

    def __init__(self, endpoints: Endpoints, timeout: float | None = None, key: Key | None = None) -> None:
        self.endpoints = endpoints
        self._context: "zmq.Context[zmq.Socket[bytes]]" = zmq.Context()
        if key:
            key.use(self._context)
        self._control = ControlClient(self._context, endpoints.control, timeout)

    def close(self) -> None:
        """Ends all streams too."""
        self._control.close()
        self._context.destroy(linger=0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    # Live data

    def stream(self, *topics: str, timeout: float = 5.0) -> Stream:
        """The blocks of one or more streams ("floor/cop") from now on; `Timeout` when none comes for `timeout` seconds."""
        check_timeout(timeout)
        self._check_streams(topics)
        return Stream(self._subscribe(topics), f"block of {' or '.join(topics)}", timeout)

    def events(self, *prefixes: str, timeout: float = 60.0) -> EventStream:
        """Events from now on: of everything, or of what the prefixes cover: "floor/", "chair/reach"."""
        check_timeout(timeout)
        known = [f"{rig}/{name}" for rig in self.rigs for name in sorted(EVENT_TOPICS)]
        topics = [topic for topic in known if topic.startswith(prefixes or "")]
        if not topics:
            raise NotFound(f"no events begin with {' or '.join(prefixes)}", f"there are {', '.join(known)}")
        return EventStream(self._subscribe(topics), f"event of {' or '.join(prefixes) or 'any rig'}", timeout)

    def record(self, topic: str, seconds: float, timeout: float = 5.0) -> Samples:
        """The next `seconds` of a stream in one piece, with what is missing in between; `Timeout` when the stream pauses for longer."""
        collector = Collector(seconds)
        self._check_streams((topic,))
        subscriber = self._subscribe((topic, f"{topic.partition('/')[0]}/gap"))
        try:
            while not collector.is_complete:
                item = subscriber.receive(check_timeout(timeout))
                if item is None:
                    raise no_news(subscriber, f"block of {topic}", timeout)
                collector.take(item)
        finally:
            subscriber.close()
        return collector.samples()

    # State

    def status(self) -> control_pb2.StatusSnapshot:
        return self._control.call(control_pb2.Request(status=control_pb2.StatusRequest())).status

    @property
    def rigs(self) -> dict[str, control_pb2.RigInfo]:
        """By name: plate, sensors, streams, stages."""
        response = self._control.call(control_pb2.Request(list_rigs=control_pb2.ListRigsRequest()))
        return {rig.name: rig for rig in response.rigs.rigs}

    def devices(self) -> control_pb2.GetDevicesResponse:
        return self._control.call(control_pb2.Request(get_devices=control_pb2.GetDevicesRequest())).devices

    def test_device(self, rig: str) -> control_pb2.TestDeviceResponse:
        """Statistics of the rig's device channels over the last second."""
        return self._control.call(control_pb2.Request(test_device=control_pb2.TestDeviceRequest(rig=rig))).device_test

    # Sessions

    def start_session(
        self,
        rig: str,
        protocol: str = "",
        subject: str = "",
        label: str = "",
        duration_s: float = 0.0,
        settle_s: float = 0.0,
        fields: Mapping[str, object] | None = None,
    ) -> "Session":
        """Starts and records a session; `subject` is a pseudonym, `fields` what the protocol asks for (see `protocols`)."""
        wanted = control_pb2.StartSessionRequest(
            rig=rig,
            protocol=protocol,
            subject=subject,
            label=label,
            duration_s=duration_s,
            settle_s=settle_s,
            fields={name: str(value) for name, value in (fields or {}).items()},
        )
        return Session(self, self._control.call(control_pb2.Request(start_session=wanted)).session)

    def resume_session(self, session_id: str) -> "Session":
        """Goes on with an interrupted session as a new part of its recording."""
        wanted = sessions_pb2.ResumeSessionRequest(session_id=session_id)
        return Session(self, self._control.call(control_pb2.Request(resume_session=wanted)).session)

    def stop_session(self, rig: str = "", is_abort: bool = False, reason: str = "") -> control_pb2.SessionInfo:
        """Answered when the recording is closed. Without `rig`: the only one with a session."""
        wanted = control_pb2.StopSessionRequest(rig=rig, is_abort=is_abort, reason=reason)
        return self._control.call(control_pb2.Request(stop_session=wanted)).session

    def mark(self, text: str, rig: str = "") -> list[control_pb2.MarkResponse.At]:
        """Marks the newest scan of a rig, or of every rig."""
        return list(self._control.call(control_pb2.Request(mark=control_pb2.MarkRequest(text=text, rig=rig))).mark.marks)

    def trial(self, action: TrialAction, rig: str = "") -> sessions_pb2.TrialStatus:
        """One step of the protocol's trials. Without `rig`: of the only one with a session."""
        actions = {
            "next": sessions_pb2.TRIAL_ACTION_NEXT,
            "redo": sessions_pb2.TRIAL_ACTION_REDO,
            "reject": sessions_pb2.TRIAL_ACTION_REJECT,
        }
        return self._control.call(control_pb2.Request(trial=sessions_pb2.TrialRequest(rig=rig, action=actions[action]))).trial

    def tare(self, rig: str) -> NDArray[np.float64]:
        """Takes the present deflections as zero; the baseline of each sensor in mm."""
        return np.array(self._control.call(control_pb2.Request(tare=control_pb2.TareRequest(rig=rig))).tare.baseline_mm)

    def protocols(self) -> dict[str, sessions_pb2.ProtocolInfo]:
        response = self._control.call(control_pb2.Request(list_protocols=sessions_pb2.ListProtocolsRequest()))
        return {protocol.name: protocol for protocol in response.protocols.protocols}

    def sessions(self, rig: str = "", subject: str = "", protocol: str = "", limit: int = 0) -> list[sessions_pb2.SessionRecord]:
        """What the catalogue holds, newest first, without trials; at most `limit`, 0 is 100."""
        wanted = sessions_pb2.ListSessionsRequest(rig=rig, subject=subject, protocol=protocol, limit=limit)
        return list(self._control.call(control_pb2.Request(list_sessions=wanted)).sessions.sessions)

    def session(self, session_id: str) -> sessions_pb2.SessionRecord:
        """A session of the catalogue with its trials and results; its recordings are the files of `.parts`, on the daemon's host."""
        wanted = sessions_pb2.ShowSessionRequest(session_id=session_id)
        return self._control.call(control_pb2.Request(show_session=wanted)).session_record

    def audit(self, limit: int = 0) -> sessions_pb2.GetAuditResponse:
        """The newest entries of the audit trail, 0 is 100. That its chain is broken is no error here: see `problem`."""
        return self._control.call(control_pb2.Request(get_audit=sessions_pb2.GetAuditRequest(limit=limit))).audit

    def _check_streams(self, topics: tuple[str, ...]) -> None:
        known = [f"{rig.name}/{name}" for rig in self.rigs.values() for name in rig.published]
        for topic in topics or ("",):
            if topic not in known:
                hint = "a stream that the rig file does not publish is in recordings only ([publish] streams)"
                raise NotFound(f"no stream '{topic}'; there are {', '.join(known)}", hint)

    def _subscribe(self, topics: tuple[str, ...] | list[str]) -> Subscriber:
        subscriber = Subscriber(self._context, self.endpoints.data, topics, frozenset(topics).__contains__)
        try:
            subscriber.wait_until_subscribed(_SUBSCRIBED_S)
        except BaseException:
            subscriber.close()
            raise
        return subscriber


class Session:
    """A session under way. In a `with` it is stopped at the end, and aborted when an exception ends it."""

    def __init__(self, daemon: Daemon, info: control_pb2.SessionInfo) -> None:
        self._daemon = daemon
        self.id = info.session_id
        self.rig = info.rig

    def info(self) -> control_pb2.SessionInfo:
        """Its present state; raises WrongState when it is over."""
        for rig in self._daemon.status().rigs:
            session: control_pb2.SessionInfo = rig.session
            if session.session_id == self.id and session.state not in _OVER:
                return session
        raise WrongState(f"session {self.id} is over", f"its result: daemon.session('{self.id}')")

    @property
    def is_running(self) -> bool:
        try:
            self.info()
        except WrongState:
            return False
        return True

    def wait(self, timeout: float) -> sessions_pb2.SessionRecord:
        """Until a session with a duration is over by itself and its recording is closed; `Timeout` after `timeout` seconds."""
        deadline_s = time.monotonic() + check_timeout(timeout)
        while True:
            if not self.is_running:
                record = self._daemon.session(self.id)
                if record.state != "running":  # as it stays until the file is closed
                    return record
            if time.monotonic() > deadline_s:
                raise Timeout(f"session {self.id} is not over after {timeout:g} s", "session.stop() ends it")
            time.sleep(0.1)

    def mark(self, text: str) -> control_pb2.MarkResponse.At:
        return self._daemon.mark(text, self.rig)[0]

    def trial(self, action: TrialAction) -> sessions_pb2.TrialStatus:
        return self._daemon.trial(action, self.rig)

    def stop(self) -> sessions_pb2.SessionRecord:
        """Ends it; returns when the recording is closed, with what came out of it."""
        self._daemon.stop_session(self.rig)
        return self._daemon.session(self.id)

    def abort(self, reason: str) -> sessions_pb2.SessionRecord:
        """It did not go as it should: listed as aborted. Its recording stays."""
        self._daemon.stop_session(self.rig, is_abort=True, reason=reason)
        return self._daemon.session(self.id)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if not self.is_running:
            return
        try:
            if kind is None:
                self.stop()
            else:
                self.abort(f"{kind.__name__} in a Python program")
        except WrongState:  # it ended by itself in this moment
            if self.is_running:
                raise

    def __repr__(self) -> str:
        return f"<dts.Session {self.id}>"
