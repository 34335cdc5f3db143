#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plays the story of scripts/fleet-demo: two clinics, one centre with a worker and a dashboard, a line that fails.

    demo.py [--check]    --check: stops after the story, otherwise it stays until Ctrl-C"""
import json
import math
import os
import shlex
import signal
import socket
import sys
import time
from pathlib import Path

from centre import DATABASE, Centre
from child import PROGRAMS, REPOSITORY, Failure, postgresql, run, wait_until, what_is_missing
from clinic import CHAIR, FLOOR, Clinic
from gateway import WEB_ROOT, Gateway
from viewer import Viewer

TITLES = {"kent": "Kent and Canterbury", "essex": "Essex County"}
RATE_BYTES_PER_S = 1_000_000.0
PROTOCOL = """\
name = "standing"
title = "Standing, for the demo"
sentence = "Standing still for 4 s, twice"
rig_kind = "floor"
[trials]
order = "as-listed"
trials_per_block = 2
blocks = 1
starts_by_itself = true
settle_s = 0.5
duration_s = 4
[[trials.condition]]
name = "eyes-open"
title = "Eyes open"
[[trials.condition]]
name = "eyes-closed"
title = "Eyes closed"
"""
QUERY = """\
SELECT c.clinic, split_part(c.name, '/', 1) AS condition, count(*) AS sessions,
       round(avg(c.value)::numeric, 2) AS mm_s_of_the_clinic, round(avg(w.value)::numeric, 2) AS mm_s_of_the_worker
