#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A centre whose store is a bucket, over TLS, in a small S3 that answers wrongly when a test wants it.

    s3.py [--keep]"""
import os
import sys

from centre import Centre, sha256_of
from checks import Checks, run_test
from child import REPOSITORY, Child, Failure, free_port, program, run, wait_until
from clinic import FLOOR, Clinic

SERVER = REPOSITORY / "tests/support/s3_server.py"


class S3:
    """tests/support/s3_server.py beside a centre, with the certificate of its nats-server."""

    def __init__(self) -> None:
        self.port = free_port()
        self.centre = Centre(f"""\
[store.s3]
endpoint = "https://127.0.0.1:{self.port}"
bucket = "recordings"
region = "eu-test-1"
credentials = "s3.keys"
ca = "ca.pem"
""")
        self.folder = self.centre.folder / "s3"
        self.folder.mkdir()
        keys = self.centre.folder / "s3.keys"
        keys.touch(0o600)
        keys.write_text("tester\na-secret+of/tests\n")
        self.server = Child("the S3", ["/usr/bin/python3", "-B", SERVER, self.folder, self.centre.folder / "nats.pem",
                                       self.centre.folder / "nats.key"], self.centre.folder / "s3.log",
                            env=os.environ | {"S3_PORT": str(self.port)})

    def set_fault(self, fault: str) -> None:
        (self.folder / "fault.new").write_text(fault)
        (self.folder / "fault.new").rename(self.folder / "fault")

    def requests(self) -> str:
        return (self.folder / "requests").read_text()

    def objects(self) -> dict[str, str]:
        """Returns the SHA-256 of the content for each recording, by the SHA-256 in its key."""
        return {path.name.rpartition("%")[2]: sha256_of(path) for path in self.folder.glob("objects/*") if not path.suffix}


def record(clinic: Clinic, subject: str) -> None:
    clinic.record(1.0, "floor", "--subject", subject)
    wait_until("the session has ended", lambda: not clinic.is_recording())


def expect_sound(checks: Checks, s3: S3, what: str, number: int) -> None:
    objects, receipts = s3.objects(), {sha256 for _, sha256 in s3.centre.receipts() or ()}
    checks.expect(f"{what}: {number} receipts, each with a whole object",
                  len(receipts) == number and all(objects.get(name) == name for name in receipts), (objects, receipts))


def faults(checks: Checks, s3: S3, clinic: Clinic) -> None:
    """While S3 does not do its part, the hub answers "later", and says why in its log."""
    record(clinic, "P001")  # S3 does not run yet
    wait_until("dts-forward reports that the store does not answer", lambda: "store" in clinic.problem())
    expect_sound(checks, s3, "without S3", 0)
    s3.server.start()
    wait_until("the recording has a receipt", lambda: not clinic.undelivered())
    expect_sound(checks, s3, "with S3", 1)
    for number, (fault, words) in enumerate((("PUT 403", "answers 403"), ("PUT lost", "no object"), ("HEAD 500", "answers 500")), start=2):
        s3.set_fault(fault)
        before = len(s3.centre.hub.text())
        record(clinic, f"P{number:03}")
        wait_until(f"the log of the hub has '{words}'", lambda text=words, begin=before: text in s3.centre.hub.text()[begin:])
        expect_sound(checks, s3, fault, number - 1)
        s3.set_fault("")
        wait_until("the recording has a receipt", lambda: not clinic.undelivered())
        expect_sound(checks, s3, f"after {fault}", number)


def kills(checks: Checks, s3: S3, clinic: Clinic, number: int) -> None:
    """The hub is killed while it waits for S3."""
    for method, fault, words in (("PUT", "PUT silence", ("PUT /",)), ("HEAD", "HEAD stored-silence", ("PUT /", "HEAD /"))):
        s3.set_fault(fault)
        begin = len(s3.requests())
        record(clinic, f"K{number:03}")
        wait_until(f"the hub has asked S3 for {method}", lambda wanted=words, at=begin: has_in_order(s3.requests()[at:], wanted))
        s3.centre.hub.kill()
        expect_sound(checks, s3, f"killed during {method}", number)
        s3.set_fault("")
        s3.centre.hub.start()
        wait_until("the recording has a receipt", lambda: not clinic.undelivered())
        number += 1
        expect_sound(checks, s3, "started again", number)


def has_in_order(text: str, words: tuple[str, ...]) -> bool:
    """Returns whether the text has all words, each behind the one before."""
    for word in words:
        found, text = text.partition(word)[1:]
        if not found:
            return False
    return True


def worker(checks: Checks, s3: S3) -> None:
    s3.centre.start_worker()
    s3.centre.fleet("jobs", "add", "--kind", "replay")
    wait_until("all jobs are done", lambda: s3.centre.query("SELECT count(*) FROM job WHERE state IN ('waiting', 'running')") == "0")
    checks.expect("a worker reads recordings from S3", s3.centre.query("SELECT bool_and(state = 'done') FROM job") == "t",
                  s3.centre.query("SELECT message FROM job"))


def erase(checks: Checks, s3: S3, clinic: Clinic, number: int) -> None:
    """An erasure at the clinic, then one at the centre."""
    clinic.dtsctl("subject", "erase", "P001", "--yes")
    wait_until("the object of the erased subject is gone", lambda: len(s3.objects()) == number - 1)
    expect_sound(checks, s3, "after an erasure", number - 1)
    sha256 = sorted(s3.objects())[0]
    session = s3.centre.query(f"SELECT session FROM receipt WHERE sha256 = '\\x{sha256}'")
    erased = s3.centre.fleet("session", "erase", clinic.name, session, "--yes")
    checks.expect("dts-fleet session erase removes the object", "with 1 recording" in erased and sha256 not in s3.objects(), erased)
    expect_sound(checks, s3, "after an erasure at the centre", number - 2)


def rebuild(checks: Checks, s3: S3, number: int) -> None:
    s3.centre.hub.stop()
    s3.centre.query("DELETE FROM job; DELETE FROM receipt; DELETE FROM part; DELETE FROM session")
    run(program("dts-hub"), "rebuild", "--config", s3.centre.config)
    expect_sound(checks, s3, "after dts-hub rebuild", number)


def other_authority(checks: Checks, s3: S3) -> None:
    """Nothing is sent to a server whose certificate another authority has signed."""
    config = s3.centre.folder / "hub-without-ca.toml"
    config.write_text(s3.centre.config.read_text().rpartition("ca = ")[0])
    begin = len(s3.requests())
    try:
        reason = run(program("dts-hub"), "rebuild", "--config", config)
    except Failure as failure:
        reason = str(failure)
    checks.expect("a server with a certificate of another authority gets no request",
                  "certificate" in reason and len(s3.requests()) == begin, reason)


def with_s3(checks: Checks, keep: bool) -> None:
    s3 = S3()
    clinic = Clinic(s3.centre, "kent", rigs=(FLOOR,))
    try:
        s3.centre.start()
        clinic.start()
        faults(checks, s3, clinic)
        kills(checks, s3, clinic, 4)
        worker(checks, s3)
        erase(checks, s3, clinic, 6)
        rebuild(checks, s3, 4)
        other_authority(checks, s3)
    finally:
        clinic.close()
        s3.server.stop()
        s3.centre.close(keep or checks.failed > 0)


if __name__ == "__main__":
    run_test(lambda checks: with_s3(checks, "--keep" in sys.argv))
