# SPDX-License-Identifier: Apache-2.0
"""What the tests share: the real daemon as a child process, and a fake one that says whatever a test wants."""
import os
import random
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest
from collections.abc import Callable, Iterator
from pathlib import Path

import zmq

import dts
from dts.v1 import control_pb2, stream_pb2

SOURCE = Path(__file__).resolve().parent.parent.parent
PROGRAMS = Path(os.environ.get("DTS_BIN_DIR", SOURCE / "build" / "release" / "bin"))
PATIENCE_S = 60.0  # two busy cores and a sanitizer


def wait_for(condition: Callable[[], bool], what: str, patience_s: float = PATIENCE_S) -> None:
    deadline_s = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > deadline_s:
            raise AssertionError(f"waited in vain: {what}")
        time.sleep(0.01)


def free_ports(count: int) -> list[int]:
    """Returns TCP ports that were free a moment ago, and that no outgoing connection gets: those have ports from 32768 on."""
    ports: list[int] = []
    while len(ports) < count:
        port = random.randrange(15000, 32000)
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        if port not in ports:
            ports.append(port)
    return ports


def clean_environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if not name.startswith("DTSD_")}


class DaemonProcess:
    """A real dtsd with its own folder. `devices` replaces the addresses of config/dtsd.toml; `chair_streams` replaces what the chair publishes,
    `further` goes in front of the configuration. `state` is where recordings go; without it, into the daemon's own folder."""

    def __init__(
        self, devices: dict[str, str] | None = None, chair_streams: tuple[str, ...] = (), further: str = "", state: Path | None = None
    ) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="dts-", dir="/tmp"))  # short: a socket path has 107 bytes
        self.control = f"ipc://{self.folder}/control.sock"
        self.environment = {**clean_environment(), "DTSD_RUNTIME_DIR": str(self.folder), "DTSD_STATE_DIR": str(state or self.folder / "state")}
        self.config = SOURCE / "config" / "dtsd.toml"
        if devices or chair_streams or further:
            shutil.copytree(SOURCE / "config", self.folder / "config")
            self.config = self.folder / "config" / "dtsd.toml"
            text = self.config.read_text()
            for old, new in (devices or {}).items():
                assert old in text, f"config/dtsd.toml has no device {old}"
                text = text.replace(old, new)
            self.config.write_text(further + text)
            if chair_streams:
                chair = self.folder / "config" / "rigs" / "chair-sim.toml"
                listed = ", ".join(f'"{name}"' for name in chair_streams)
                chair.write_text(chair.read_text().replace('streams = ["transient", "aux"]', f"streams = [{listed}]"))
        self._process: subprocess.Popen[bytes] | None = None
        try:
            self.start()
        except BaseException:  # nobody can close what was not made
            if self._process is not None:
                self._process.kill()
            shutil.rmtree(self.folder, ignore_errors=True)
            raise

    def start(self) -> None:
        with (self.folder / "dtsd.log").open("ab") as log:
            command = [PROGRAMS / "dtsd", "--config", self.config, "--foreground"]
            self._process = subprocess.Popen(command, env=self.environment, stderr=log, stdout=log)
        wait_for(self._samples, "dtsd answers and samples")

    def start_relay(self) -> subprocess.Popen[bytes]:
        """Starts dts-relay beside the daemon; the caller ends it."""
        with (self.folder / "relay.log").open("ab") as log:
            relay = subprocess.Popen([PROGRAMS / "dts-relay", "--config", self.config], env=self.environment, stderr=log, stdout=log)
        try:
            wait_for(lambda: "clients with keys connect" in (self.folder / "relay.log").read_text(), "dts-relay listens")
        except BaseException:
            relay.kill()
            raise
        return relay

    def send(self, a_signal: int) -> None:
        assert self._process is not None
        self._process.send_signal(a_signal)

    def stop(self, with_signal: int = signal.SIGTERM) -> None:
        self.send(with_signal)
        assert self._process is not None
        self._process.wait(PATIENCE_S)

    def close(self) -> None:
        self.stop()
        shutil.rmtree(self.folder)

    @property
    def pid(self) -> int:
        assert self._process is not None
        return self._process.pid

    @staticmethod
    def program(name: str) -> Path:
        return PROGRAMS / name

    def connect(self) -> dts.Daemon:
        return dts.connect(control=self.control, timeout=PATIENCE_S)

    def dtsctl(self, *arguments: str) -> str:
        command = [PROGRAMS / "dtsctl", "--timeout", f"{PATIENCE_S:g}", *arguments]
        return subprocess.run(command, env=self.environment, check=True, timeout=2 * PATIENCE_S, capture_output=True, text=True).stdout

    def _samples(self) -> bool:
        assert self._process is not None
        assert self._process.poll() is None, f"dtsd ended: {(self.folder / 'dtsd.log').read_text()}"
        try:
            with self.connect() as daemon:
                return all(rig.scans_total > 0 for rig in daemon.status().rigs)  # before its first scan nothing can be marked
        except dts.Unreachable:
            return False


