# SPDX-License-Identifier: Apache-2.0
"""A centre on this machine: a certificate authority, PostgreSQL, nats-server, dts-hub and, if wanted, dts-worker, in one temporary folder, on
free ports of 127.0.0.1.

Nothing is shared with services of the machine. All programs end with the harness."""
import hashlib
import json
import os
import shutil
import signal
import tempfile
from pathlib import Path

from child import Child, Failure, as_user, free_port, nats_server, postgresql, program, run, wait_until

DATABASE = "dts_fleet"
POSTGRESQL_USER = "postgres" if os.geteuid() == 0 else None  # its programs refuse to run as root


class Centre:
    """`start` starts everything. The programs `postgresql`, `nats` and `hub` may be killed and started again.

    With several machines, each has a nats-server of one cluster and a hub; all hubs share the store. `nats` and `hub` are the first ones."""

    def __init__(self, store: str = "", machines: int = 1) -> None:
        """`store`: more of the table [store], for hubs and worker."""
        remove_left_folders()
        self.folder = Path(tempfile.mkdtemp(prefix="dts-fleet.", dir="/tmp"))  # short: the path of a socket has at most 107 bytes
        self.folder.chmod(0o711)  # PostgreSQL runs as another user
        (self.folder / "pid.new").write_text(str(os.getpid()))  # never seen empty
        (self.folder / "pid.new").rename(self.folder / "pid")
        self.nats_ports = [free_port() for _ in range(machines)]
        self.nats_port = self.nats_ports[0]
        self._route_ports = [free_port() for _ in range(machines)]
        self.database_folder = self.folder / "pg"
        self.store = self.folder / "store"
        self.config = self.folder / "hub.toml"
        self._store_settings = store
        self.postgresql = Child("PostgreSQL", [postgresql("postgres") or "", "-D", self.database_folder], self.folder / "postgresql.log",
                                user=POSTGRESQL_USER, stop_signal=signal.SIGINT)  # SIGINT: does not wait for clients
        self.nats_servers = [Child(f"nats-server {number}", [nats_server() or "", "-c", self.folder / f"nats-{number}.conf"],
                                   self.folder / f"nats-{number}.log") for number in range(1, machines + 1)]
        self.hubs = [Child(f"dts-hub {number}", [program("dts-hub"), "run", "--config", self.config_of(number)],
                           self.folder / f"hub-{number}.log") for number in range(1, machines + 1)]
        self.nats, self.hub = self.nats_servers[0], self.hubs[0]
        self.worker = Child("dts-worker", [program("dts-worker"), "run", "--config", self.folder / "worker.toml"], self.folder / "worker.log")

    def start(self) -> None:
        self._make_certificates()
        self.start_empty_postgresql()
        administrator = (postgresql("psql") or "", "-X", "-q", "-h", self.database_folder, "-U", "dts_admin", "postgres", "-c")
        run(*administrator, "CREATE ROLE dts_hub LOGIN CREATEROLE")
        run(*administrator, f"CREATE DATABASE {DATABASE} OWNER dts_hub")
        self._write_settings()
        for number, nats in enumerate(self.nats_servers, start=1):
            self.fleet("users", config=self.config_of(number))
            nats.start()
        for hub in self.hubs:
            hub.start()

    def start_worker(self) -> None:
        """Starts a worker with a role of its own. The tables exist since dts-hub answers."""
        wait_until("dts-hub has made its tables", lambda: self.query_or_none("SELECT count(*) FROM job") is not None)
        self.query("CREATE ROLE dts_worker LOGIN IN ROLE worker")
        (self.folder / "worker.toml").write_text(f"""\
dtslab = "{program("dtslab")}"
[database]
connection = "host={self.database_folder} dbname={DATABASE} user=dts_worker"
[store]
directory = "{self.store}"
{self._store_settings}""")
        self.worker.start()

    def close(self, keep: bool = False) -> None:
        for child in (self.worker, *self.hubs, *self.nats_servers, self.postgresql):
            child.stop()
        if keep:
            (self.folder / "pid").unlink()
            print(f"kept: {self.folder}")
        else:
            shutil.rmtree(self.folder, ignore_errors=True)

    def start_postgresql(self) -> None:
        """Starts it and waits until it accepts connections. The processes of a killed one end first: they still hold its memory."""
        def is_up() -> bool:
            if not self.postgresql.is_alive():
                self.postgresql.start()
            return self.query_or_none("SELECT 1", "postgres") == "1"

        self.postgresql.start()
        wait_until("PostgreSQL accepts connections", is_up)

    # What a person at the centre does

    def fleet(self, *words: str | Path, config: Path | None = None) -> str:
        return run(program("dts-fleet"), "--config", config or self.config, *words)

    def fleet_lines(self, *words: str) -> list[dict]:
        return [json.loads(line) for line in self.fleet(*words, "--json").splitlines()]

    def config_of(self, number: int) -> Path:
        """Returns the file of a machine's hub."""
        return self.config if number == 1 else self.folder / f"hub-{number}.toml"

    def enrol(self, clinic: str, title: str, public_key: str, ports: list[int], out: Path) -> None:
        """Adds a clinic. `ports` are what the clinic connects to: lines of its own."""
        config = self.folder / f"hub-{clinic}.toml"
        config.write_text(self._settings(1, ports))
        self.fleet("clinic", "add", clinic, "--title", title, "--key", public_key, "--out", out, config=config)

    # What is in the centre

    def query(self, statement: str, database: str = DATABASE) -> str:
        """Returns the rows of a statement, with "|" between columns."""
        return run(postgresql("psql") or "psql", "-X", "-A", "-t", "-v", "ON_ERROR_STOP=1", "-h", self.database_folder, "-U", "dts_admin",
                   "-d", database, "-c", statement, env=os.environ | {"PGCONNECT_TIMEOUT": "5"}).strip()

    def run_script(self, file: Path) -> None:
        run(postgresql("psql") or "psql", "-X", "-q", "-v", "ON_ERROR_STOP=1", "-h", self.database_folder, "-U", "dts_admin", "-d", DATABASE, "-f", file)

    def query_or_none(self, statement: str, database: str = DATABASE) -> str | None:
        try:
            return self.query(statement, database)
        except Failure:
            return None

    def dump(self) -> str:
        return run(postgresql("pg_dump") or "pg_dump", "-h", self.database_folder, "-U", "dts_admin", DATABASE)

    def receipts(self) -> set[tuple[str, str]] | None:
        """Returns pairs of clinic and SHA-256; None while PostgreSQL does not answer."""
        rows = self.query_or_none("SELECT clinic, encode(sha256, 'hex') FROM receipt")
        return None if rows is None else {pair(row) for row in rows.splitlines()}

    def parts(self) -> list[tuple[str, str]]:
        """Returns pairs of clinic and SHA-256, one for each row of a recording that has arrived."""
        return [pair(row) for row in self.query("SELECT clinic, encode(sha256, 'hex') FROM part WHERE store_key IS NOT NULL").splitlines()]

    def object_path(self, clinic: str, sha256: str) -> Path:
        return self.store / "objects" / clinic / sha256

    def objects(self) -> list[tuple[str, str]]:
        """Returns pairs of clinic and name of the file."""
        return [(path.parent.name, path.name) for path in (self.store / "objects").glob("*/*")]

    def staged(self) -> list[Path]:
        """Returns the files of uploads that are not complete."""
        return [path for path in self.store.glob("staging/**/*") if path.suffix in (".part", ".offer")]

    # Making it

    def _make_certificates(self) -> None:
        """A certificate authority, and with it a certificate of nats-server for 127.0.0.1."""
        ca, ca_key, key, request = (self.folder / name for name in ("ca.pem", "ca.key", "nats.key", "nats.csr"))
        extensions = self.folder / "nats.ext"
        extensions.write_text("subjectAltName=IP:127.0.0.1,DNS:localhost\nextendedKeyUsage=serverAuth\n"
                              "subjectKeyIdentifier=hash\nauthorityKeyIdentifier=keyid\n")
        curve = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-noenc")
        run("openssl", "req", "-x509", *curve, "-keyout", ca_key, "-out", ca, "-days", "30", "-subj", "/CN=Demo authority",
            "-addext", "keyUsage=critical,keyCertSign,cRLSign")
        run("openssl", "req", *curve, "-keyout", key, "-out", request, "-subj", "/CN=centre")
        run("openssl", "x509", "-req", "-in", request, "-CA", ca, "-CAkey", ca_key, "-CAcreateserial", "-days", "30", "-extfile", extensions,
            "-out", self.folder / "nats.pem")

    def start_empty_postgresql(self) -> None:
        """Makes a cluster without databases of ours and starts it. Its administrator is "dts_admin"."""
        self.database_folder.mkdir()
        if POSTGRESQL_USER:
            shutil.chown(self.database_folder, POSTGRESQL_USER)
        run(*as_user(POSTGRESQL_USER), postgresql("initdb") or "", "-D", self.database_folder, "-U", "dts_admin", "-A", "trust", "-E", "UTF8",
            "--locale", "C.UTF-8", "--no-sync", "--wal-segsize", "4")
        # fsync stays on: receipts depend on it.
        with (self.database_folder / "postgresql.conf").open("a") as settings:
            settings.write(f"listen_addresses = ''\nunix_socket_directories = '{self.database_folder}'\nshared_buffers = 16MB\n"
                           "max_connections = 30\nmin_wal_size = 8MB\nmax_wal_size = 64MB\nautovacuum_naptime = 10min\n"
                           "recovery_init_sync_method = syncfs\n")
        self.start_postgresql()

    def _write_settings(self) -> None:
        routes = ", ".join(f'"nats-route://127.0.0.1:{port}"' for port in self._route_ports)
        for number, port in enumerate(self.nats_ports, start=1):
            self.config_of(number).write_text(self._settings(number, self.nats_ports))
            cluster = f'cluster {{ name: centre, listen: "127.0.0.1:{self._route_ports[number - 1]}", routes: [{routes}] }}'
            (self.folder / f"nats-{number}.conf").write_text(f"""\
server_name: centre-{number}
listen: "127.0.0.1:{port}"
pid_file: "{self.folder}/nats-{number}.pid"
max_payload: 1048576
max_connections: 10000
tls {{ cert_file: "{self.folder}/nats.pem", key_file: "{self.folder}/nats.key", timeout: 5 }}
{cluster if len(self.nats_ports) > 1 else ""}
include "users-{number}.conf"
""")

    def _settings(self, number: int, public_ports: list[int]) -> str:
        return f"""\
name = "hub-{number}"
[nats]
servers = [{addresses_of(self.nats_ports)}]
public_servers = [{addresses_of(public_ports)}]
ca = "ca.pem"
key = "hub.nk"
users_file = "users-{number}.conf"
pid_file = "nats-{number}.pid"
[database]
connection = "host={self.database_folder} dbname={DATABASE} user=dts_hub"
[store]
directory = "{self.store}"
{self._store_settings}"""


def addresses_of(ports: list[int]) -> str:
    return ", ".join(f'"tls://127.0.0.1:{port}"' for port in ports)


def remove_left_folders() -> None:
    """Removes what a harness that was killed has left: the process that made the folder is gone."""
    for file in Path("/tmp").glob("dts-fleet.*/pid"):
        try:
            if file.stat().st_uid == os.getuid() and not Path(f"/proc/{file.read_text()}").exists():
                shutil.rmtree(file.parent, ignore_errors=True)
        except OSError:  # another harness was faster
            continue


def pair(row: str) -> tuple[str, str]:
    first, _, second = row.partition("|")
    return first, second


def sha256_of(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
