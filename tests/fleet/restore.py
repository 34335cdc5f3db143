#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Loses a centre with its database and its store, and restores both from a backup by the steps of docs/fleet.md.

    restore.py [--keep]    --keep: keeps the folder with files and logs

Subjects P001, P002 and P003 stay. The recording of P001 is in the backup of database and files. That of P002 arrives after the database was
dumped, and is only among the copied files. That of P003 arrives after the backup, and is only in the clinic.

Subjects P011, P012 and P013 are in the dump, and are erased: P011 after the dump, P012 after the copy of the files, P013 after the copy of the
journal of erasures. The first two stay away. The third comes back, and leaves when the clinic repeats its erasures."""
import shutil
import sys

from centre import DATABASE, Centre, sha256_of
from checks import Checks, run_test
from child import postgresql, program, run, wait_until
from clinic import FLOOR, Clinic


def deliver(clinic: Clinic, subject: str) -> None:
    clinic.record(1.0, "floor", "--subject", subject)
    wait_until("the session has ended", lambda: not clinic.is_recording())
    wait_until("its recording has a receipt", lambda: clinic.recorded() and not clinic.undelivered())


def erase(centre: Centre, clinic: Clinic, subject: str) -> None:
    clinic.dtsctl("subject", "erase", subject, "--yes")
    wait_until("the centre has erased it", lambda: subject not in subjects(centre))


def subjects(centre: Centre) -> list[str]:
    """Returns the subjects of the sessions that the centre has, in order."""
    return centre.query("SELECT subject FROM session ORDER BY subject").split()


def expect_erased(checks: Checks, centre: Centre, clinic: Clinic, what: str, sessions: list[str]) -> None:
    """No row and no file of these sessions."""
    names = ", ".join(f"'{session}'" for session in sessions)
    left = centre.query("SELECT " + " + ".join(f"(SELECT count(*) FROM {table} WHERE session IN ({names}))"
                                               for table in ("part", "trial", "result", "receipt")))
    checks.expect(f"{what}: no row of {len(sessions)} erased sessions", left == "0", left)
    known = centre.query(f"SELECT count(*) FROM erased WHERE session IN ({names})")
    checks.expect("  they are remembered", known == str(len(sessions)), known)
    listed = {row["session"] for row in centre.fleet_lines("sessions", "--clinic", clinic.name)}
    checks.expect("  and in no list", not listed & set(sessions), listed)


def expect_whole(checks: Checks, centre: Centre, what: str, number: int) -> None:
    objects, parts, receipts = set(centre.objects()), set(centre.parts()), centre.receipts() or set()
    wrong = [name for clinic, name in objects if sha256_of(centre.object_path(clinic, name)) != name]
    checks.expect(f"{what}: {number} whole files, each with a row", len(objects) == number and objects == parts and not wrong,
                  f"{len(objects)} files, {len(parts)} rows, damaged: {wrong}")
    checks.expect(f"{what}: no receipt without a file", receipts <= objects, receipts - objects)


def restore(checks: Checks) -> None:
    centre = Centre()
    clinic = Clinic(centre, "kent", rigs=(FLOOR,))
    roles, dump, copied, journal = (centre.folder / name for name in ("roles.sql", "dts_fleet.dump", "copied", "erased"))
    database = ("-h", centre.database_folder, "-U", "dts_admin")
    try:
        centre.start()
        clinic.start()
        for subject in ("P001", "P011", "P012", "P013"):
            deliver(clinic, subject)
        wait_until("the facts have arrived", lambda: len(subjects(centre)) == 4)
        session_of = dict(line.split("|") for line in centre.query("SELECT subject, id FROM session").splitlines())
        run(postgresql("pg_dumpall") or "", *database, "--roles-only", "--file", roles)
        run(postgresql("pg_dump") or "", *database, "--format", "custom", "--file", dump, DATABASE)
        erase(centre, clinic, "P011")
        deliver(clinic, "P002")
        shutil.copytree(centre.store / "objects", copied)
        erase(centre, clinic, "P012")
        shutil.copyfile(centre.store / "erased", journal)
        erase(centre, clinic, "P013")
        deliver(clinic, "P003")
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
        shutil.copyfile(journal, centre.store / "erased")
        print("        " + run(program("dts-hub"), "rebuild", "--config", centre.config).strip().replace("\n", "\n        "))
        expect_whole(checks, centre, "after dts-hub rebuild", 3)  # of P001, P002 and P013
        expect_erased(checks, centre, clinic, "  of P011 and P012", [session_of["P011"], session_of["P012"]])
        checks.expect("  P013 is back: its erasure is newer than the journal", subjects(centre) == ["P001", "P002", "P013"], subjects(centre))
        centre.fleet("users")
        centre.nats.start()
        centre.hub.start()
        clinic.forwarder.stop()
        clinic.forward("offer-again")
        clinic.forwarder.start()
        wait_until("every recording has a receipt again", lambda: not clinic.undelivered())
        wait_until("the clinic has repeated its erasures", lambda: subjects(centre) == ["P001", "P002", "P003"])
        expect_whole(checks, centre, "after the clinic offered everything again", 3)
        checks.expect("receipts and files are the same", centre.receipts() == set(centre.objects()))
        expect_erased(checks, centre, clinic, "at the end", [session_of[subject] for subject in ("P011", "P012", "P013")])
    finally:
        clinic.close()
        centre.close(keep="--keep" in sys.argv)


if __name__ == "__main__":
    run_test(restore)