FROM result c LEFT JOIN result w ON (w.clinic, w.session, w.name) = (c.clinic, c.session, c.name) AND w.analysis LIKE 'sway %'
WHERE c.analysis = 'clinic' AND c.name LIKE '%/MVELO' GROUP BY 1, 2 ORDER BY 1, 2"""
WATCHED_S = 3
DASHBOARD_PORT = int(os.environ.get("DTS_DEMO_PORT", "8080"))

begun_s = time.monotonic()


def say(text: str) -> None:
    bold, plain = ("\033[1m", "\033[0m") if sys.stdout.isatty() else ("", "")
    print(f"\n{bold}{time.monotonic() - begun_s:5.1f} s  {text}{plain}", flush=True)


def note(text: str) -> None:
    print("\n".join(f"         {line}" for line in text.rstrip().splitlines()), flush=True)


def show(where: str, words: list[str | Path], output: str) -> None:
    """Prints a command, with short paths, and what it printed."""
    short = " ".join(shlex.quote(str(word).replace(f"{PROGRAMS}/", "")) if not str(word).endswith(".toml") else Path(word).name for word in words)
    note(f"{where}$ {short}\n{output}")


class Demo:
    def __init__(self) -> None:
        self.centre = Centre()
        self.gateway = Gateway(self.centre, 0 if "--check" in sys.argv else port_of_dashboard())
        self.clinics = [Clinic(self.centre, name, rigs=(FLOOR, CHAIR), seed=7 * number + 1, bytes_per_s=RATE_BYTES_PER_S)
                        for number, name in enumerate(TITLES)]

    def close(self) -> None:
        self.gateway.stop()
        for clinic in self.clinics:
            clinic.close()
        self.centre.close()

    def play(self) -> None:
        kent, essex = self.clinics
        self.start()
        say("Both clinics examine people: one stands, another reaches")
        for clinic in self.clinics:  # the simulated person steps on 2.5 s after dtsd has started
            wait_until("the person stands on the plate", lambda one=clinic: json.loads(one.dtsctl("status", "--json"))["uptime_s"] > 4)
        for clinic, subject in ((kent, "K002"), (essex, "E002")):
            clinic.record(8, "chair", "--subject", subject)
        self.examine((kent, "K001"), (essex, "E001"))
        self.wait_for_delivery("all four sessions have a receipt")
        self.fleet("receipts")
        self.watch(essex)
        self.cut(kent)
        self.analyse()
        self.query()
        self.revoke(essex, kent)

    def start(self) -> None:
        say("A centre starts: PostgreSQL, nats-server with TLS, dts-hub, a worker, a dashboard")
        self.centre.start()
        self.centre.start_worker()
        self.gateway.start()
        wait_until("the dashboard listens", self.gateway.address)
        note(f"folder       {self.centre.folder}\nnats-server  tls://127.0.0.1:{self.centre.nats_port}\ndashboard    {self.gateway.address()}/")
        say("Two clinics join, each with a floor platform, a chair and a key of its own")
        for clinic in self.clinics:
            clinic.protocols["standing"] = PROTOCOL
            clinic.start(TITLES[clinic.name])
        self.fleet("clinic", "list")

    def cut(self, clinic: Clinic) -> None:
        say(f"The line of {clinic.name} is cut. The clinic continues to examine people")
        clinic.line.cut()
        self.examine((clinic, "K003"))
        wait_until("the last session is closed", lambda: not clinic.is_recording())
        lost = sum(rig["lost_scans_total"] for rig in json.loads(clinic.dtsctl("status", "--json"))["rigs"])
        note(f"lost scans at {clinic.name}: {lost}")
        if lost:
            raise Failure(f"{clinic.name} lost scans while its line was cut")
        wait_until("the recording waits", lambda: len(clinic.undelivered()) == 1)
        self.forward(clinic, "status")
        say("The line is back")
        clinic.line.restore()
        self.wait_for_delivery("the recording that waited has a receipt")
        wait_until("dts-forward has no problem", lambda: not clinic.problem())
        self.forward(clinic, "status")

    def watch(self, clinic: Clinic) -> None:
        say(f"The centre watches the floor platform of {clinic.name}. Only what is watched leaves a clinic")
        viewer = Viewer(self.gateway.address() or "", clinic.name, "floor/cop")
        try:
            asked_s = time.monotonic()
            wait_until("the first values arrive", lambda: viewer.newest("floor/cop"))
            note(f"first values after {viewer.blocks[0].received_s - asked_s:.2f} s: {self.gateway.address()}/#/clinics/{clinic.name}/floor/floor")
            note("right_mm  forward_mm  load_N  age_ms")
            for _ in range(2 * WATCHED_S):
                time.sleep(0.5)
                block = viewer.newest("floor/cop")
                assert block is not None
                note("".join(f"{value:{width}.1f}" for value, width in zip(block.scans[0][:3], (8, 12, 8), strict=True))
                     + f"{1000 * (block.received_s - block.sampled_s):8.0f}")
            if not any(math.isfinite(block.scans[0][0]) for block in viewer.blocks):
                raise Failure("nobody stands on the plate that is watched")
        finally:
            viewer.close()

    def analyse(self) -> None:
        say("A worker of the centre computes the sway of all recordings again")
        self.fleet("jobs", "add", "--kind", "sway", "--protocol", "standing")
        wait_until("all jobs are done", lambda: self.centre.query("SELECT count(*) FROM job WHERE state <> 'done'") == "0")
        self.fleet("jobs", "list")

    def query(self) -> None:
        say("One question to both clinics: the mean velocity of the centre of pressure, from the clinic and from the worker")
        words = [postgresql("psql") or "psql", "-X", "-h", str(self.centre.database_folder), "-U", "dts_hub", "-d", DATABASE, "-c"]
        output = run(*words, QUERY)
        note(QUERY + "\n" + output)
        rows = [[cell.strip() for cell in line.split("|")] for line in output.splitlines() if line.startswith((" kent", " essex"))]
        if len(rows) != 4 or any(row[3] != row[4] for row in rows):
            raise Failure("the answer does not have two conditions of each clinic, with the same results of clinic and worker")

    def revoke(self, clinic: Clinic, other: Clinic) -> None:
        say(f"{clinic.name} leaves: its key is revoked")
        self.fleet("clinic", "revoke", clinic.name)
        revoked_s = time.monotonic()
        wait_until("dts-forward of the clinic reports it", lambda: "rejects" in clinic.problem())
        note(f"{time.monotonic() - revoked_s:.1f} s later dts-forward of {clinic.name} reports that the centre rejects its key")
        self.examine((clinic, "E003"), (other, "K004"))
        wait_until(f"{other.name} delivers", lambda: not other.undelivered())
        waiting = len(clinic.undelivered())
        note(f"{clinic.name} records, and keeps its recordings: {waiting} waits; {other.name} delivers as before")
        if waiting != 1:
            raise Failure(f"of {clinic.name}, whose key is revoked, {waiting} recordings wait instead of 1")

    def examine(self, *pairs: tuple[Clinic, str]) -> None:
        """Examines a subject in each of these clinics at the same time, on the floor platform, to the end of the protocol."""
        for clinic, subject in pairs:
            clinic.dtsctl("session", "start", "--rig", "floor", "--protocol", "standing", "--subject", subject)
        for clinic, _ in pairs:
            clinic.dtsctl("session", "trial", "next", "--rig", "floor")
        for clinic, subject in pairs:
            wait_until(f"{subject} has stood", lambda one=clinic: '"phase": "finished"' in one.dtsctl("status", "--json"))
            clinic.dtsctl("session", "stop", "--rig", "floor")

    def wait_for_delivery(self, what: str) -> None:
        wait_until(what, lambda: all(not clinic.undelivered() for clinic in self.clinics))

    def fleet(self, *words: str) -> None:
        show("centre", ["dts-fleet", *words], self.centre.fleet(*words))

    def forward(self, clinic: Clinic, *words: str) -> None:
        show(clinic.name, ["dts-forward", *words], clinic.forward(*words))

    def stay(self) -> None:
        say(f"Everything runs until Ctrl-C. The dashboard: {self.gateway.address()}/. In another terminal:")
        bin_folder = PROGRAMS.relative_to(REPOSITORY) if PROGRAMS.is_relative_to(REPOSITORY) else PROGRAMS
        note(f"""\
{bin_folder}/dts-fleet --config {self.centre.config} sessions
{bin_folder}/dts-forward status --config {self.clinics[0].config}
DTSD_RUNTIME_DIR={self.clinics[0].folder}/run {bin_folder}/dtsctl session list
{postgresql("psql")} -h {self.centre.database_folder} -U dts_hub {DATABASE}
Ctrl-C stops all programs and deletes the recordings of the demo.""")
        while True:
            for child in (self.centre.postgresql, self.centre.nats, self.centre.hub, self.centre.worker, self.gateway, *(clinic.daemon for clinic in self.clinics)):
                child.expect_alive()
            time.sleep(0.5)


def port_of_dashboard() -> int:
    """Returns the usual port, or 0, which is any free one, if it is taken."""
    with socket.socket() as tried:
        try:
            tried.bind(("127.0.0.1", DASHBOARD_PORT))
        except OSError:
            return 0
    return DASHBOARD_PORT


def main() -> int:
    missing = what_is_missing("dts-worker", "dtslab", "dts-fleet-gateway")
    if not missing and not Path(WEB_ROOT, "index.html").exists():
        missing = f"the dashboard is not in {WEB_ROOT}"
    if missing:
        print(f"fleet-demo: {missing}", file=sys.stderr)
        return 1
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    demo = Demo()
    try:
        demo.play()
        if "--check" in sys.argv:
            say("The check of the fleet passed")
        else:
            demo.stay()
    except Failure as failure:
        print(f"\nfleet-demo: {failure}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print()
        return 130
    finally:
        demo.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
