# SPDX-License-Identifier: Apache-2.0
"""A viewer of a remote rig: does what a browser does at the dashboard of the centre."""
import base64
import contextlib
import os
import socket
import struct
import threading
import time
from dataclasses import dataclass

from child import PATIENCE_S, Failure
from protobuf import decoded, message, text_of

BINARY, CLOSE, PING, PONG = 2, 8, 9, 10  # RFC 6455, 5.2


@dataclass(frozen=True)
class Block:
    """A block of scans of one stream, as dtsd has published it."""

    topic: str
    sampled_s: float   # time.monotonic() of the clinic's machine, of the first scan
    received_s: float  # time.monotonic()
    segment: int
    first_scan: int
    scans: list[tuple[float, ...]]


class Viewer:
    """Watches topics of a clinic until it is closed. A thread of its own reads."""

    def __init__(self, address: str, clinic: str, *topics: str) -> None:
        self.blocks: list[Block] = []
        self._topics = set(topics)
        self._closing = False
        host, _, port = address.removeprefix("http://").partition(":")
        self._socket = socket.create_connection((host, int(port)), timeout=PATIENCE_S)
        key = base64.b64encode(os.urandom(16)).decode()
        self._socket.sendall((f"GET /ws?clinic={clinic} HTTP/1.1\r\nHost: {host}:{port}\r\nOrigin: {address}\r\nUpgrade: websocket\r\n"
                              f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                              "Sec-WebSocket-Protocol: dts.v1\r\n\r\n").encode())
        self._received = b""
        head = self._until(b"\r\n\r\n")
        if b" 101 " not in head.splitlines()[0]:
            raise Failure(f"dts-fleet-gateway does not open a live view: {head.splitlines()[0].decode()}")
        self._send(BINARY, message({1: b"".join(message({1: topic}) for topic in topics)}))
        threading.Thread(target=self._read, daemon=True).start()

    def close(self) -> None:
        self._closing = True
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()

    def newest(self, topic: str) -> Block | None:
        return next((block for block in reversed(self.blocks) if block.topic == topic), None)

    def _read(self) -> None:
        with contextlib.suppress(OSError, Failure):
            while not self._closing:
                kind, data = self._frame()
                if kind == PING:
                    self._send(PONG, data)
                if kind == CLOSE:
                    return
                if kind == BINARY:
                    self._handle(data)

    def _handle(self, data: bytes) -> None:
        for frame in decoded(data).get(2, []):  # FromGateway.frame
            fields = decoded(frame)
            self._send(BINARY, message({2: message({1: fields[1][0]})}))  # painted
            for carried in map(decoded, fields.get(2, [])):
                topic = text_of(carried, 1)
                if topic in self._topics:
                    self._add(topic, decoded(carried[2][0]))

    def _add(self, topic: str, block: dict[int, list]) -> None:
        count, channels = block.get(4, [0])[0], block.get(5, [0])[0]
        packed = block.get(11, [b""])[0]
        if not count or len(packed) != 4 * count * channels:
            return
        values = struct.unpack(f"<{count * channels}f", packed)
        scans = [tuple(values[channel * count + scan] for channel in range(channels)) for scan in range(count)]
        sampled_s = int.from_bytes(block[7][0], "little", signed=True) * 1e-9
        self.blocks.append(Block(topic, sampled_s, time.monotonic(), block.get(2, [0])[0], block.get(3, [0])[0], scans))

    # WebSocket

    def _send(self, kind: int, data: bytes) -> None:
        mask = os.urandom(4)
        size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + len(data).to_bytes(2, "big")
        self._socket.sendall(bytes([0x80 | kind]) + size + mask + bytes(byte ^ mask[at % 4] for at, byte in enumerate(data)))

    def _frame(self) -> tuple[int, bytes]:
        """Returns one message; the gateway sends each in one frame."""
        first, size = self._exactly(2)
        if size == 126:
            size = int.from_bytes(self._exactly(2), "big")
        elif size == 127:
            size = int.from_bytes(self._exactly(8), "big")
        return first & 15, self._exactly(size)

    def _exactly(self, count: int) -> bytes:
        while len(self._received) < count:
            self._receive()
        data, self._received = self._received[:count], self._received[count:]
        return data

    def _until(self, end: bytes) -> bytes:
        while end not in self._received:
            self._receive()
        data, _, self._received = self._received.partition(end)
        return data

    def _receive(self) -> None:
        data = self._socket.recv(1 << 16)
        if not data:
            raise Failure("dts-fleet-gateway has closed the connection")
        self._received += data
