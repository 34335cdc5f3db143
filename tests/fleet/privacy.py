#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Puts a canary into every text and value of a session that a person enters, and searches all that leaves the clinic for it: the messages,
the files of the centre, the whole database, and the logs. A second clinic, which allows labels and one field, shows that the search finds
what is there. Then the subject is erased at the clinic.

    privacy.py [--keep]    --keep: keeps the folder with files and logs"""
import functools
import struct
import sys
import time
from collections.abc import Callable
from pathlib import Path

from centre import Centre
from checks import Checks, run_test
from child import wait_until
from clinic import FLOOR, Clinic
from nats_client import NatsClient, NKey
from watcher import Watcher

PROTOCOL = """\
name = "short"
title = "Short"
sentence = "Two short trials"
rig_kind = "floor"
[[field]]
name = "weight_kg"
label = "Body weight"
unit = "kg"
minimum = 10
maximum = 250
[[field]]
name = "code"
label = "Code of the clinic"
minimum = 0
maximum = 99999
[trials]
order = "as-listed"
trials_per_block = 2
blocks = 1
starts_by_itself = false
settle_s = 0.1
duration_s = 0.5
[[trials.condition]]
name = "eyes-open"
title = "Eyes open"
[[trials.condition]]
name = "eyes-closed"
title = "Eyes closed"
"""


STREAMS = ("cop",)
EVENTS = ("gap", "marker", "device", "session", "trigger", "trial", "reach", "class", "sway")  # topics of the events that dtsd publishes
HAPPENING = ("marker", "session", "trial")  # those of them that this test makes


def canaries_of(clinic: str) -> dict[str, str]:
    """Returns a word for everything that a person enters, by what it is. No two clinics have the same."""
    words = ["subject ID", "label", "corrected label", "notes", "marker", "second marker", "reason of a label", "reason of notes",
             "reason of an outcome", "reason of a deletion", "reason of a restoration"]
    canaries = {what: f"{clinic}canary{number:02}" for number, what in enumerate(words)}
    return canaries | {"weight_kg": f"7{1 + ord(clinic[0]) % 8}.51379", "code": f"6091{ord(clinic[0]) % 10}.28125"}


def forms_of(canary: str) -> list[bytes]:
    """Returns how a canary can look in bytes: text, and a number as a double."""
    forms = [canary.encode()]
    if canary[0].isdigit():
        forms += [struct.pack("<d", float(canary)), struct.pack(">d", float(canary))]
    return forms


def entered(canary: str) -> str:
    """Returns a text with a canary behind characters that XML and JSON escape."""
    return f'see "{canary}" é'


def record(clinic: Clinic, canary: dict[str, str], watch: Callable[[], None]) -> str:
    """Records a session with a canary in everything, and watches it meanwhile. Returns its ID."""
    watch()
    session = clinic.dtsctl("session", "start", "--rig", "floor", "--protocol", "short", "--subject", canary["subject ID"], "--label",
                            entered(canary["label"]), "--field", f"weight_kg={canary['weight_kg']}", "--field", f"code={canary['code']}").strip()
    watch()
    clinic.dtsctl("mark", entered(canary["marker"]), "--rig", "floor")
    for trial in (1, 2):
        watch()
        clinic.dtsctl("session", "trial", "next", "--rig", "floor")
        wait_until(f"trial {trial} is done", lambda number=trial: f'"last_trial": {number}' in clinic.dtsctl("status", "--json"))
    watch()
    clinic.dtsctl("mark", entered(canary["second marker"]), "--rig", "floor")
    clinic.dtsctl("session", "stop", "--rig", "floor")
    wait_until("the session is closed", lambda: not clinic.is_recording())
    clinic.dtsctl("session", "edit", session, "--label", entered(canary["corrected label"]), "--reason", canary["reason of a label"])
    clinic.dtsctl("session", "edit", session, "--notes", entered(canary["notes"]), "--reason", canary["reason of notes"])
    clinic.dtsctl("session", "edit", session, "--trial", "1", "--outcome", "rejected", "--reason", canary["reason of an outcome"])
    clinic.dtsctl("session", "delete", session, "--reason", canary["reason of a deletion"])
    clinic.dtsctl("session", "restore", session, "--reason", canary["reason of a restoration"])
    return session


class Places:
    """All that a canary could have reached."""

    def __init__(self, centre: Centre, clinics: list[Clinic]) -> None:
        self.centre = centre
        self.clinics = clinics
        self._watch = NatsClient(centre.nats_port, centre.folder / "ca.pem", NKey.of_file(centre.folder / "hub.nk"))
        for subject in ("up.>", "facts", "erase", "beat"):
            self._watch.subscribe(f"dts.v1.*.{subject}")
        self._watch.wait_for_server()
        self._viewer = Watcher(centre)
        self._letters: list[tuple[str, bytes]] = []

    def watch(self, clinic: Clinic) -> None:
        """Asks for everything that can be watched at a clinic, for the next 10 s."""
        self._viewer.ask(clinic.name, [*(f"floor/{name}" for name in STREAMS + EVENTS), "dtsd/status"])

    def can_watch(self, clinic: Clinic) -> bool:
        self.watch(clinic)
        time.sleep(0.2)
        return self.seen(clinic, "floor.cop")

    def letters(self) -> list[tuple[str, bytes]]:
        """Returns subject and content of all messages so far."""
        while not self._watch.letters.empty():
            letter = self._watch.letters.get()
            self._letters.append((letter.subject, letter.data))
        self._letters += [(letter.subject, letter.data) for letter in self._viewer.letters()]
        return self._letters

    def seen(self, clinic: Clinic, topic: str) -> bool:
        return any(subject == f"dts.v1.{clinic.name}.live.{topic}" for subject, _ in self.letters())

    def all(self) -> dict[str, bytes]:
        files = sorted(self.centre.store.rglob("*"))
        return {
            "messages": b"\n".join(subject.encode() + b" " + data for subject, data in self.letters()),
            "files": b"\n".join(str(path).encode() + b"\n" + path.read_bytes() for path in files if path.is_file()),
            "database": self.centre.dump().encode(),
            "logs": "\n".join(child.text() for child in (self.centre.hub, self.centre.nats, self.centre.postgresql,
                                                         *(clinic.forwarder for clinic in self.clinics))).encode(),
        }


def found(canary: str, places: dict[str, bytes]) -> list[str]:
    return [name for name, data in places.items() if any(form in data for form in forms_of(canary))]


def has_arrived(clinic: Clinic, session: str) -> bool:
    """The file has a receipt, and the newest facts are there: the last change at the clinic was the outcome of a trial."""
    where = f"clinic = '{clinic.name}' AND session = '{session}'"
    return (clinic.centre.query(f"SELECT count(*) FROM receipt WHERE {where}") == "1"
            and clinic.centre.query(f"SELECT count(*) FROM trial WHERE {where} AND outcome = 'rejected'") == "1")


def expect_masked(checks: Checks, clinic: Clinic) -> None:
    """What was sent is the recording, with the same length, and '#' where it differs."""
    for row in clinic.sent():
        sent = clinic.centre.object_path(clinic.name, row["sha256"]).read_bytes()
        recorded = Path(clinic.recorded()[row["recorded_sha256"]]["file"]).read_bytes()
        differing = [a for a, b in zip(sent, recorded) if a != b]
        checks.expect(f"the file of {clinic.name} has the length of the recording", len(sent) == len(recorded))
        clinic.dtsctl("session", "verify", str(clinic.centre.object_path(clinic.name, row["sha256"])))  # raises Failure if it cannot be read
        checks.expect("  and differs by '#' only", differing and set(differing) == {ord("#")}, sorted(set(differing)))


def expect_erased(checks: Checks, clinic: Clinic, session: str, subject: str) -> None:
    name = clinic.name
    clinic.dtsctl("subject", "erase", subject, "--yes")
    where = f"clinic = '{name}' AND session = '{session}'"
    wait_until("the centre has erased the session", lambda: clinic.centre.query(f"SELECT count(*) FROM session WHERE clinic = '{name}'") == "0")
    rows = clinic.centre.query(f"SELECT (SELECT count(*) FROM part WHERE {where}) + (SELECT count(*) FROM trial WHERE {where})")
    checks.expect(f"after the erasure at {name}, no row of the session is at the centre", rows == "0", rows)
    files = [one for one in clinic.centre.objects() if one[0] == name]
    checks.expect("  and no file", not files, files)
    dump = clinic.centre.dump()
    checks.expect("  and the database has the subject ID nowhere", subject not in dump)


def privacy(checks: Checks) -> None:
    centre = Centre()
    clinics: list[Clinic] = []
    try:
        centre.start()
        clinics.append(Clinic(centre, "kent", rigs=(FLOOR,), seed=1))
        clinics.append(Clinic(centre, "essex", rigs=(FLOOR,), seed=2, settings='[privacy]\nsend_labels = true\nsend_fields = ["weight_kg"]\n'))
        # Not earlier: nats-server ends connections that begin while it reads its users again.
        wait_until("nats-server has read the users of dts-hub", lambda: "Reloaded server configuration" in centre.nats.text())
        places = Places(centre, clinics)
        for clinic in clinics:
            clinic.protocols["short"] = PROTOCOL
            clinic.start()
        kent, essex = clinics
        canaries = {clinic.name: canaries_of(clinic.name) for clinic in clinics}
        for clinic in clinics:
            wait_until(f"{clinic.name} can be watched", lambda one=clinic: places.can_watch(one))
        sessions = {clinic.name: record(clinic, canaries[clinic.name], functools.partial(places.watch, clinic)) for clinic in clinics}
        for clinic in clinics:
            wait_until(f"the session of {clinic.name} has arrived", lambda one=clinic: has_arrived(one, sessions[one.name]))
        everywhere = places.all()
        for clinic in clinics:
            for topic in ("dtsd.status", *(f"floor.{name}" for name in STREAMS + HAPPENING)):
                checks.expect(f"{topic} of {clinic.name} was watched meanwhile", places.seen(clinic, topic))
        for what, canary in canaries["kent"].items():
            reached = found(canary, everywhere)
            if what == "subject ID":
                checks.expect("the subject ID of kent reached the database", "database" in reached, reached)
                checks.expect("  but no log, and no subject of a message", "logs" not in reached
                              and not any(canary in subject for subject, _ in places.letters()), reached)
            else:
                checks.expect(f"the {what} of kent did not leave the clinic", not reached, reached)
        sent = {"label", "corrected label", "notes", "marker", "second marker", "weight_kg"}
        for what, canary in canaries["essex"].items():
            if what == "subject ID":
                continue
            reached = found(canary, everywhere)
            if what in sent:
                checks.expect(f"the {what} of essex, which allows it, reached the centre", "messages" in reached, reached)
            else:
                checks.expect(f"the {what} of essex did not leave the clinic", not reached, reached)
        expect_masked(checks, kent)
        expect_erased(checks, kent, sessions["kent"], canaries["kent"]["subject ID"])
    finally:
        for clinic in clinics:
            clinic.close()
        centre.close(keep="--keep" in sys.argv)


if __name__ == "__main__":
    run_test(privacy)
