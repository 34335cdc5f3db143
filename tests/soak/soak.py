# SPDX-License-Identifier: Apache-2.0
"""The whole system for minutes or hours: two rigs that are recorded, the dashboard with pages, the network with a reader, and attackers.

    soak.py [--minutes 2]

Prints a Markdown table and fails when a scan is missing that nobody reported, a file is not whole, memory or descriptors of dtsd, dts-gateway
or dts-relay grow, a page shows no present data, or the attackers were not there. Appends what the processes use to a file in build/soak."""
import argparse
import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "python")]
from judge import COLUMNS, Sample, judge  # noqa: E402
from support import PATIENCE_S, PROGRAMS, SOURCE, DaemonProcess, free_ports, wait_for  # noqa: E402

RESULTS = SOURCE / "build" / "soak"
RATES_HZ = {"chair": 1500, "floor": 100}
STREAMS = ("chair/raw", "chair/deflection", "chair/transient", "floor/cop")
PAGE_STREAMS = ("chair/transient", "floor/cop")
READERS = 5
STUCK = 2
LONG_S = 600.0
LOSSES = ("lost_scans_total", "gaps_total", "dropped_blocks_total")
DASHBOARD = Path(os.environ.get("DTS_WEB_ROOT", PROGRAMS.parent / "share" / "dts-gateway" / "web"))
CHROMIUM = Path(os.environ.get("DTS_CHROMIUM", "/usr/bin/chromium"))
Child = subprocess.Popen[str]


def has_dashboard() -> bool:
    return (DASHBOARD / "index.html").is_file()


def state_of(child: Child) -> str:
    """As ps says it: S sleeps, R runs, T is stopped, Z has ended."""
    return Path(f"/proc/{child.pid}/stat").read_text().rpartition(")")[2].split()[0]


def use_of(name: str, process: int, at_s: float) -> Sample:
    folder = Path(f"/proc/{process}")
    resident = next((line for line in (folder / "status").read_text().splitlines() if line.startswith("VmRSS")), None)
    assert resident is not None, f"{name} ended after {at_s:.0f} s"  # it waits for its parent, without memory
    ticks = (folder / "stat").read_text().rpartition(")")[2].split()[11:13]
    cpu_s = sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")
    return Sample(at_s, int(resident.split()[1]) * 1024 / 1e6, len(os.listdir(folder / "fd")), cpu_s)


