#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Kills parts of a fleet at random while two clinics record and upload, and checks that nothing is lost, doubled or wrong.

    kills.py [--kills 100] [--seed N]

Killed are nats-server, dts-hub, PostgreSQL, dts-forward of a clinic, and its line. At each kill: every receipt, at the centre and at the
clinics, belongs to a whole file. At the end: every recording of every clinic is one file, one row and one receipt at the centre, with the
SHA-256 that the forwarder states. Prints the seed, with which the same kills are chosen again."""
import argparse
import random
import signal
import time
from collections import Counter

from centre import Centre, sha256_of
from checks import Checks, run_test
from child import Failure, wait_until
from clinic import LARGE_FLOOR, Clinic

RATE_BYTES_PER_S = 500_000.0  # of a clinic's line: a recording of 3 s takes 1.3 s
LARGEST_BACKLOG = 3  # files; the clinic records no more until the centre has them
RESENT_SHARE = 1.1  # the sheet's bar: bytes sent <= 1.1 x size + 4 MiB for each interruption
RESENT_A_KILL = 4 * 1024 * 1024
LAST_FILES_S = 300.0


class Kills:
    def __init__(self, checks: Checks, centre: Centre, clinics: list[Clinic], seed: int) -> None:
        self.checks = checks
        self.centre = centre
        self.clinics = clinics
        self.random = random.Random(seed)
        self.count: Counter[str] = Counter()
        self.with_upload = 0  # kills while a file was on its way
        self.known_whole: set[tuple[str, str]] = set()
        self.broken: list[str] = []
        self._next_session_s = {clinic.name: 0.0 for clinic in clinics}

    def run(self, kills: int) -> None:
        for number in range(5 * kills):
            if number >= kills and self.with_upload:  # a slow machine may have had no upload at a kill yet
                break
            wait_s = self.random.uniform(0.05, 0.8)
            until_s = time.monotonic() + wait_s
            while time.monotonic() < until_s:
                self._record_more()
                time.sleep(0.02)
            self.with_upload += any(self.centre.staged())
            kind = self.random.choice(["nats-server", "dts-hub", "PostgreSQL", "dts-forward", "line"])
            self.count[kind] += 1
            self._kill(kind)
            if (number + 1) % 50 == 0:
                print(f"        {number + 1} kills, {len(self.known_whole)} files with receipts, all whole", flush=True)

    def _record_more(self) -> None:
        for clinic in self.clinics:
            if time.monotonic() < self._next_session_s[clinic.name]:
                continue
            self._next_session_s[clinic.name] = time.monotonic() + 0.5
            if clinic.is_recording() or len(clinic.undelivered()) > LARGEST_BACKLOG:
                continue
            seconds = self.random.uniform(0.5, 3.0)
            # Some have a label: the file that is sent then differs from the clinic's.
            label = ("--label", "baseline 2") if self.random.random() < 0.3 else ()
            clinic.record(seconds, "floor", "--subject", f"P{self.random.randrange(100):03}", *label)
            self._next_session_s[clinic.name] = time.monotonic() + seconds

    def _kill(self, kind: str) -> None:
        """Kills, checks what has a receipt now, and starts the victim again after a moment."""
        pause_s = self.random.choice([0.0, self.random.uniform(0, 0.5)])
        if kind == "line":
            clinic = self.random.choice(self.clinics)
            clinic.line.cut()
            self._check_receipts()
            time.sleep(pause_s)
            clinic.line.restore()
            return
        child = {"nats-server": self.centre.nats, "dts-hub": self.centre.hub, "PostgreSQL": self.centre.postgresql}.get(kind)
        if child is None:
            child = self.random.choice(self.clinics).forwarder
        if not child.is_alive():
            raise Failure(f"{child.name} ended by itself:\n{child.tail()}")
        # PostgreSQL: an immediate stop, which leaves the log as a crash does. Its processes all end.
        child.kill(signal.SIGQUIT if kind == "PostgreSQL" else signal.SIGKILL)
        self._check_receipts()
        time.sleep(pause_s)
        if kind == "PostgreSQL":
            self.centre.start_postgresql()
        else:
            child.start()

    def _check_receipts(self) -> None:
        """Every receipt that exists anywhere belongs to a whole file."""
        receipts = set(self.centre.receipts() or ())
        for clinic in self.clinics:
            receipts |= {(clinic.name, row["sha256"]) for row in clinic.sent() if row["receipt"]}
        for clinic_name, sha256 in receipts - self.known_whole:
            path = self.centre.object_path(clinic_name, sha256)
            if not path.exists() or sha256_of(path) != sha256:
                self.broken.append(f"{clinic_name}/{sha256}")
            else:
                self.known_whole.add((clinic_name, sha256))

    def finish(self) -> None:
        """Lets everything arrive and compares all that the parts know."""
        wait_until("the last sessions have ended", lambda: not any(clinic.is_recording() for clinic in self.clinics))
        for clinic in self.clinics:
            wait_until(f"all recordings of {clinic.name} have arrived", lambda one=clinic: not one.undelivered(), LAST_FILES_S)
        self._check_receipts()
        expect = self.checks.expect
        expect("no receipt, at any kill, without a whole file", not self.broken, self.broken)
        stated = {(clinic.name, row["sha256"]) for clinic in self.clinics for row in clinic.sent()}
        recorded = [(clinic.name, sha256) for clinic in self.clinics for sha256 in clinic.recorded()]
        masked = sum(row["sha256"] != row["recorded_sha256"] for clinic in self.clinics for row in clinic.sent())
        objects, parts, receipts = self.centre.objects(), self.centre.parts(), self.centre.receipts() or set()
        print(f"        {len(recorded)} recordings, {masked} of them sent with masked texts")
        expect("as many files as recordings", len(objects) == len(recorded), f"{len(objects)} and {len(recorded)}")
        expect("as many rows as recordings", len(parts) == len(recorded), f"{len(parts)} and {len(recorded)}")
        expect("as many receipts as recordings", len(receipts) == len(recorded), f"{len(receipts)} and {len(recorded)}")
        expect("files, rows and receipts have the SHA-256 that the forwarders state", set(objects) == set(parts) == receipts == stated)
        wrong = [f"{clinic}/{name}" for clinic, name in objects if sha256_of(self.centre.object_path(clinic, name)) != name]
        expect("every file has the SHA-256 of its name", not wrong, wrong)
        left = self.centre.staged()
        expect("nothing is left of unfinished uploads", not left, left)
        hub, forwarders = self.centre.hub.resident_kib(), [clinic.forwarder.resident_kib() for clinic in self.clinics]
        print(f"        memory: dts-hub {hub / 1024:.1f} MiB, dts-forward {max(forwarders) / 1024:.1f} MiB (bars: 40 and 25 MB)")
        self._print_resent(sum(self.centre.object_path(*one).stat().st_size for one in objects))

    def _print_resent(self, size: int) -> None:
        kills = self.count.total()
        sent = sum(clinic.line.sent_bytes for clinic in self.clinics)
        allowed = RESENT_SHARE * size + RESENT_A_KILL * kills
        print(f"        {size / 1e6:.1f} MB of files, {sent / 1e6:.1f} MB sent to the centre with TLS and all other messages: {sent / size:.2f} times")
        self.checks.expect(f"sent at most {RESENT_SHARE} x size + 4 MiB for each of {kills} kills", sent <= allowed, f"{sent} and {allowed:.0f}")


def kills_of(words: argparse.Namespace, checks: Checks) -> None:
    print(f"seed {words.seed}")
    begun_s = time.monotonic()
    centre = Centre()
    clinics: list[Clinic] = []
    is_good = False
    try:
        centre.start()
        for number, name in enumerate(("kent", "essex")):
            clinics.append(Clinic(centre, name, rigs=(LARGE_FLOOR,), seed=number + 1, bytes_per_s=RATE_BYTES_PER_S))
            clinics[-1].start()
        test = Kills(checks, centre, clinics, words.seed)
        test.run(words.kills)
        killed_s = time.monotonic() - begun_s
        test.finish()
        checks.expect("some files were on their way when something was killed", test.with_upload)
        print(f"        kills: {', '.join(f'{kind} {count}' for kind, count in sorted(test.count.items()))}; {test.with_upload} during an upload")
        print(f"        {killed_s:.0f} s of kills, {time.monotonic() - begun_s - killed_s:.0f} s for the rest to arrive and the comparison")
        is_good = not checks.failed
    finally:
        for clinic in clinics:
            clinic.close()
        centre.close(keep=not is_good)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    arguments = parser.parse_args()
    run_test(lambda checks: kills_of(arguments, checks))
