# SPDX-License-Identifier: Apache-2.0
"""The line between a clinic and the centre: TCP, with a rate and two switches: it can be cut, and it can be silent."""
import socket
import struct
import threading
import time

LARGEST_CREDIT_S = 0.1
RESET = struct.pack("ii", 1, 0)  # SO_LINGER: closing resets the connection, as a dead line looks to the other side


class Line:
    """Carries connections from a port of its own to another one. Thread: each function from any."""

    def __init__(self, target_port: int, bytes_per_s: float | None = None) -> None:
        self.bytes_per_s = bytes_per_s  # towards the centre; None: no limit
        self.sent_bytes = 0  # towards the centre
        self._target_port = target_port
        self._is_cut = False
        self._is_over = False
        self._lock = threading.Lock()
        self._sockets: set[socket.socket] = set()
        self._speaks = {True: threading.Event(), False: threading.Event()}  # True: towards the centre
        for direction in self._speaks.values():
            direction.set()
        self._due_s = time.monotonic()  # when the next bytes may leave
        self._listener = socket.create_server(("127.0.0.1", 0), backlog=64)
        self.port = int(self._listener.getsockname()[1])
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        """Resets all connections. New ones are reset at once until `restore`."""
        with self._lock:
            self._is_cut = True
        self._reset_all()

    def restore(self) -> None:
        with self._lock:
            self._is_cut = False

    def silence(self, up: bool, down: bool) -> None:
        """Carries nothing in these directions until `speak`, and ends nothing, like a pulled cable or a firewall that drops. New connections
        are accepted, and are as silent."""
        for is_up, is_silent in ((True, up), (False, down)):
            if is_silent:
                self._speaks[is_up].clear()

    def speak(self) -> None:
        """What was held back arrives, as TCP sends it again."""
        for direction in self._speaks.values():
            direction.set()

    def close(self) -> None:
        self._is_over = True
        self.speak()
        self.cut()
        self._listener.close()

    def _reset_all(self) -> None:
        with self._lock:
            sockets, self._sockets = self._sockets, set()
        for one in sockets:
            _reset(one)

    def _accept(self) -> None:
        while not self._is_over:
            try:
                near, _ = self._listener.accept()
            except OSError:
                return
            with self._lock:
                is_cut = self._is_cut
            if is_cut:
                _reset(near)
                continue
            try:
                far = socket.create_connection(("127.0.0.1", self._target_port), timeout=5)
                far.settimeout(None)
            except OSError:
                _reset(near)
                continue
            # Small buffers: what is in them has not crossed the line yet.
            near.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 65536)
            with self._lock:
                self._sockets |= {near, far}
            threading.Thread(target=self._carry, args=(near, far, True), daemon=True).start()
            threading.Thread(target=self._carry, args=(far, near, False), daemon=True).start()

    def _carry(self, source: socket.socket, sink: socket.socket, is_up: bool) -> None:
        try:
            while data := source.recv(4096 if is_up and self.bytes_per_s else 65536):
                if is_up:
                    self._wait_for_turn(len(data))
                self._speaks[is_up].wait()
                sink.sendall(data)
        except OSError:
            pass
        with self._lock:
            self._sockets -= {source, sink}
        _reset(source)
        _reset(sink)

    def _wait_for_turn(self, size: int) -> None:
        with self._lock:
            self.sent_bytes += size
            rate = self.bytes_per_s
            now_s = time.monotonic()
            if not rate:
                self._due_s = now_s
                return
            wait_s = self._due_s - now_s
            # A thread that was woken late catches up: otherwise the line would be slower than it says.
            self._due_s = max(self._due_s, now_s - LARGEST_CREDIT_S) + size / rate
        if wait_s > 0:
            time.sleep(wait_s)


def _reset(one: socket.socket) -> None:
    try:
        one.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET)
        one.shutdown(socket.SHUT_RDWR)
    except OSError:
        pass
    one.close()
