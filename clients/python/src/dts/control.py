# SPDX-License-Identifier: Apache-2.0
"""The control socket: sends commands and waits for the answers."""
import secrets
import threading
import time

import zmq
from google.protobuf.message import DecodeError

from .endpoints import probe
from .errors import DataDamaged, InvalidArgument, Unreachable, error_of
from .options import COMMANDS
from .v1 import control_pb2
from .wire_check import MAX_ANSWER_BYTES, check_answer

_LONGEST_REQUEST_BYTES = 4096  # as the daemon's control socket
_LONGEST_TEXT = 2000
_TIMEOUT_S = 3.0


def check_open(context: "zmq.Context[zmq.Socket[bytes]]") -> None:
    """Raises `InvalidArgument` if `Daemon.close` has closed the context."""
    if context.closed:
        raise InvalidArgument("this daemon is closed", "connect again: dts.connect()")


class ControlClient:
    """Sends commands to a daemon and waits for the answers.

    If no answer arrives in time, the client sends the request again over a new socket with the same request ID. The daemon executes the
    request only once (the "Lazy Pirate" of the ZeroMQ guide, chapter 4). Thread: any; one command at a time.
    """

    def __init__(self, context: "zmq.Context[zmq.Socket[bytes]]", endpoint: str, timeout_s: float | None = None, tries: int = 3) -> None:
        if not endpoint:
            raise InvalidArgument("the control address of the daemon is not known", "give it with dts.connect(control=...) or DTSD_CONTROL")
        if timeout_s is not None and not 0.03 <= timeout_s <= 86400.0:
            raise InvalidArgument("the timeout must be from 0.03 s to 86400 s")
        self._context = context
        self._endpoint = endpoint
        self._timeout_s = timeout_s
        self._tries = tries
        self._lock = threading.RLock()
        self._is_calling = False
        self._socket: "zmq.Socket[bytes] | None" = None
        self._ignored = 0

    def call(self, request: control_pb2.Request) -> control_pb2.Response:
        """Sends a command and returns its checked answer. Fills in the request ID.

        Raises Unreachable if no answer arrives in time, DataDamaged if the answer contradicts itself or does not match the command, and
        otherwise the error that the daemon sent.
        """
        command = request.WhichOneof("command") or ""
        with self._lock:
            if self._is_calling:
                return self._call_aside(request)
            self._is_calling = True
            try:
                response = self._exchange(request, self._timeout_of(command))
            finally:
                self._is_calling = False
        if response.HasField("error"):
            error = response.error
            what = error.what[:_LONGEST_TEXT] or "the daemon rejected the command and gave no reason"
            raise error_of(error.code, what, error.hint[:_LONGEST_TEXT])
        if response.WhichOneof("result") != COMMANDS[command].answer:
            raise DataDamaged(
                "the answer of the daemon does not match the command", "check that dtsd and this package have the same version"
            )
        check_answer(response)
        return response

    def _call_aside(self, request: control_pb2.Request) -> control_pb2.Response:
        """A signal handler sends a command while its thread waits for an answer: over a socket of its own, so that both get theirs."""
        aside = ControlClient(self._context, self._endpoint, self._timeout_s, self._tries)
        try:
            return aside.call(request)
        finally:
            aside.close()

    def close(self) -> None:
        """Closes the socket. A later `call` opens a new one."""
        with self._lock:
            self._close_socket()

    def _timeout_of(self, command: str) -> float:
        """Returns the timeout of the caller in seconds; otherwise 3 s, or the longer limit that the protocol sets for the command."""
        return max(_TIMEOUT_S, COMMANDS[command].timeout_s) if self._timeout_s is None else self._timeout_s

    def _exchange(self, request: control_pb2.Request, timeout_s: float) -> control_pb2.Response:
        check_open(self._context)
        probe(self._endpoint)
        request.request_id = secrets.token_hex(16)
        self._ignored = 0
        message = request.SerializeToString()
        if len(message) > _LONGEST_REQUEST_BYTES:  # the daemon ends the connection for a longer one
            raise InvalidArgument(f"the command has {len(message)} bytes, and the daemon accepts {_LONGEST_REQUEST_BYTES}", "shorten its texts")
        for attempt in range(self._tries):
            if attempt > 0 or self._socket is None:
                self._reopen()
            assert self._socket is not None
            # In the envelope of a REQ socket (an empty frame first): every ROUTER that serves REQ understands it.
            self._socket.send_multipart([b"", message], zmq.NOBLOCK)
            response = self._wait_for(self._socket, request.request_id, time.monotonic() + timeout_s / self._tries)
            if response is not None:
                return response
        self._close_socket()
        raise self._unreachable(timeout_s)

    def _wait_for(self, socket: "zmq.Socket[bytes]", request_id: str, deadline_s: float) -> control_pb2.Response | None:
        while (left_s := deadline_s - time.monotonic()) > 0:
            if socket.poll(int(left_s * 1000) + 1) == 0:
                continue
            response = _response_of(socket.recv_multipart())
            # A daemon that cannot read a request rejects it without its id.
            if response is not None and (
                response.request_id == request_id or (not response.request_id and response.HasField("error"))
            ):
                return response
            self._ignored += 1
        return None

    def _reopen(self) -> None:
        self._close_socket()
        socket = self._context.socket(zmq.DEALER)
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.MAXMSGSIZE, 4 * MAX_ANSWER_BYTES)
        try:
            socket.connect(self._endpoint)
        except zmq.ZMQError as error:
            socket.close()
            raise InvalidArgument(f"cannot use the control address '{self._endpoint}': {error.strerror}") from None
        self._socket = socket

    def _close_socket(self) -> None:
        if self._socket is not None:
            self._socket.close(linger=0)
            self._socket = None

    def _unreachable(self, timeout_s: float) -> Unreachable:
        where = f"{self._endpoint} within {timeout_s:.1f} s ({self._tries} tries)"
        if self._ignored > 0:
            return Unreachable(
                f"no valid answer from {where}; {self._ignored} other messages arrived",
                "check that dtsd listens at this address and has the same version",
            )
        return Unreachable(f"no answer from {where}", "check that dtsd runs: systemctl status dtsd; check the address")


def _response_of(frames: list[bytes]) -> control_pb2.Response | None:
    has_envelope = len(frames) == 1 or (len(frames) == 2 and not frames[0])
    if not has_envelope or len(frames[-1]) > MAX_ANSWER_BYTES:
        return None
    response = control_pb2.Response()
    try:
        response.ParseFromString(frames[-1])
    except DecodeError:
        return None
    return response
