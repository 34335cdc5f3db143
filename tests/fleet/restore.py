#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Loses a centre with its database and its store, and restores both from a backup by the steps of docs/fleet.md.

    restore.py [--keep]    --keep: keeps the folder with files and logs

The first recording is in the backup of both. The second arrives after the database was dumped, and is only among the copied files. The third
arrives after the backup, and is only in the clinic."""
import shutil
import sys

from centre import DATABASE, Centre, sha256_of
from checks import Checks, run_test
from child import postgresql, program, run, wait_until
from clinic import FLOOR, Clinic


def deliver(clinic: Clinic) -> None:
    clinic.record(1.0, "floor", "--subject", "P001")
    wait_until("the session has ended", lambda: not clinic.is_recording())
    wait_until("its recording has a receipt", lambda: clinic.recorded() and not clinic.undelivered())


def expect_whole(checks: Checks, centre: Centre, what: str, number: int) -> None:
    objects, parts, receipts = set(centre.objects()), set(centre.parts()), centre.receipts() or set()
    wrong = [name for clinic, name in objects if sha256_of(centre.object_path(clinic, name)) != name]
    checks.expect(f"{what}: {number} whole files, each with a row", len(objects) == number and objects == parts and not wrong,
                  f"{len(objects)} files, {len(parts)} rows, damaged: {wrong}")
    checks.expect(f"{what}: no receipt without a file", receipts <= objects, receipts - objects)


def restore(checks: Checks) -> None:
    centre = Centre()
    clinic = Clinic(centre, "kent", rigs=(FLOOR,))
    roles, dump, copied = (centre.folder / name for name in ("roles.sql", "dts_fleet.dump", "copied"))
    database = ("-h", centre.database_folder, "-U", "dts_admin")
    try:
        centre.start()
        clinic.start()
        deliver(clinic)
        run(postgresql("pg_dumpall") or "", *database, "--roles-only", "--file", roles)
        run(postgresql("pg_dump") or "", *database, "--format", "custom", "--file", dump, DATABASE)
        deliver(clinic)
        shutil.copytree(centre.store / "objects", copied)
        deliver(clinic)
        expect_whole(checks, centre, "before", 3)

        for child in (centre.hub, centre.nats, centre.postgresql):
            child.stop()
        shutil.rmtree(centre.database_folder)
        shutil.rmtree(centre.store)

        centre.start_empty_postgresql()
        run(postgresql("psql") or "", *database, "-d", "postgres", "--file", roles)  # one line fails: the administrator exists
        run(postgresql("createdb") or "", *database, "--owner", "dts_hub", DATABASE)
        run(postgresql("pg_restore") or "", *database, "--dbname", DATABASE, dump)
        centre.store.mkdir()
        shutil.copytree(copied, centre.store / "objects")
        run(program("dts-hub"), "rebuild", "--config", centre.config)
        expect_whole(checks, centre, "after dts-hub rebuild", 2)
        centre.fleet("users")
        centre.nats.start()
        centre.hub.start()
        clinic.forwarder.stop()
        clinic.forward("offer-again")
        clinic.forwarder.start()
        wait_until("every recording has a receipt again", lambda: not clinic.undelivered())
        expect_whole(checks, centre, "after the clinic offered everything again", 3)
        checks.expect("receipts and files are the same", centre.receipts() == set(centre.objects()))
    finally:
        clinic.close()
        centre.close(keep="--keep" in sys.argv)


if __name__ == "__main__":
    run_test(restore)
