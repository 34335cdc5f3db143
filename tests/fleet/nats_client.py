# SPDX-License-Identifier: Apache-2.0
"""A small client of nats-server for tests that attack it: it sends what it is asked to send, and keeps all that comes back."""
import base64
import binascii
import ctypes
import json
import queue
import select
import socket
import ssl
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from child import PATIENCE_S, Failure

SEED_PREFIX, USER_PREFIX = 18 << 3, 20 << 3  # "S" and "U" of the encoding of NATS


def sodium() -> ctypes.CDLL:
    return ctypes.CDLL("libsodium.so.23")


def with_checksum(payload: bytes) -> str:
    """Returns the base32 text of a key, as NATS writes it."""
    return base64.b32encode(payload + binascii.crc_hqx(payload, 0).to_bytes(2, "little")).decode().rstrip("=")


class NKey:
    def __init__(self, seed: str) -> None:
        """Reads the text of a user's seed: "SU..."."""
        raw = base64.b32decode(seed.strip() + "=" * (-len(seed.strip()) % 8))
        self._secret = ctypes.create_string_buffer(64)
        public = ctypes.create_string_buffer(32)
        sodium().crypto_sign_seed_keypair(public, self._secret, raw[2:34])
        self.public = with_checksum(bytes([USER_PREFIX]) + public.raw)

    @staticmethod
    def of_file(path: Path) -> "NKey":
        return NKey(next(line for line in path.read_text().splitlines() if line.startswith("SU")))

    def signature(self, text: bytes) -> str:
        signed = ctypes.create_string_buffer(64)
        sodium().crypto_sign_detached(signed, None, text, ctypes.c_ulonglong(len(text)), self._secret)
        return base64.urlsafe_b64encode(signed.raw).decode().rstrip("=")


@dataclass
class Letter:
    subject: str
    reply: str
    data: bytes


def connect(port: int, ca: Path, key: NKey) -> ssl.SSLSocket:
    """Connects over TLS and sends the login. Whether the server lets the key in is seen later."""
    plain = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
    line = b""
    while not line.endswith(b"\r\n"):  # byte by byte: TLS begins right after this line
        byte = plain.recv(1)
        if not byte:
            raise Failure("nats-server closed the connection")
        line += byte
    information = json.loads(line.removeprefix(b"INFO "))
    tls = ssl.create_default_context(cafile=str(ca)).wrap_socket(plain, server_hostname="127.0.0.1")
    options = {"verbose": False, "pedantic": True, "tls_required": True, "nkey": key.public, "lang": "test", "version": "1", "protocol": 1,
               "headers": True, "no_responders": True, "sig": key.signature(information["nonce"].encode())}
    tls.sendall(b"CONNECT " + json.dumps(options).encode() + b"\r\n")
    return tls


class NatsClient:
    """Thread: the functions from one; a thread of its own reads."""

    def __init__(self, port: int, ca: Path, key: NKey) -> None:
        """Raises Failure if the server does not let the key in."""
        self.letters: queue.Queue[Letter] = queue.Queue()
        self.errors: queue.Queue[str] = queue.Queue()
        self._pongs: queue.Queue[None] = queue.Queue()
        self._subscriptions = 0
        self.ended = threading.Event()
        self.tls = connect(port, ca, key)
        self.tls.setblocking(False)
        self._lock = threading.Lock()  # OpenSSL does not allow two threads in one connection
        self._sending = threading.Lock()  # and after a write that must be repeated, no other write
        threading.Thread(target=self._read, daemon=True).start()
        self.wait_for_server()

    def close(self) -> None:
        try:
            self.tls.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self.ended.wait(PATIENCE_S)  # the thread that reads must not see the next file with this number
        self.tls.close()

    def publish(self, subject: str, data: bytes = b"", reply: str = "") -> None:
        self._send(f"PUB {subject}{' ' + reply if reply else ''} {len(data)}\r\n".encode() + data + b"\r\n")

    def subscribe(self, subject: str) -> None:
        self._subscriptions += 1
        self._send(f"SUB {subject} {self._subscriptions}\r\n".encode())

    def wait_for_server(self) -> None:
        """Returns when the server has read everything, and all that it has sent before is in the queues."""
        self._send(b"PING\r\n")
        while not self.ended.is_set():
            try:
                return self._pongs.get(timeout=0.1)
            except queue.Empty:
                continue
        raise Failure(f"nats-server ended the connection: {', '.join(self.taken_errors()) or 'no reason given'}")

    def taken_errors(self) -> list[str]:
        errors = []
        while not self.errors.empty():
            errors.append(self.errors.get())
        return errors

    def next_letter(self, patience_s: float = PATIENCE_S) -> Letter:
        try:
            return self.letters.get(timeout=patience_s)
        except queue.Empty:
            raise Failure(f"no letter within {patience_s:.0f} s") from None

    def _send(self, data: bytes) -> None:
        with self._sending:
            while data and not self.ended.is_set():
                try:
                    with self._lock:
                        data = data[self.tls.send(data):]
                except (ssl.SSLWantReadError, ssl.SSLWantWriteError):
                    time.sleep(0.001)
                except OSError:
                    self.ended.set()

    def _receive(self) -> bytes:
        """Returns the next bytes; none at the end of the connection."""
        while True:
            try:
                with self._lock:
                    return self.tls.recv(65536)
            except (ssl.SSLWantReadError, ssl.SSLWantWriteError):
                select.select([self.tls], [], [], 0.1)

    def _read(self) -> None:
        try:
            left = b""
            while data := self._receive():
                left = self._handle(left + data)
        except (OSError, ValueError):
            pass
        self.ended.set()

    def _handle(self, data: bytes) -> bytes:
        """Handles all whole messages. Returns what is left."""
        while (end := data.find(b"\r\n")) >= 0:
            words = data[:end].split()
            begin = end + 2
            if words[0] in (b"MSG", b"HMSG"):
                size = int(words[-1])
                if len(data) < begin + size + 2:
                    break
                has_reply = len(words) > (4 if words[0] == b"MSG" else 5)
                self.letters.put(Letter(words[1].decode(), words[3].decode() if has_reply else "", data[begin:begin + size]))
                begin += size + 2
            elif words[0] == b"PING":
                self._send(b"PONG\r\n")
            elif words[0] == b"PONG":
                self._pongs.put(None)
            elif words[0] == b"-ERR":
                self.errors.put(data[:end].decode().removeprefix("-ERR").strip().strip("'"))
            data = data[begin:]
        return data
