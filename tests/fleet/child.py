# SPDX-License-Identifier: Apache-2.0
"""Programs as child processes of the harness. They end with it, also if it is killed."""
import os
import pwd
import random
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PROGRAMS = Path(os.environ.get("DTS_BIN_DIR", REPOSITORY / "build/release/bin"))
PATIENCE_S = 60.0  # for what takes a moment; a busy machine must not fail a test


class Failure(Exception):
    """Something did not happen, or a program failed. The text says which, and what the program printed."""


def program(name: str) -> str:
    return str(PROGRAMS / name)


def postgresql(name: str) -> str | None:
    """Returns the path of a program of the newest PostgreSQL of this machine, None if there is none."""
    found = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{name}"), key=lambda path: int(path.parts[4].partition(".")[0]))
    return str(found[-1]) if found else shutil.which(name)


def nats_server() -> str | None:
    return shutil.which("nats-server") or shutil.which("nats-server", path="/usr/sbin:/sbin")


def what_is_missing(*more: str) -> str | None:
    """Returns why no centre, or no such program of ours, can be started on this machine; None if they can."""
    if nats_server() is None:
        return "nats-server is not installed: apt-get install nats-server"
    if postgresql("initdb") is None:
        return "PostgreSQL is not installed: apt-get install postgresql"
    if shutil.which("openssl") is None:
        return "openssl is not installed: apt-get install openssl"
    for name in ("dtsd", "dtsctl", "dts-forward", "dts-hub", "dts-fleet", *more):
        if not (PROGRAMS / name).exists():
            return f"{PROGRAMS / name} is not built"
    return None


def free_port() -> int:
    """A port that was free a moment ago, and that no outgoing connection gets: those have ports from 32768 on."""
    while True:
        port = random.randrange(15000, 32000)
        with socket.socket() as chosen:
            try:
                chosen.bind(("127.0.0.1", port))
            except OSError:
                continue
            return port


def wait_until(what: str, condition: Callable[[], object], patience_s: float = PATIENCE_S) -> None:
    deadline_s = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > deadline_s:
            raise Failure(f"after {patience_s:.0f} s still not true: {what}")
        time.sleep(0.02)


def run(*words: str | Path, env: dict[str, str] | None = None, text: str | None = None) -> str:
    """Runs a program to its end. Returns what it printed; raises Failure with its errors if it fails."""
    done = subprocess.run([str(word) for word in words], env=env, input=text, capture_output=True, text=True, timeout=2 * PATIENCE_S)
    if done.returncode != 0:
        raise Failure(f"{' '.join(map(str, words))}: ended with {done.returncode}: {done.stderr.strip() or done.stdout.strip()}")
    return done.stdout


def as_user(name: str | None) -> list[str]:
    """Returns the words before a command that run it as this user; none for None."""
    if name is None:
        return []
    user = pwd.getpwnam(name)
    return ["setpriv", "--reuid", str(user.pw_uid), "--regid", str(user.pw_gid), "--clear-groups"]


class Child:
    """A program that runs until it is stopped. Start it from the main thread: it ends with the thread that started it."""

    def __init__(self, name: str, words: list[str | Path], log: Path, env: dict[str, str] | None = None, user: str | None = None,
                 stop_signal: int = signal.SIGTERM) -> None:
        self.name = name
        self.log = log
        self.stop_signal = stop_signal
        self._words = [str(word) for word in words]
        self._env = env
        self._user = user
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        # The last word in the chain sets the signal, since a change of the user clears it.
        death = ["setpriv", "--pdeathsig", signal.Signals(self.stop_signal).name.removeprefix("SIG")]
        with self.log.open("ab") as log:
            self._process = subprocess.Popen(as_user(self._user) + death + self._words, env=self._env, stdin=subprocess.DEVNULL, stdout=log,
                                             stderr=log, start_new_session=True)  # Ctrl-C in a terminal is for the harness only

    def add_environment(self, variables: dict[str, str]) -> None:
        """Applies from the next start."""
        self._env = (self._env or dict(os.environ)) | variables

    @property
    def pid(self) -> int:
        assert self._process is not None
        return self._process.pid

    def is_alive(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def expect_alive(self) -> bool:
        if not self.is_alive():
            raise Failure(f"{self.name} ended:\n{self.tail()}")
        return True

    def kill(self, number: int = signal.SIGKILL) -> None:
        """Sends a signal and waits for the end."""
        if self._process is not None and self._process.poll() is None:
            self._process.send_signal(number)
            self._process.wait(timeout=PATIENCE_S)

    def stop(self) -> None:
        """Ends the program in order; with force if that takes too long."""
        try:
            self.kill(self.stop_signal)
        except subprocess.TimeoutExpired:
            self.kill()

    def send(self, number: int) -> None:
        assert self._process is not None
        self._process.send_signal(number)

    def text(self) -> str:
        return self.log.read_text(errors="replace") if self.log.exists() else ""

    def tail(self, lines: int = 20) -> str:
        return "\n".join(self.text().splitlines()[-lines:])

    def resident_kib(self) -> int:
        status = Path(f"/proc/{self.pid}/status").read_text()
        return int(next(line for line in status.splitlines() if line.startswith("VmRSS")).split()[1])
