# SPDX-License-Identifier: Apache-2.0
"""The data socket: connects in the background, and again after an interruption."""
import time
from collections.abc import Callable, Sequence

import zmq

from .errors import InvalidArgument, Unreachable
from .events import Event
from .inbox import STATUS_TOPIC, Inbox, Statistics
from .streams import Block
from .wire_check import MAX_MESSAGE_BYTES

__all__ = ["Statistics", "Subscriber", "check_timeout"]

_RECONNECT_AFTER_S = 5.0
_LOOKS_PER_SILENCE = 8
_MESSAGES_PER_CALL = 256  # handled even if the deadline has passed, so that polling with timeout 0 gets somewhere
_LONGEST_WAIT_S = 86400.0
_LONGEST_PREFIX_BYTES = 200  # the daemon hangs up on subscriptions beyond 512


def check_timeout(timeout: float) -> float:
    if not 0.0 <= timeout <= _LONGEST_WAIT_S:
        raise InvalidArgument(f"a timeout of {timeout} s: it must be between 0 and 86400")
    return timeout


class Subscriber:
    """Receives the blocks and events of some topics. One thread at a time."""

    def __init__(
        self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, topics: Sequence[str], is_wanted: Callable[[str], bool]
    ) -> None:
        self._socket: "zmq.Socket[bytes] | None" = None
        if not endpoint:
            raise InvalidArgument("the daemon's data address is not known", "give it: dts.connect(data=...) or DTSD_DATA")
        if any(len(topic.encode()) > _LONGEST_PREFIX_BYTES for topic in topics):
            raise InvalidArgument(f"a topic has at most {_LONGEST_PREFIX_BYTES} bytes")
        self._context = context
        self._endpoint = endpoint
        self._topics = topics
        self._inbox = Inbox(is_wanted)
        self._connect()

    @property
    def statistics(self) -> Statistics:
        return self._inbox.statistics

    def silence_s(self) -> float:
        """How long nothing at all has been heard of the daemon."""
        return time.monotonic() - self._heard_s

    def wait_until_subscribed(self, timeout_s: float) -> None:
        """Returns when the daemon knows what is wanted: nothing that is published from now on is missed.

        The daemon answers every subscription with its status and takes them in order; that to the status is the last.
        """
        deadline_s = time.monotonic() + timeout_s
        while not self._inbox.has_status:
            if not self._take_one() and not self._wait(deadline_s):
                raise Unreachable(
                    f"nothing is heard from {self._endpoint} for {timeout_s:g} s",
                    "does the daemon run, and is this its data address? give dts.connect(data=...) or set DTSD_DATA",
                )

    def receive(self, timeout_s: float) -> Block | Event | None:
        """The next block or event; None when `timeout_s` passes first."""
        deadline_s = time.monotonic() + timeout_s
        taken = 0
        while True:
            if (received := self._inbox.next()) is not None:
                return received
            if self._take_one():
                taken += 1
                if taken > _MESSAGES_PER_CALL and time.monotonic() >= deadline_s:
                    return None
            elif not self._wait(deadline_s):
                return None

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close(linger=0)
            self._socket = None

    def __del__(self) -> None:
        self.close()  # who leaves a loop over a stream need not think of it

    def _connect(self) -> None:
        self.close()
        socket = self._context.socket(zmq.SUB)
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.RCVHWM, 8192)
        # A guard against a peer that announces gigabytes; what is merely too large for us is counted by the inbox.
        socket.setsockopt(zmq.MAXMSGSIZE, 4 * MAX_MESSAGE_BYTES)
        socket.setsockopt(zmq.HEARTBEAT_IVL, 1000)
        socket.setsockopt(zmq.HEARTBEAT_TIMEOUT, 5000)
        socket.setsockopt(zmq.RECONNECT_IVL, 100)
        socket.setsockopt(zmq.RECONNECT_IVL_MAX, 1000)
        for topic in (*self._topics, STATUS_TOPIC):
            socket.setsockopt(zmq.SUBSCRIBE, topic.encode())
        try:
            socket.connect(self._endpoint)
        except zmq.ZMQError as error:
            socket.close()
            raise InvalidArgument(f"cannot use the data address '{self._endpoint}': {error.strerror}") from None
        self._socket = socket
        self._heard_s = self._looked_s = time.monotonic()
        self._listened_s = 0.0

    def _open_socket(self) -> "zmq.Socket[bytes]":
        if self._socket is None:
            raise InvalidArgument("this stream was closed")
        return self._socket

    def _take_one(self) -> bool:
        """False when the socket has nothing at the moment."""
        try:
            frames = self._open_socket().recv_multipart(zmq.NOBLOCK)
        except zmq.Again:
            return False
        self._heard_s = self._looked_s = time.monotonic()
        self._listened_s = 0.0
        self._inbox.accept(frames)
        return True

    def _wait(self, deadline_s: float) -> bool:
        """True when it is worth looking into the socket, False at the deadline.

        libzmq gives a peer up for good after a violation of its protocol, a message beyond its limit for one. A status comes every
        second, so silence means that nobody is connected. Only silence that was listened to counts: who did not iterate for a while
        must first read what has piled up.
        """
        slice_s = _RECONNECT_AFTER_S / _LOOKS_PER_SILENCE
        left_s = max(deadline_s - time.monotonic(), 0.0)
        if self._open_socket().poll(int(min(left_s, slice_s) * 1000 + 0.999)) != 0:
            return True
        now_s = time.monotonic()
        self._listened_s += min(now_s - self._looked_s, slice_s)
        self._looked_s = now_s
        if self._listened_s >= _RECONNECT_AFTER_S:
            heard_s = self._heard_s
            self._connect()
            self._heard_s = heard_s
        return now_s < deadline_s
