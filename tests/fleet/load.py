#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures a centre under load, with real servers and TLS. Not part of the suite: it measures time.

    load.py idle [--clinics 1000] [--seconds 60]   connections of clinics (two each) that only send heartbeats, one in 10 s
    load.py live [--rigs 500] [--seconds 60]       rigs that publish 16 channels at 1500 Hz, float32, and one viewer of all of them
    load.py upload [--mb 500]                      one recording through dts-forward and dts-hub; the same file by PUT to nginx

The senders are in this process, the viewer in another one: their CPU is not counted. On a machine with few cores they limit the rest."""
import argparse
import contextlib
import json
import os
import selectors
import shutil
import signal
import sqlite3
import ssl
import struct
import subprocess
import sys
import time
from pathlib import Path

from centre import Centre, sha256_of
from checks import run_test
from child import Child, Failure, free_port, wait_until
from clinic import LARGE_FLOOR, Clinic
from gateway import admit
from nats_client import SEED_PREFIX, USER_PREFIX, NKey, connect, with_checksum
from protobuf import fixed64, message

BEAT_PAUSE_S = 10.0
BLOCK_S = 0.04  # as dts-forward publishes
BLOCK_BYTES = 16 * 60 * 4  # 16 channels, 60 scans, float32
RIGS_OF_A_CLINIC = 50
TICKS = os.sysconf("SC_CLK_TCK")


def new_key() -> NKey:
    return NKey(with_checksum(bytes([SEED_PREFIX | USER_PREFIX >> 5, (USER_PREFIX & 31) << 3]) + os.urandom(32)))


def cpu_s(pid: int) -> float:
    """Returns the CPU time of a process and of its children, s."""
    children = [int(word) for task in Path(f"/proc/{pid}/task").glob("*/children") for word in task.read_text().split()]
    words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / TICKS + sum(cpu_s(child) for child in children)


class Usage:
    """CPU and memory of servers since now."""

    def __init__(self, *children: Child) -> None:
        self._children = children
        self._begun_s = time.monotonic()
        self._begun_cpu_s = [cpu_s(child.pid) for child in children]

    def show(self) -> None:
        elapsed_s = time.monotonic() - self._begun_s
        for child, begun_s in zip(self._children, self._begun_cpu_s, strict=True):
            print(f"        {child.name}: {100 * (cpu_s(child.pid) - begun_s) / elapsed_s:.1f} % of a core, "
                  f"{child.resident_kib() / 1024:.0f} MiB", flush=True)


def enrol(centre: Centre, count: int) -> list[tuple[str, NKey]]:
    """Adds clinics to the database at once: dts-fleet adds one."""
    clinics = [(f"clinic-{number}", new_key()) for number in range(count)]
    rows = ", ".join(f"('{name}', '{name}', '{key.public}')" for name, key in clinics)
    wait_until("dts-hub has made its tables", lambda: centre.query_or_none("SELECT count(*) FROM clinic") is not None)
    script = centre.folder / "clinics.sql"
    script.write_text(f"INSERT INTO clinic (id, title, nkey) VALUES {rows}; NOTIFY clinic;")
    centre.run_script(script)
    wait_until("nats-server knows the clinics", lambda: clinics[-1][1].public in (centre.folder / "users-1.conf").read_text())
    time.sleep(2)  # nats-server ends connections that begin while it reads its users
    return clinics


def idle(count: int, seconds: float) -> None:
    centre = Centre()
    try:
        centre.start()
        clinics = enrol(centre, count)
        selector = selectors.DefaultSelector()
        ca = centre.folder / "ca.pem"
        talks: list[ssl.SSLSocket] = []
        begun_s = time.monotonic()
        for name, key in clinics:
            for is_talk in (True, False):
                tls = connect(centre.nats_port, ca, key)
                tls.sendall(f"SUB _INBOX.{name}.{'talk' if is_talk else 'live'}.> 1\r\nSUB dts.v1.{name}.down.> 2\r\nPING\r\n".encode())
                tls.setblocking(False)
                selector.register(tls, selectors.EVENT_READ)
                if is_talk:
                    talks.append(tls)
        print(f"        {2 * count} connections in {time.monotonic() - begun_s:.1f} s", flush=True)
        serve_idle(selector, clinics, talks, BEAT_PAUSE_S)  # each clinic has reported once
        usage = Usage(centre.nats, centre.hub, centre.postgresql)
        answers = serve_idle(selector, clinics, talks, seconds)
        usage.show()
        print(f"        {answers} of {seconds / BEAT_PAUSE_S * count:.0f} heartbeats were answered "
              "(bars: nats-server 15 %, 200 MB; dts-hub 10 %)")
    finally:
        centre.close()


def serve_idle(selector: selectors.BaseSelector, clinics: list[tuple[str, NKey]], talks: list[ssl.SSLSocket], seconds: float) -> int:
    """Sends heartbeats in turn. Returns the number of answers."""
    begun_s, sent, answers = time.monotonic(), 0, 0
    while (now_s := time.monotonic()) < begun_s + seconds:
        while sent < (now_s - begun_s) * len(clinics) / BEAT_PAUSE_S:
            name, beat = clinics[sent % len(clinics)][0], message({1: fixed64(time.time_ns()), 2: "0.1.0"})
            talks[sent % len(clinics)].sendall(f"PUB dts.v1.{name}.beat _INBOX.{name}.talk.1 {len(beat)}\r\n".encode() + beat + b"\r\n")
            sent += 1
        for key, _ in selector.select(0.005):
            tls = key.fileobj
            assert isinstance(tls, ssl.SSLSocket)
            try:
                data = tls.recv(65536)
            except (ssl.SSLWantReadError, ssl.SSLWantWriteError):
                continue
            if not data:
                raise Failure("nats-server closed a connection")
            answers += data.count(b"MSG _INBOX")
            if b"PING\r\n" in data:
                tls.sendall(b"PONG\r\n")
            if b"-ERR" in data:
                raise Failure(f"nats-server: {data[:200]!r}")
    return answers


def live(rigs: int, seconds: float) -> None:
    centre = Centre()
    try:
        centre.start()
        clinics = enrol(centre, -(-rigs // RIGS_OF_A_CLINIC))
        ca = centre.folder / "ca.pem"
        senders = [connect(centre.nats_port, ca, key) for _, key in clinics]
        names = [[f"dts.v1.{clinic}.live.rig{number}.raw" for number in range(min(RIGS_OF_A_CLINIC, rigs - RIGS_OF_A_CLINIC * index))]
                 for index, (clinic, _) in enumerate(clinics)]
        viewer_key = NKey.of_file(admit(centre, "viewer"))
        reader, writer = os.pipe()
        viewer = os.fork()
        if viewer == 0:
            os.write(writer, json.dumps(view(centre, ca, viewer_key)).encode())
            os._exit(0)
        time.sleep(1)
        usage = Usage(centre.nats)
        sent, behind_s = publish(senders, names, seconds)
        usage.show()
        time.sleep(2)
        os.kill(viewer, signal.SIGTERM)
        got = json.loads(os.read(reader, 65536))
        os.waitpid(viewer, 0)
        print(f"        {rigs} rigs, {sent} blocks sent, {sent * BLOCK_BYTES / seconds / 1e6:.1f} MB/s; the senders were at most {behind_s:.2f} s late")
        print(f"        {got['blocks']} blocks received, {sent - got['blocks']} lost, {got['jumps']} jumps of a rig's numbers; age: "
              f"median {got['p50_ms']:.1f} ms, 99 of 100 below {got['p99_ms']:.1f} ms (bars: lost 0, nats-server 1 core, 100 MB; 100 ms)")
    finally:
        centre.close()


def publish(senders: list[ssl.SSLSocket], names: list[list[str]], seconds: float) -> tuple[int, float]:
    """Sends a block of each rig in turn. Returns the number of blocks, and how late the senders were at most."""
    filler = os.urandom(BLOCK_BYTES - 16)
    begun_s, sent, behind_s = time.monotonic(), 0, 0.0
    for turn in range(int(seconds / BLOCK_S)):
        for index, (tls, subjects) in enumerate(zip(senders, names, strict=True)):
            due_s = begun_s + BLOCK_S * (turn + index / len(senders))
            if (wait_s := due_s - time.monotonic()) > 0:
                time.sleep(wait_s)
            behind_s = max(behind_s, -wait_s)
            tail = struct.pack("<qq", time.monotonic_ns(), turn) + filler + b"\r\n"
            tls.sendall(b"".join(f"PUB {subject} {BLOCK_BYTES}\r\n".encode() + tail for subject in subjects))
            sent += len(subjects)
    return sent, behind_s


def view(centre: Centre, ca: Path, key: NKey) -> dict[str, float]:
    """Receives all live data until SIGTERM."""
    class End(Exception):
        pass

    def end(*_: object) -> None:
        raise End

    signal.signal(signal.SIGTERM, end)
    tls = connect(centre.nats_port, ca, key)
    tls.sendall(b"SUB dts.v1.*.live.> 1\r\n")
    ages: list[int] = []
    turns: dict[bytes, int] = {}
    jumps, left = 0, b""
    try:
        while data := tls.recv(1 << 18):
            now = time.monotonic_ns()
            left, at = left + data, 0
            while (stop := left.find(b"\r\n", at)) >= 0:
                words = left[at:stop].split()
                if words[0] != b"MSG":
                    if words[0] == b"PING":
                        tls.sendall(b"PONG\r\n")
                    at = stop + 2
                    continue
                size = int(words[-1])
                if len(left) < stop + 2 + size + 2:
                    break
                sent_ns, turn = struct.unpack_from("<qq", left, stop + 2)
                ages.append(now - sent_ns)
                jumps += turn != turns.get(words[1], -1) + 1
                turns[words[1]] = turn
                at = stop + 2 + size + 2
            left = left[at:]
    except End:
        pass
    ages.sort()
    return {"blocks": len(ages), "jumps": jumps, "p50_ms": ages[len(ages) // 2] / 1e6, "p99_ms": ages[len(ages) * 99 // 100] / 1e6}


def grown(recording: Path, size: int) -> None:
    """Repeats the largest chunk of samples of a recording until it has this size. dts-forward reads the chunks, not the values."""
    data, at, chunks = recording.read_bytes(), 4, []
    while at < len(data):
        width = data[at]
        length = int.from_bytes(data[at + 1:at + 1 + width], "little")
        end = at + 1 + width + length
        chunks.append((end - at if int.from_bytes(data[at + 1 + width:at + 3 + width], "little") == 3 else 0, at, end))
        at = end
    _, begin, end = max(chunks)
    with recording.open("wb") as file:
        file.write(data[:end])
        for _ in range((size - len(data)) // (end - begin)):
            file.write(data[begin:end])
        file.write(data[end:])


def upload(megabytes: int) -> None:
    centre = Centre()
    clinic = Clinic(centre, "kent", rigs=(LARGE_FLOOR,), has_line=False)
    try:
        centre.start()
        clinic.start()
        clinic.forwarder.stop()
        clinic.record(3.0)
        wait_until("the session has ended", lambda: not clinic.is_recording() and clinic.recorded())
        clinic.daemon.stop()
        file = next(path for path in (clinic.folder / "state").rglob("*.xdf"))
        grown(file, megabytes * 1_000_000)
        size = file.stat().st_size
        with contextlib.closing(sqlite3.connect(next((clinic.folder / "state").rglob("catalogue*.sqlite")))) as catalogue:
            catalogue.execute("UPDATE parts SET sha256 = ?, bytes = ?", (sha256_of(file), size))
            catalogue.commit()
        clinic.daemon.start()
        wait_until("dtsd answers", lambda: clinic.answers())
        nginx_s = put_to_nginx(centre, file)
        clinic.forwarder.start()
        begun_s = time.monotonic()
        usage = Usage(centre.nats, centre.hub, clinic.forwarder)
        wait_until("the first bytes are there", lambda: staged_bytes(centre), 600)
        first_s = time.monotonic() - begun_s
        wait_until("all bytes are there", lambda: staged_bytes(centre) in (None, size), 600)
        sent_s = time.monotonic() - begun_s
        wait_until("the recording has a receipt", centre.receipts, 600)
        ours_s = time.monotonic() - begun_s
        usage.show()
        again_s = put_to_nginx(centre, file)
        print(f"        {size / 1e6:.0f} MB: dts-forward and dts-hub {ours_s:.2f} s, {size / ours_s / 1e6:.0f} MB/s, with two SHA-256 and the disk; "
              f"nginx PUT {nginx_s:.2f} and {again_s:.2f} s, {2 * size / (nginx_s + again_s) / 1e6:.0f} MB/s")
        print(f"        of it: {first_s:.2f} s until the first bytes (start, SHA-256 of the file), {sent_s - first_s:.2f} s to send "
              f"({size / (sent_s - first_s) / 1e6:.0f} MB/s), {ours_s - sent_s:.2f} s for the commit")
        put_s, safe_s = (nginx_s + again_s) / 2, plain_commit_s(centre, file)
        print(f"        a plain program needs {safe_s:.2f} s to synchronise a copy and to read it again for a SHA-256")
        print(f"        speed of sending beside nginx's PUT: {put_s / (sent_s - first_s):.0%}; until the receipt beside a PUT that is as safe: "
              f"{(put_s + safe_s) / (ours_s - first_s):.0%} (bar: 60 %)")
    finally:
        clinic.close()
        centre.close()


def staged_bytes(centre: Centre) -> int | None:
    """Returns the size of the staged file; None: there is none."""
    try:
        return next((path.stat().st_size for path in centre.staged() if path.suffix == ".part"), None)
    except FileNotFoundError:
        return None


def plain_commit_s(centre: Centre, file: Path) -> float:
    """Returns how long the two costly steps of a commit take on this disk, s, after the bytes were written."""
    copy = centre.store / "copy"
    shutil.copyfile(file, copy)
    begun_s = time.monotonic()
    with copy.open("rb+") as opened:
        os.fsync(opened.fileno())
        os.posix_fadvise(opened.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
    sha256_of(copy)
    return time.monotonic() - begun_s


def put_to_nginx(centre: Centre, file: Path) -> float:
    """Returns how long a PUT takes, s. nginx does not synchronise, nor compute a SHA-256."""
    found = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")
    if found is None:
        raise Failure("nginx is not installed: apt-get install nginx-light curl")
    folder, port = centre.folder / "nginx", free_port()
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "files").mkdir(parents=True)
    (folder / "nginx.conf").write_text(f"""\
