#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A centre of three machines, each with a nats-server and a hub. The one that receives an upload dies, while a clinic is watched.

    cluster.py [--rounds 3] [--keep]

A machine dies: its nats-server and its hub are killed at the same moment. Nothing may be lost, and the live view must come back. Prints how
long it took."""
import argparse
import signal
import time

from centre import Centre, sha256_of
from checks import Checks, run_test
from child import PATIENCE_S, program, run, wait_until
from clinic import LARGE_FLOOR, Clinic
from gateway import Gateway
from viewer import Viewer

MACHINES = 3
RATE_BYTES_PER_S = 500_000.0  # of the clinic's lines
TOPIC = "floor/cop"
BAR_S = 3.0  # within which the live view is back


class Cluster:
    def __init__(self, checks: Checks) -> None:
        self.checks = checks
        self.centre = Centre(machines=MACHINES)
        self.clinic = Clinic(self.centre, "kent", rigs=(LARGE_FLOOR,), bytes_per_s=RATE_BYTES_PER_S)
        self.gateway = Gateway(self.centre)
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

    def stop_hub_with_upload(self) -> int:
        """Records until a hub stands still that has an upload which is not whole. Returns the number of its machine, from 0."""
        while True:
            before = set(self.centre.staged())
            self.clinic.record(2.0, "floor", "--subject", f"P{len(self.clinic.recorded()):03}")
            wait_until("an upload is under way, or was faster",
                       lambda old=before: set(self.centre.staged()) - old or (not self.clinic.is_recording() and not self.clinic.undelivered()))
            path = next(iter(set(self.centre.staged()) - before), None)
            if path is None:  # it was faster
                continue
            number = int(path.relative_to(self.centre.store / "staging").parts[0].removeprefix("hub-")) - 1
            self.centre.hubs[number].send(signal.SIGSTOP)
            if path.exists():
                return number
            self.centre.hubs[number].send(signal.SIGCONT)
            wait_until("the recording has a receipt", lambda: not self.clinic.is_recording() and not self.clinic.undelivered())

    def lose_machine(self, viewer: Viewer) -> None:
        """Kills a machine during an upload, waits for the live view, and starts the machine again."""
        number = self.stop_hub_with_upload()
        nats, hub = self.centre.nats_servers[number], self.centre.hubs[number]
        nats.send(signal.SIGKILL)
        hub.kill()
        nats.kill()
        killed_s = time.monotonic()
        wait_until("the live view is back", lambda: viewer.blocks[-1].received_s > killed_s + 0.1 and viewer.blocks[-1].sampled_s > killed_s)
        nats.start()
        hub.start()
        wait_until("the recording has a receipt", lambda: not self.clinic.is_recording() and not self.clinic.undelivered())
        gap_s = longest_gap_s(viewer, killed_s)
        self.longest_s = max(self.longest_s, gap_s)
        print(f"        machine {number + 1} died: the live view stood still for {gap_s:.2f} s", flush=True)
        wait_until("the machine is part of the cluster again", lambda: "Server is ready" in nats.text().rpartition("Starting nats-server")[2])

    def compare(self) -> None:
        recorded, sent = set(self.clinic.recorded()), {row["sha256"] for row in self.clinic.sent()}
        objects, parts, receipts = ({sha256 for _, sha256 in found} for found in (self.centre.objects(), self.centre.parts(),
                                                                                  self.centre.receipts() or ()))
        wrong = [name for clinic, name in self.centre.objects() if sha256_of(self.centre.object_path(clinic, name)) != name]
        self.checks.expect(f"the clinic has sent its {len(recorded)} recordings",
                           recorded and recorded == {row["recorded_sha256"] for row in self.clinic.sent()}, (recorded, self.clinic.sent()))
        self.checks.expect("each that was sent is a whole file, a row and a receipt", sent == objects == parts == receipts and not wrong,
                           (sent, objects, parts, receipts, wrong))

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
        for _ in range(rounds):
            test.lose_machine(viewer)
        checks.expect(f"the live view was back each time (longest {test.longest_s:.2f} s, bar {BAR_S:g} s on an idle machine)",
                      0 < test.longest_s <= PATIENCE_S)
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
