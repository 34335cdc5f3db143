# SPDX-License-Identifier: Apache-2.0
"""The data socket: connects in the background, and reconnects after an interruption."""
import time
from collections.abc import Callable, Sequence

import zmq

from .control import check_open
from .errors import InvalidArgument, Unreachable
from .events import Event
from .inbox import STATUS_TOPIC, Inbox, Statistics
from .streams import Block
from .wire_check import MAX_MESSAGE_BYTES

__all__ = ["Statistics", "Subscriber", "check_timeout"]

_RECONNECT_AFTER_S = 5.0
_LOOKS_PER_SILENCE = 8
_QUEUE_MESSAGES = 8192
_MESSAGES_PER_CALL = 256  # processed even after the deadline, so that polling with timeout 0 makes progress
_LONGEST_WAIT_S = 86400.0
_MOST_TOPICS = 255  # and the status; the daemon hangs up on more than 256
_LONGEST_PREFIX_BYTES = 200  # the daemon hangs up on subscriptions beyond 512
_QUIET_S = 2  # after this silence, the kernel probes a daemon on another machine every second
_GONE_MS = 5000


def check_timeout(timeout: float) -> float:
    """Returns the timeout in seconds. Raises `InvalidArgument` unless it is from 0 to 86400."""
    if not 0.0 <= timeout <= _LONGEST_WAIT_S:
        raise InvalidArgument(f"the timeout {timeout} s is not from 0 s to 86400 s")
    return timeout