daemon off; worker_processes 1; pid {folder}/pid; error_log {folder}/log; {"user root;" if os.geteuid() == 0 else ""}
events {{}}
http {{
  access_log off; client_max_body_size 0; client_body_temp_path {folder}/files/new; root {folder}/files;
  server {{
    listen 127.0.0.1:{port} ssl; ssl_certificate {centre.folder}/nats.pem; ssl_certificate_key {centre.folder}/nats.key;
    location / {{ dav_methods PUT; }}
  }}
}}
""")
    nginx = Child("nginx", [found, "-c", folder / "nginx.conf", "-p", folder], folder / "nginx.log", stop_signal=signal.SIGQUIT)
    nginx.start()
    try:
        wait_until("nginx has started", lambda: nginx.expect_alive() and (folder / "pid").exists())
        begun_s = time.monotonic()
        subprocess.run(["curl", "-sSf", "--http1.1", "-o", "/dev/null", "--cacert", centre.folder / "ca.pem", "-T", file,
                        f"https://127.0.0.1:{port}/recording"], check=True)
        return time.monotonic() - begun_s
    finally:
        nginx.stop()
        shutil.rmtree(folder, ignore_errors=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for name, what, default in (("idle", "clinics", 1000), ("live", "rigs", 500), ("upload", "mb", 500)):
        command = commands.add_parser(name)
        command.add_argument(f"--{what}", type=int, default=default)
        command.add_argument("--seconds", type=float, default=60.0)
    words = parser.parse_args()
    if words.command == "idle":
        run_test(lambda _: idle(words.clinics, words.seconds))
    elif words.command == "live":
        run_test(lambda _: live(words.rigs, words.seconds))
    else:
        run_test(lambda _: upload(words.mb))
    return 0


if __name__ == "__main__":
    sys.exit(main())
