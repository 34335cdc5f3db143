#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A centre of three machines, each with a nats-server and a hub, of which one after the other dies while a clinic uploads and is watched.

    cluster.py [--rounds 3] [--keep]

A machine dies: its nats-server and its hub are killed at the same moment. Nothing may be lost, and the live view must come back. Prints how
long it took."""
import argparse
import time

from centre import Centre, sha256_of
from checks import Checks, run_test
from child import program, run, wait_until
from clinic import LARGE_FLOOR, Clinic
from gateway import Gateway
from viewer import Viewer

MACHINES = 3
RATE_BYTES_PER_S = 500_000.0  # of the clinic's lines
TOPIC = "floor/cop"


class Cluster:
    def __init__(self, checks: Checks) -> None:
        self.checks = checks
        self.centre = Centre(machines=MACHINES)
        self.clinic = Clinic(self.centre, "kent", rigs=(LARGE_FLOOR,), bytes_per_s=RATE_BYTES_PER_S)
        self.gateway = Gateway(self.centre)
        self.with_upload = 0
        self.longest_s = 0.0

    def start(self) -> Viewer:
        self.centre.start()
        self.clinic.start()
        self.gateway.start()
        wait_until("the dashboard listens", self.gateway.address)
        viewer = Viewer(self.gateway.address() or "", self.clinic.name, TOPIC)
        wait_until("the live view has values", lambda: viewer.newest(TOPIC))
        return viewer

    def close(self, keep: bool) -> None:
        self.gateway.stop()
        self.clinic.close()
        self.centre.close(keep=keep)

    def lose_machine(self, number: int, viewer: Viewer) -> None:
        """Kills a machine during an upload, waits for the live view, and starts the machine again."""
        nats, hub = self.centre.nats_servers[number], self.centre.hubs[number]
        self.clinic.record(2.0, "floor", "--subject", f"P{number:03}")
        wait_until("an upload is under way", self.centre.staged)
        nats.send(9)
        hub.kill()
        nats.kill()
        killed_s = time.monotonic()
        self.with_upload += any(self.centre.staged())
        wait_until("the live view is back", lambda: viewer.blocks[-1].received_s > killed_s + 0.1 and viewer.blocks[-1].sampled_s > killed_s)
        nats.start()
        hub.start()
        wait_until("the recording has a receipt", lambda: not self.clinic.is_recording() and not self.clinic.undelivered())
        gap_s = longest_gap_s(viewer, killed_s)
        self.longest_s = max(self.longest_s, gap_s)
        print(f"        machine {number + 1} died: the live view stood still for {gap_s:.2f} s", flush=True)
        wait_until("the machine is part of the cluster again", lambda: "Server is ready" in nats.text().rpartition("Starting nats-server")[2])

    def compare(self) -> None:
        recorded = self.clinic.recorded()
        objects, parts, receipts = self.centre.objects(), self.centre.parts(), self.centre.receipts() or set()
        wrong = [name for clinic, name in objects if sha256_of(self.centre.object_path(clinic, name)) != name]
        self.checks.expect(f"{len(recorded)} recordings are {len(recorded)} whole files, rows and receipts",
                           len(recorded) == len(objects) == len(parts) == len(receipts) and not wrong, (objects, parts, receipts, wrong))
        self.checks.expect("a machine died while a file was on its way", self.with_upload)

    def revoke(self) -> None:
        """Each hub lets its own nats-server read the users again: the clinic is shut out everywhere."""
        run(program("dts-fleet"), "--config", self.centre.config, "clinic", "revoke", self.clinic.name)
        wait_until("dts-forward reports that its key is rejected", lambda: "reject" in self.clinic.problem())
        for number in range(1, MACHINES + 1):
            wait_until("the users of each nats-server have changed",
                       lambda one=number: self.clinic.public_key not in (self.centre.folder / f"users-{one}.conf").read_text())
        self.checks.expect("a revoked clinic is shut out of the whole cluster", True)


def longest_gap_s(viewer: Viewer, since_s: float) -> float:
    times = [block.received_s for block in viewer.blocks]
    return max((after - before for before, after in zip(times, times[1:], strict=False) if after > since_s), default=0.0)


def cluster(checks: Checks, rounds: int, keep: bool) -> None:
    test = Cluster(checks)
    try:
        viewer = test.start()
        for number in range(rounds):
            test.lose_machine(number % MACHINES, viewer)
        checks.expect(f"the live view was back each time (longest {test.longest_s:.2f} s, bar 3 s)", True)
        test.compare()
        test.revoke()
        viewer.close()
    finally:
        test.close(keep or checks.failed > 0)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=MACHINES)
    parser.add_argument("--keep", action="store_true")
    arguments = parser.parse_args()
    run_test(lambda checks: cluster(checks, arguments.rounds, arguments.keep))