class Subscriber:
    """Receives the blocks and events of topics. Thread: one at a time."""

    def __init__(
        self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, topics: Sequence[str], is_wanted: Callable[[str], bool]
    ) -> None:
        self._socket: "zmq.Socket[bytes] | None" = None
        self._monitor: "zmq.Socket[bytes] | None" = None
        if not endpoint:
            raise InvalidArgument("the data address of the daemon is not known", "give it with dts.connect(data=...) or DTSD_DATA")
        if any(len(topic.encode()) > _LONGEST_PREFIX_BYTES for topic in topics):
            raise InvalidArgument(f"a topic is longer than {_LONGEST_PREFIX_BYTES} bytes")
        if len(topics) > _MOST_TOPICS:
            raise InvalidArgument(f"more than {_MOST_TOPICS} topics", "subscribe to fewer rigs at a time, with prefixes")
        self._context = context
        self._endpoint = endpoint
        self._topics = topics
        self._inbox = Inbox(is_wanted)
        self._connect()

    @property
    def statistics(self) -> Statistics:
        """Counters since the subscription. `interruptions` is as of the last wait."""
        return self._inbox.statistics

    def silence_s(self) -> float:
        """Returns the seconds since the last message of the daemon."""
        return time.monotonic() - self._received_s

    def wait_until_subscribed(self, timeout_s: float) -> None:
        """Waits until the daemon has processed the subscriptions: nothing that it publishes later is missed.

        The daemon processes subscriptions in order and answers each one with its status; the subscription to the status is the last one.
        Raises `Unreachable` after `timeout_s` seconds.
        """
        deadline_s = time.monotonic() + timeout_s
        while not self._inbox.has_status:
            if not self._receive_one() and not self._wait(deadline_s):
                raise Unreachable(
                    f"no data from {self._endpoint} for {timeout_s:g} s",
                    "check that dtsd runs and that this is its data address; to give another one: dts.connect(data=...) or DTSD_DATA",
                )

    def receive(self, timeout_s: float) -> Block | Event | None:
        """Returns the next block or event; None if `timeout_s` seconds pass first."""
        deadline_s = time.monotonic() + timeout_s
        taken = 0
        while True:
            if (received := self._inbox.next()) is not None:
                return received
            if self._receive_one():
                taken += 1
                if taken > _MESSAGES_PER_CALL and time.monotonic() >= deadline_s:
                    return None
            elif not self._wait(deadline_s):
                return None

    def close(self) -> None:
        """Closes the socket. Later calls of `receive` raise `InvalidArgument`."""
        if self._socket is not None:
            self._note_interruptions()
            self._socket.close(linger=0)
            self._socket = None
        if self._monitor is not None:
            self._monitor.close(linger=0)
            self._monitor = None

    def __del__(self) -> None:
        self.close()  # so that leaving a loop with `break` also closes the socket

    def _connect(self) -> None:
        self.close()
        socket = self._context.socket(zmq.SUB)
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.RCVHWM, _QUEUE_MESSAGES)
        # Protects against a peer that announces gigabytes. Smaller messages above our limit reach the inbox, which counts them.
        socket.setsockopt(zmq.MAXMSGSIZE, 4 * MAX_MESSAGE_BYTES)
        # The kernel ends the connection of a daemon that vanished from the network, also while nobody reads. libzmq's heartbeats are not
        # used: they abort the process if the daemon ends while the queue is full (4.3.4 and 4.3.5: their timer asserts !_io_error).
        socket.setsockopt(zmq.TCP_KEEPALIVE, 1)
        socket.setsockopt(zmq.TCP_KEEPALIVE_IDLE, _QUIET_S)
        socket.setsockopt(zmq.TCP_KEEPALIVE_INTVL, 1)
        socket.setsockopt(zmq.TCP_KEEPALIVE_CNT, _GONE_MS // 1000)
        socket.setsockopt(zmq.TCP_MAXRT, _GONE_MS)
        socket.setsockopt(zmq.RECONNECT_IVL, 100)
        socket.setsockopt(zmq.RECONNECT_IVL_MAX, 1000)
        for topic in (*self._topics, STATUS_TOPIC):
            socket.setsockopt(zmq.SUBSCRIBE, topic.encode())
        self._monitor = socket.get_monitor_socket(zmq.EVENT_DISCONNECTED)
        try:
            socket.connect(self._endpoint)
        except zmq.ZMQError as error:
            socket.close()
            raise InvalidArgument(f"cannot use the data address '{self._endpoint}': {error.strerror}") from None
        self._socket = socket
        self._received_s = self._looked_s = time.monotonic()
        self._listened_s = 0.0

    def _note_interruptions(self) -> None:
        """Counts the connections that have ended. Each wait calls it, because libzmq stops if nobody reads its messages about them."""
        while self._monitor is not None and not self._monitor.closed and self._monitor.poll(0) != 0:
            self._monitor.recv_multipart(zmq.NOBLOCK)
            self._inbox.statistics.interruptions += 1

    def _open_socket(self) -> "zmq.Socket[bytes]":
        check_open(self._context)
        if self._socket is None:
            raise InvalidArgument("this stream is closed", "subscribe again: Daemon.stream or Daemon.events")
        return self._socket

    def _receive_one(self) -> bool:
        """Processes one message. Returns False if the socket has none at the moment."""
        try:
            frames = self._open_socket().recv_multipart(zmq.NOBLOCK)
        except zmq.Again:
            return False
        self._received_s = self._looked_s = time.monotonic()
        self._listened_s = 0.0
        self._inbox.accept(frames)
        return True

    def _wait(self, deadline_s: float) -> bool:
        """Waits for a message. Returns True if the socket may have one, False at the deadline.

        libzmq drops a peer for ever after a protocol violation, for example a message above its limit. The daemon sends a status every
        second, so silence means that the connection is lost, and this function connects again. Only time spent waiting counts as silence:
        after a pause, the caller must first read the queued messages.
        """
        self._note_interruptions()
        slice_s = _RECONNECT_AFTER_S / _LOOKS_PER_SILENCE
        left_s = max(deadline_s - time.monotonic(), 0.0)
        if self._open_socket().poll(int(min(left_s, slice_s) * 1000 + 0.999)) != 0:
            return True
        now_s = time.monotonic()
        self._listened_s += min(now_s - self._looked_s, slice_s)
        self._looked_s = now_s
        if self._listened_s >= _RECONNECT_AFTER_S:
            received_s = self._received_s
            self._connect()
            self._received_s = received_s
        return now_s < deadline_s
