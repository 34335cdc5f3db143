#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plays the story of scripts/fleet-demo: two clinics, one centre, a line that fails.

    demo.py [--check]    --check: stops after the story, otherwise it stays until Ctrl-C"""
import json
import shlex
import signal
import sys
import time
from pathlib import Path

from centre import DATABASE, Centre
from child import PROGRAMS, REPOSITORY, Failure, postgresql, run, wait_until, what_is_missing
from clinic import CHAIR, FLOOR, Clinic

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
SELECT clinic, split_part(name, '/', 1) AS condition, count(*) AS sessions, round(avg(value)::numeric, 1) AS velocity_mm_s
FROM result WHERE name LIKE '%/MVELO' AND analysis = 'clinic' GROUP BY 1, 2 ORDER BY 1, 2"""

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
        self.clinics = [Clinic(self.centre, name, rigs=(FLOOR, CHAIR), seed=7 * number + 1, bytes_per_s=RATE_BYTES_PER_S)
                        for number, name in enumerate(TITLES)]

    def close(self) -> None:
        for clinic in self.clinics:
            clinic.close()
        self.centre.close()

    def play(self) -> None:
        kent, essex = self.clinics
        self.start()
        say("Both clinics record: a person stands, and another reaches")
        for clinic in self.clinics:  # the simulated person steps on 2.5 s after dtsd has started
            wait_until("the person stands on the plate", lambda one=clinic: json.loads(one.dtsctl("status", "--json"))["uptime_s"] > 4)
        for clinic, subject in ((kent, "K002"), (essex, "E002")):
            clinic.record(8, "chair", "--subject", subject)
        self.examine((kent, "K001"), (essex, "E001"))
        self.wait_for_delivery("all four sessions have a receipt")
        self.fleet("receipts")
        self.cut(kent)
        self.query()
        self.revoke(essex, kent)
        # The next step of the fleet continues here: a worker computes a measure again; the live table of a remote rig.

    def start(self) -> None:
        say("A centre starts: a certificate authority, PostgreSQL, nats-server with TLS, dts-hub")
        self.centre.start()
        note(f"folder {self.centre.folder}, nats-server on 127.0.0.1:{self.centre.nats_port}")
        say("Two clinics are enrolled, each with a floor platform, a chair and a key of its own")
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
        wait_until("the recording waits", lambda: len(clinic.undelivered()) == 1)
        self.forward(clinic, "status")
        say("The line is back")
        clinic.line.restore()
        self.wait_for_delivery("the recording that waited has a receipt")
        self.forward(clinic, "status")

    def query(self) -> None:
        say("One question to both clinics: how fast does the centre of pressure move, mm/s?")
        words = [postgresql("psql") or "psql", "-X", "-h", str(self.centre.database_folder), "-U", "dts_hub", "-d", DATABASE, "-c"]
        output = run(*words, QUERY)
        note(QUERY + "\n" + output)
        if output.count("kent") != 2 or output.count("essex") != 2:
            raise Failure("the answer does not have two conditions of each clinic")

    def revoke(self, clinic: Clinic, other: Clinic) -> None:
        say(f"{clinic.name} leaves: its key is revoked")
        self.fleet("clinic", "revoke", clinic.name)
        revoked_s = time.monotonic()
        wait_until("dts-forward of the clinic reports it", lambda: "rejects" in clinic.problem())
        note(f"{time.monotonic() - revoked_s:.1f} s later dts-forward of {clinic.name} reports that the centre rejects its key")
        self.examine((clinic, "E003"), (other, "K004"))
        wait_until(f"{other.name} delivers", lambda: not other.undelivered())
        note(f"{clinic.name} records, and keeps its recordings: {len(clinic.undelivered())} waits; {other.name} delivers as before")

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
        say("Everything runs until Ctrl-C. In another terminal:")
        bin_folder = PROGRAMS.relative_to(REPOSITORY) if PROGRAMS.is_relative_to(REPOSITORY) else PROGRAMS
        note(f"""\
{bin_folder}/dts-fleet --config {self.centre.config} sessions
{bin_folder}/dts-forward status --config {self.clinics[0].config}
DTSD_RUNTIME_DIR={self.clinics[0].folder}/run {bin_folder}/dtsctl session list
{postgresql("psql")} -h {self.centre.database_folder} -U dts_hub {DATABASE}
Ctrl-C stops all programs and deletes the recordings of the demo.""")
        while True:
            for child in (self.centre.postgresql, self.centre.nats, self.centre.hub, *(clinic.daemon for clinic in self.clinics)):
                child.expect_alive()
            time.sleep(0.5)


def main() -> int:
    missing = what_is_missing()
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