class Soak:
    def __init__(self, minutes: float) -> None:
        self.seconds = 60 * minutes
        self.children: list[Child] = []
        self.relay: subprocess.Popen[bytes] | None = None
        self.faults: list[str] = []
        RESULTS.mkdir(parents=True, exist_ok=True)
        self.state = Path(tempfile.mkdtemp(prefix="state-", dir=RESULTS))  # not in /tmp, which may be in memory
        control, data = free_ports(2)
        network = f'[network]\ncontrol = "tcp://127.0.0.1:{control}"\ndata = "tcp://127.0.0.1:{data}"\n\n'
        streams = ("raw", "deflection", "transient", "aux")
        self.daemon = DaemonProcess(chair_streams=streams, further=network, state=self.state)

    def close(self) -> None:
        for child in self.children:
            child.kill()
            child.wait()
        if self.relay:
            self.relay.kill()
            self.relay.wait()
        self.daemon.close()
        shutil.rmtree(self.state)

    def run(self) -> None:
        relay = self.relay = self.daemon.start_relay()
        gateway, url = self._start_gateway()
        pages = self._open_pages(url)
        readers = {f"reader {number + 1}": self._start_reader() for number in range(READERS)}
        readers["remote reader"] = self._start_reader(self._key("reader"), relay.pid)
        readers["page without a browser"] = self._start("socket_page.py", url, str(gateway.pid), str(self.seconds), *PAGE_STREAMS)
        stuck = {"stuck clients": [self._start_reader() for _ in range(STUCK)], "stuck remote clients": [self._start_reader(self._key("stuck"))]}
        for child in (*readers.values(), *sum(stuck.values(), [])):
            assert child.stdout is not None
            assert child.stdout.readline() == "reading\n", "a client got nothing at all"
        for child in sum(stuck.values(), []):
            child.send_signal(signal.SIGSTOP)
        hostile = {
            "hostile client": self._start("hostile.py", self.daemon.control, f"ipc://{self.daemon.folder}/data.sock"),
            "hostile remote peers": self._start("hostile_remote.py", str(self._key("hostile"))),
        }
        sessions = {rig: self.daemon.dtsctl("session", "start", "--rig", rig, "--protocol", "free").strip() for rig in RATES_HZ}
        samples = self._watch({"dtsd": self.daemon.pid, "dts-gateway": gateway.pid, "dts-relay": relay.pid})
        self._check_attackers(hostile, stuck)
        self._check_pages(pages, sessions)
        for rig in sessions:
            self.daemon.dtsctl("session", "stop", "--rig", rig)
        self._check_status()
        for rig, session in sessions.items():
            self._check_recording(rig, session)
        for name, child in readers.items():
            self._check_reader(name, child)
        for process, of_process in samples.items():
            verdict = judge(process, of_process)
            print(verdict.row)
            self.faults += verdict.faults

    def _start(self, program: str, *words: str, key: Path | None = None) -> Child:
        environment = self.daemon.environment | ({"DTSD_KEY": str(key)} if key else {})
        child = subprocess.Popen([sys.executable, HERE / program, *words], env=environment, stdout=subprocess.PIPE, text=True)
        self.children.append(child)
        return child

    def _start_reader(self, key: Path | None = None, relay: int | None = None) -> Child:
        behind = ("--behind", str(relay)) if relay else ()
        return self._start("client.py", *behind, str(self.seconds), *STREAMS, key=key)

    def _key(self, name: str) -> Path:
        file = self.daemon.folder / f"{name}.key"
        self.daemon.dtsctl("key", "new", name, "--role", "viewer", "--out", str(file))
        return file

    def _start_gateway(self) -> tuple[Child, str]:
        """Returns the gateway, and where it listens. Without the dashboard's files it serves an empty page."""
        web_root = DASHBOARD if has_dashboard() else self.daemon.folder / "web"
        if not has_dashboard():
            web_root.mkdir()
            (web_root / "index.html").write_text("<!doctype html><title>empty</title>\n")
        file = self.daemon.folder / "gateway.log"
        command = [PROGRAMS / "dts-gateway", "serve", "--listen", "127.0.0.1:0", "--web-root", web_root, "--cache", self.daemon.folder]
        with file.open("w") as log:
            gateway = subprocess.Popen(command, env=self.daemon.environment, stdout=log, stderr=log, text=True)
        self.children.append(gateway)
        listening = re.compile(r"^listening on (\S+)/\n", re.MULTILINE)
        wait_for(lambda: listening.search(file.read_text()) is not None or gateway.poll() is not None, "dts-gateway listens")
        found = listening.search(file.read_text())
        assert found, f"dts-gateway ended: {file.read_text()}"
        return gateway, found[1]

    def _open_pages(self, url: str) -> Child | None:
        """Opens pages in Chromium. It draws without a graphics card, so the readers go first (nice)."""
        if not (shutil.which("node") and CHROMIUM.is_file() and has_dashboard()):
            return None
        reload_s = 60 if self.seconds >= LONG_S else 20
        command = ["nice", "-n", "10", "node", HERE / "pages.mjs", url, str(reload_s)]
        pages = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.children.append(pages)
        assert pages.stdout is not None
        assert pages.stdout.readline() == "open\n", "the pages of the dashboard could not be opened"
        return pages

    def _watch(self, processes: dict[str, int]) -> dict[str, list[Sample]]:
        """Appends a row for each process to a file, so that an interrupted run can still be read."""
        samples: dict[str, list[Sample]] = {process: [] for process in processes}
        file = RESULTS / time.strftime("soak-%Y%m%dT%H%M%S.csv")
        seconds = self.seconds - 10
        every_s = min(10.0, seconds / 40)
        begun_s = time.monotonic()
        with file.open("w", newline="") as lines:
            print(f"samples: {file}", file=sys.stderr)
            table = csv.writer(lines)
            table.writerow(COLUMNS)
            while (elapsed_s := time.monotonic() - begun_s) < seconds:
                for process, identity in processes.items():
                    samples[process].append(use_of(process, identity, elapsed_s))
                losses = self._losses()
                for process, of_process in samples.items():
                    sample = of_process[-1]
                    of_daemon = losses if process == "dtsd" else ("", "", "")
                    used = (f"{sample.resident_mb:.3f}", sample.descriptors, f"{sample.cpu_s:.2f}")
                    table.writerow((f"{elapsed_s:.1f}", process, *used, *of_daemon))
                lines.flush()
                if sys.stderr.isatty():
                    used_mb = ", ".join(f"{process} {of_process[-1].resident_mb:.1f} MB" for process, of_process in samples.items())
                    print(f"\r{elapsed_s / 60:.1f} of {seconds / 60:.1f} min, {used_mb}", end="", file=sys.stderr)
                time.sleep(every_s)
        return samples

    def _rigs(self) -> list[dict[str, int]]:
        rigs: list[dict[str, int]] = json.loads(self.daemon.dtsctl("status", "--json"))["rigs"]
        return rigs

    def _losses(self) -> tuple[int, ...]:
        rigs = self._rigs()
        return tuple(sum(rig[what] for rig in rigs) for what in LOSSES)

    def _check_attackers(self, hostile: dict[str, Child], stuck: dict[str, list[Child]]) -> None:
        """A system that nobody attacked has not withstood anything."""
        for name, child in hostile.items():
            ended = child.poll()
            print(f"| {name} | {'ran to the end' if ended is None else f'ended with {ended}'} |")
            self._expect(ended is None, f"{name}: ended with {ended}, so for some of the time nobody attacked")
        for name, children in stuck.items():
            stopped = sum(state_of(child) == "T" for child in children)
            print(f"| {name} | {stopped} of {len(children)} still stopped |")
            self._expect(stopped == len(children), f"{name}: only {stopped} of {len(children)} were still there")
        peers = hostile["hostile remote peers"]
        if peers.poll() is None:
            peers.terminate()
            text, _ = peers.communicate(timeout=PATIENCE_S)
            attacks = json.loads(text)
            print(f"| attacks on dts-relay | {', '.join(f'{name} {count}' for name, count in attacks.items())} |")
            self._expect(min(attacks.values()) > 0, f"some attacks on dts-relay never ran: {attacks}")
        log = (self.daemon.folder / "relay.log").read_text()
        for what in ("connections", "malformed or excess requests"):
            self._expect(any("rejected " in line and what in line for line in log.splitlines()), f"dts-relay rejected no {what}")

    def _check_pages(self, pages: Child | None, sessions: dict[str, str]) -> None:
        if pages is None:
            print("| pages in a browser | no browser |")
            return
        text, _ = pages.communicate(" ".join(sessions.values()) + "\n", timeout=10 * PATIENCE_S)
        self._expect(text != "", f"the pages of the dashboard ended with {pages.returncode}")
        if text:
            seen = json.loads(text)
            print(f"| pages in a browser | {seen['pages']} in {seen['product']}, {seen['reloads']} reloads, {len(seen['faults'])} faults |")
            self.faults += [f"page of the dashboard: {fault}" for fault in seen["faults"]]

    def _check_status(self) -> None:
        status = json.loads(self.daemon.dtsctl("status", "--json"))
        rejected = status["rejected_requests_total"]
        print(f"| daemon: rejected_requests_total | {rejected} |")
        self._expect(rejected > 0, "the daemon rejected nothing: the hostile client did not reach it")
        for rig in status["rigs"]:
            name = rig["rig"]["name"]
            print(f"| {name}: {', '.join(LOSSES)} | {', '.join(str(rig[what]) for what in LOSSES)} |")
            for what in LOSSES:
                self._expect(rig[what] == 0, f"{name}: {what} is {rig[what]}")

    def _check_recording(self, rig: str, session: str) -> None:
        parts = json.loads(self.daemon.dtsctl("session", "show", session, "--json"))["parts"]
        verified = subprocess.run(
            [self.daemon.program("dtsctl"), "session", "verify", session], env=self.daemon.environment, capture_output=True, text=True
        )
        part = parts[0]
        print(f"| recording of {rig} | {part['duration_s']:.1f} s, {part['scans']} scans, {part['state']} |")
        self._expect(len(parts) == 1, f"the recording of {rig} has {len(parts)} parts")
        self._expect(verified.returncode == 0, f"the recording of {rig} is damaged: {verified.stdout}{verified.stderr}")
        self._expect(part["state"] == "complete", f"the recording of {rig} is {part['state']}")
        rate_hz = RATES_HZ[rig]
        self._expect(abs(part["scans"] - part["duration_s"] * rate_hz) < rate_hz / 10, f"the recording of {rig} has a hole")
        self._expect(part["duration_s"] > self.seconds - 20, f"the recording of {rig} has {part['duration_s']:.1f} s only")

    def _check_reader(self, name: str, child: Child) -> None:
        text, _ = child.communicate(timeout=2 * PATIENCE_S)
        self._expect(child.returncode == 0, f"{name}: ended with {child.returncode}")
        if child.returncode != 0:
            return
        heard = json.loads(text)
        counts = heard["counts"]
        missed = sum(count["missed"] for count in counts.values())
        unexcused = missed - sum(count["excused"] for count in counts.values())
        scans = sum(count["scans"] for count in counts.values())
        notes = [f"{scans} scans of {len(counts)} streams", f"{missed} missed"]
        if "dropped_scans" in heard:
            notes.append(f"{heard['dropped_scans']} dropped by the gateway, metrics {heard['metrics']} times")
            self._expect(heard["metrics"] > 0, f"{name}: dts-gateway served no metrics")
        if "oldest_s" in heard:
            notes.append(f"blocks at most {heard['oldest_s']:.1f} s old")
        print(f"| {name} | {', '.join(notes)}, at most {heard['starved_s']:.1f} of 4 s without a core |")
        # A reader that waits for a core for longer than its queue lasts loses blocks right after. Any other loses nothing.
        self._expect(unexcused == 0, f"{name}: missed {unexcused} scans, and had not waited for a core before")
        for topic, count in counts.items():
            known = count["scans"] + count["missed"]
            least = (self.seconds - 1) * RATES_HZ[topic.partition("/")[0]]
            self._expect(known > least, f"{name}: knows of {known} scans of {topic} only")

    def _expect(self, holds: bool, fault: str) -> None:
        if not holds:
            self.faults.append(fault)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=2.0)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # ends the children, too
    soak = Soak(parser.parse_args().minutes)
    rigs = " and ".join(f"{rig} at {rate_hz} Hz" for rig, rate_hz in RATES_HZ.items())
    try:
        print(f"| {soak.seconds / 60:.0f} min, {rigs}, {READERS} readers | |\n|---|---|", flush=True)
        soak.run()
    finally:
        soak.close()
    for fault in soak.faults:
        print(f"soak: {fault}", file=sys.stderr)
    return 1 if soak.faults else 0


if __name__ == "__main__":
    sys.exit(main())
