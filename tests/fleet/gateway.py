# SPDX-License-Identifier: Apache-2.0
"""A dashboard of the centre: dts-fleet-gateway with a key and a role of its own."""
import base64
import os
import re
import socket
import threading
from pathlib import Path
from urllib.parse import urlsplit

from centre import DATABASE, Centre, addresses_of
from child import PATIENCE_S, PROGRAMS, Child, Failure, program, run, wait_until
from nats_client import NatsClient, NKey

WEB_ROOT = os.environ.get("DTS_WEB_ROOT", str(PROGRAMS.parent / "share/dts-gateway/web"))


def make_key(file: Path) -> str:
    """Makes the key of a user of nats-server. Returns its public half."""
    return run(program("dts-fleet-gateway"), "key", "--nats-key", file).strip()


def is_let_in(centre: Centre, key: NKey) -> bool:
    try:
        for port in centre.nats_ports:
            NatsClient(port, centre.folder / "ca.pem", key).close()
    except (Failure, OSError):
        return False
    return True


def admit(centre: Centre, name: str, clinics: tuple[str, ...] = ()) -> Path:
    """Makes a key for a dashboard, and enters it as docs/fleet.md says. `clinics`: whose rigs it may watch; none: all. Returns its file."""
    key_file = centre.folder / f"{name}.nk"
    public_key = make_key(key_file)
    names = ", ".join(f'"{clinic}"' for clinic in clinics)
    for number, hub in enumerate(centre.hubs, start=1):
        with centre.config_of(number).open("a") as config:
            config.write(f'[[dashboard]]\nkey = "{public_key}"\n' + (f"clinics = [{names}]\n" if clinics else ""))
        hub.stop()
        hub.start()
    wait_until(f"nats-server lets the key of {name} in", lambda: is_let_in(centre, NKey.of_file(key_file)))
    return key_file


class Gateway(Child):
    """dts-fleet-gateway with a key and a role of its own, on a port of 127.0.0.1; 0: any. Start it while the centre runs."""

    def __init__(self, centre: Centre, port: int = 0, name: str = "dashboard", group: str = "dashboard", clinics: tuple[str, ...] = (),
                 web_root: str = WEB_ROOT) -> None:
        """`group`: role in PostgreSQL. `clinics`: whose rigs its key may watch; none: all."""
        self.centre = centre
        self.role = f"{name}_user"
        self.key_file: Path | None = None
        self._name = name
        self._group = group
        self._clinics = clinics
        self._config = centre.folder / f"{name}.toml"
        words = [program("dts-fleet-gateway"), "serve", "--config", self._config, "--listen", f"127.0.0.1:{port}", "--web-root", web_root]
        super().__init__(f"dts-fleet-gateway {name}", words, centre.folder / f"{name}.log")

    def start(self) -> None:
        if not self.key_file:
            self.enrol()
        super().start()

    def enrol(self) -> None:
        """The steps of docs/fleet.md: a key, a table of hub.toml, a role of PostgreSQL."""
        wait_until("dts-hub has made the roles", lambda: self.centre.query_or_none(f"SELECT '{self._group}'::regrole") is not None)
        self.key_file = admit(self.centre, self._name, self._clinics)
        self.centre.query(f"CREATE ROLE {self.role} LOGIN IN ROLE {self._group}")
        self._config.write_text(f"""\
[serve]
nats-server = [{addresses_of(self.centre.nats_ports)}]
nats-ca = "{self.centre.folder}/ca.pem"
nats-key = "{self.key_file}"
database = "host={self.centre.database_folder} dbname={DATABASE} user={self.role}"
""")

    def address(self) -> str | None:
        """Returns "http://127.0.0.1:PORT", None while it does not listen yet."""
        self.expect_alive()
        found = re.search(r"listening on (http://\S+)/", self.text())
        return found.group(1) if found else None

    def resident_bytes(self) -> int:
        found = re.search(r"^VmRSS:\s+(\d+) kB$", Path(f"/proc/{self.pid}/status").read_text(), re.MULTILINE)
        assert found
        return int(found.group(1)) * 1024


class Tab:
    """A browser tab that watches a clinic: a WebSocket that subscribes to everything and counts what it receives, without painting."""

    def __init__(self, gateway: Gateway, clinic: str) -> None:
        host = urlsplit(gateway.address() or "").netloc
        self.received = b""
        self._socket = socket.create_connection(("127.0.0.1", int(host.rpartition(":")[2])), timeout=PATIENCE_S)
        self._socket.sendall((f"GET /ws?clinic={clinic} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nConnection: Upgrade\r\n"
                              "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: dts.v1\r\n"
                              f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n\r\n").encode())
        answer = self._socket.recv(65536)
        if b" 101 " not in answer.split(b"\r\n")[0]:
            raise Failure(f"no WebSocket: {answer!r}")
        self._socket.settimeout(None)
        threading.Thread(target=self._read, daemon=True).start()
        subscribe = bytes([0x0A, 2, 0x0A, 0])  # FromBrowser.subscribe with the empty prefix
        self._socket.sendall(bytes([0x82, 0x80 | len(subscribe)]) + bytes(4) + subscribe)  # masked with zeros

    def close(self) -> None:
        self._socket.close()

    def _read(self) -> None:
        try:
            while data := self._socket.recv(65536):
                self.received += data
        except OSError:
            pass