class WithDaemon(unittest.TestCase):
    """Tests of one class share a daemon, on which somebody stands and somebody sits."""

    process: DaemonProcess

    @classmethod
    def setUpClass(cls) -> None:
        cls.process = DaemonProcess()
        cls.addClassCleanup(cls.process.close)

    def setUp(self) -> None:
        self.daemon = self.process.connect()
        self.addCleanup(self.daemon.close)


def status_of(instance_id: int = 1, channels: tuple[str, ...] = ("a_mm", "b_mm")) -> control_pb2.StatusSnapshot:
    status = control_pb2.StatusSnapshot(instance_id=instance_id, version="fake", utc_minus_monotonic_ns=10**18)
    rig = status.rigs.add().rig
    rig.name = "rig"
    rig.published.append("cop")
    stream = rig.streams.add(name="cop", rate=stream_pb2.Rate(numerator=100, denominator=1))
    for channel in channels:
        stream.channels.add(name=channel, unit="mm")
    return status


def block_of(sequence: int, first_scan: int, scans: int = 10, segment: int = 0, instance_id: int = 1) -> stream_pb2.StreamBlock:
    return stream_pb2.StreamBlock(
        instance_id=instance_id,
        segment=segment,
        first_scan=first_scan,
        scan_count=scans,
        channel_count=2,
        rate=stream_pb2.Rate(numerator=100, denominator=1),
        host_time_ns=first_scan * 10_000_000 + 1,
        sequence=sequence,
        values=[float(first_scan + scan) + 0.25 * channel for channel in range(2) for scan in range(scans)],
        quality=b"\x00\x04",
    )


class FakeDaemon:
    """Answers `status` and `list_rigs` like a daemon, and publishes what a test gives it; `answer` replaces the answers."""

    def __init__(self) -> None:
        self.status = status_of()
        self.answer: Callable[[control_pb2.Request], list[bytes]] | None = None
        self.requests: list[control_pb2.Request] = []
        self._context: "zmq.Context[zmq.Socket[bytes]]" = zmq.Context()
        self._control = self._context.socket(zmq.ROUTER)
        self._data = self._context.socket(zmq.XPUB)
        self._data.setsockopt(zmq.XPUB_VERBOSE, 1)
        self._outbox: list[list[bytes]] = []
        self._lock = threading.Lock()
        ports = [socket.bind_to_random_port("tcp://127.0.0.1") for socket in (self._control, self._data)]
        self.control, self.data = (f"tcp://127.0.0.1:{port}" for port in ports)
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def publish(self, topic: str, body: bytes, *more: bytes) -> None:
        with self._lock:
            self._outbox.append([topic.encode(), body, *more])

    def publish_blocks(self, *blocks: stream_pb2.StreamBlock) -> None:
        for block in blocks:
            self.publish("rig/cop", block.SerializeToString())

    def connect(self, timeout: float = PATIENCE_S) -> dts.Daemon:
        return dts.connect(self.control, self.data, timeout)

    def close(self) -> None:
        self._is_over.set()
        self._thread.join()
        self._context.destroy(linger=0)

    def _serve(self) -> None:
        poller = zmq.Poller()
        poller.register(self._control, zmq.POLLIN)
        poller.register(self._data, zmq.POLLIN)
        while not self._is_over.is_set():
            ready = dict(poller.poll(5))
            if self._control in ready:
                self._answer(self._control.recv_multipart())
            if self._data in ready and self._data.recv().startswith(b"\x01dtsd/status"):
                self._data.send_multipart([b"dtsd/status", self.status.SerializeToString()])
            with self._lock:
                waiting, self._outbox = self._outbox, []
            for message in waiting:
                self._data.send_multipart(message)

    def _answer(self, frames: list[bytes]) -> None:
        request = control_pb2.Request.FromString(frames[-1])
        self.requests.append(request)
        for answer in self.answer(request) if self.answer else self.proper(request):
            self._control.send_multipart([frames[0], b"", answer])

    def proper(self, request: control_pb2.Request) -> list[bytes]:
        response = control_pb2.Response(request_id=request.request_id)
        if request.HasField("list_rigs"):
            response.rigs.rigs.append(self.status.rigs[0].rig)
        else:
            response.status.CopyFrom(self.status)
        return [response.SerializeToString()]


def first(stream: Iterator[dts.Block], count: int) -> list[dts.Block]:
    return [next(stream) for _ in range(count)]
