#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cuts the power of the hub's machine at random moments, by a model: dts-hub is killed, and its store becomes what it had synchronised, with
some of what it had not. Some kills take no power. Checks that no receipt is without its whole file.

    power_cut.py [--cuts 10] [--seed N]

The model is harsh: a name in a folder is there after the cut only if the folder was synchronised, or by chance; of bytes that were not
synchronised, each 4 KiB are there or not by chance. PostgreSQL has a model of its own (synchronous_commit) and is killed, not cut."""
import argparse
import os
import random
import shutil
import signal
import time
from pathlib import Path

from centre import Centre, sha256_of
from checks import Checks, run_test
from child import PROGRAMS, Failure, wait_until
from clinic import LARGE_FLOOR, Clinic

PAGE = 4096
LIBRARY = Path(os.environ.get("DTS_SYNCHRONISED_LIBRARY", PROGRAMS.parent / "tests/libdts_synchronised.so"))


class Disk:
    """The store of a hub, and the copies of what it has synchronised."""

    def __init__(self, store: Path, copies: Path, chance: random.Random) -> None:
        self.store = store
        self.copies = copies
        self.random = chance
        self.kept_share = 0.5  # of what was not synchronised
        self.lost = 0  # files and bytes that a cut took, counted as occasions

    def cut(self) -> None:
        """Replaces the store by what is left of it."""
        left = self.store.with_name("left")
        left.mkdir()
        self._keep_folder(self.store, left)
        shutil.rmtree(self.store)
        left.rename(self.store)
        # The files have new inodes: they are on the disk now, as the copies were.
        shutil.rmtree(self.copies)
        self.copies.mkdir()
        for path in [self.store, *self.store.rglob("*")]:
            inode = path.stat().st_ino
            if path.is_dir():
                (self.copies / f"names-{inode}").write_text("".join(f"{one.stat().st_ino} {one.name}\n" for one in path.iterdir()))
            else:
                shutil.copyfile(path, self.copies / f"data-{inode}")

    def _keep_folder(self, folder: Path, left: Path) -> None:
        current = {path.name: path for path in folder.iterdir()}
        by_inode = {path.stat().st_ino: path for path in self.store.rglob("*")}
        names = self.copies / f"names-{folder.stat().st_ino}"
        durable = dict(reversed(line.split(" ", 1)) for line in names.read_text().splitlines()) if names.exists() else {}
        for name in sorted(current.keys() | durable.keys()):
            is_same = name in current and durable.get(name) == str(current[name].stat().st_ino)
            if is_same or self.random.random() < self.kept_share:  # by chance as it is now
                source = current.get(name)
            else:
                source = by_inode.get(int(durable[name])) if name in durable else None
                self.lost += 1
            if source is None:
                continue
            if source.is_dir():
                (left / name).mkdir(exist_ok=True)
                self._keep_folder(source, left / name)
            else:
                (left / name).write_bytes(self._bytes_left(source))

    def _bytes_left(self, path: Path) -> bytes:
        current = path.read_bytes()
        copy = self.copies / f"data-{path.stat().st_ino}"
        durable = copy.read_bytes() if copy.exists() else b""
        if current == durable:
            return current
        self.lost += 1
        size = self.random.choice([len(current), len(durable), self.random.randint(0, len(current))]) if self.kept_share else len(durable)
        pages = []
        for offset in range(0, size, PAGE):
            page = (current if self.random.random() < self.kept_share else durable)[offset:offset + PAGE]
            pages.append(page.ljust(PAGE, b"\0"))
        return b"".join(pages)[:size]


def size_of(path: Path) -> int:
    """-1: the hub has moved it meanwhile."""
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return -1


def wait_for_upload(clinic: Clinic, share: float) -> None:
    """Waits until this share of a file has arrived, or all of it."""
    centre = clinic.centre

    def has_arrived() -> bool:
        waiting = clinic.undelivered()
        if not waiting:
            return not clinic.is_recording()
        largest = max(part["bytes"] for part in clinic.recorded().values() if part["sha256"] in waiting)
        return any(size_of(path) >= share * largest for path in centre.staged() if path.suffix == ".part")

    wait_until(f"{share:.0%} of a file has arrived", has_arrived)


def expect_name_is_kept(checks: Checks, disk: Disk, clinic: Clinic) -> None:
    """dts-hub dies after it has moved a file into the folder of recordings, and before it has synchronised that folder. The next one finds
    the file there and sends the receipt. Then the power fails, and takes all that was not synchronised."""
    centre = clinic.centre
    centre.hub.kill()
    centre.hub.add_environment({"DTS_POWER_DIE": str(centre.store / "objects" / clinic.name)})
    centre.hub.start()
    clinic.record(0.5, "floor", "--subject", "P001")
    wait_until("dts-hub has died before it synchronised the folder", lambda: not centre.hub.is_alive())
    centre.hub.add_environment({"DTS_POWER_DIE": ""})
    centre.hub.start()
    wait_until("the recording has a receipt", lambda: not clinic.is_recording() and not clinic.undelivered())
    centre.hub.kill()
    disk.kept_share = 0.0
    disk.cut()
    lost = [pair for pair in centre.receipts() or () if not centre.object_path(*pair).exists()]
    checks.expect("a receipt of a file that an earlier hub moved outlives a power cut", not lost, lost)


def expect_erasures_are_kept(checks: Checks, disk: Disk, clinic: Clinic) -> None:
    """Each erasure that the database has is in the journal, also if the power fails at once and takes all that was not synchronised."""
    centre = clinic.centre
    centre.hub.start()
    clinic.dtsctl("subject", "erase", "P001", "--yes")
    wait_until("the centre has erased a session", lambda: centre.query("SELECT count(*) FROM erased") != "0")
    centre.hub.kill()
    disk.cut()
    journal = centre.store / "erased"
    written = journal.read_text().split() if journal.exists() else []
    lost = [session for session in centre.query("SELECT session FROM erased").split() if session not in written]
    checks.expect("the journal of erasures outlives a power cut", not lost, lost)


def power_cuts(words: argparse.Namespace, checks: Checks) -> None:
    if not LIBRARY.exists():
        raise Failure(f"{LIBRARY} is not built: ninja -C build/release dts_synchronised")
    print(f"seed {words.seed}")
    chance = random.Random(words.seed)
    centre = Centre()
    copies = centre.folder / "copies"
    copies.mkdir()
    centre.hub.add_environment({"LD_PRELOAD": str(LIBRARY), "DTS_POWER_ROOT": str(centre.store), "DTS_POWER_COPY": str(copies)})
    disk = Disk(centre.store, copies, chance)
    clinic = Clinic(centre, "kent", rigs=(LARGE_FLOOR,), bytes_per_s=500_000.0)
    broken: set[str] = set()
    during = 0
    is_good = False
    try:
        centre.start()
        clinic.start()
        for _ in range(words.cuts):
            if not clinic.undelivered() and not clinic.is_recording():
                clinic.record(chance.uniform(2.0, 4.0), "floor", "--subject", "P001")
            # Half of the cuts are near the commit, when the file is whole and its row and receipt are being made.
            wait_for_upload(clinic, chance.choice([chance.random(), 1.0]))
            time.sleep(chance.choice([0.0, 0.01, 0.03]) * chance.random())
            during += any(centre.staged())
            centre.hub.kill()
            if chance.random() < 0.3:
                centre.postgresql.kill(signal.SIGQUIT)
                centre.start_postgresql()
            if chance.random() < 0.7:
                disk.cut()
            # Otherwise only the program dies: what it had not synchronised is there now, and gone with a later cut.
            for name, sha256 in centre.receipts() or ():
                path = centre.object_path(name, sha256)
                if not path.exists() or sha256_of(path) != sha256:
                    broken.add(f"{name}/{sha256}")
            centre.hub.start()
        wait_until("the last session has ended", lambda: not clinic.is_recording())
        wait_until("all recordings have arrived", lambda: not clinic.undelivered(), 600)
        checks.expect(f"no receipt without its whole file after any of {words.cuts} power cuts", not broken, sorted(broken))
        checks.expect("files, rows and receipts are the same",
                      set(centre.objects()) == set(centre.parts()) == centre.receipts() and len(centre.objects()) == len(clinic.recorded()))
        recordings = len(centre.objects())
        expect_name_is_kept(checks, disk, clinic)
        expect_erasures_are_kept(checks, disk, clinic)
        checks.expect("the cuts took something away", disk.lost)
        is_good = not checks.failed
        print(f"        {recordings} recordings; {during} cuts during an upload; {disk.lost} names or files that were not synchronised")
    finally:
        clinic.close()
        centre.close(keep=not is_good)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cuts", type=int, default=10)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(10**6))
    arguments = parser.parse_args()
    run_test(lambda checks: power_cuts(arguments, checks))
