#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A week without a line, 1:330: four rigs record 30 MB while the line is cut, then it is back with 10 Mbit/s. Prints the share of the line
that was used, and how soon the facts of the newest session were at the centre. Not part of the suite: it measures time.

    offline.py

A week of two rigs with an hour a day is 10 GB, which takes 2.3 h at 10 Mbit/s with the same share."""
import json
import time

from centre import Centre
from checks import Checks, run_test
from child import wait_until
from clinic import Clinic

RATE_BYTES_PER_S = 10e6 / 8
SECONDS = 18.0
RIGS = tuple((f"floor{number}", "floor16-fast.toml", "sim:floor") for number in range(1, 5))


def offline(checks: Checks) -> None:
    centre = Centre()
    clinic = Clinic(centre, "kent", rigs=RIGS, bytes_per_s=RATE_BYTES_PER_S)
    try:
        centre.start()
        clinic.start()
        wait_until("the centre knows the clinic", lambda: centre.query("SELECT count(*) FROM beat") == "1")
        clinic.line.cut()
        for rig, _, _ in RIGS:
            clinic.record(SECONDS, rig)
        wait_until("the sessions have ended", lambda: len(clinic.recorded()) == len(RIGS), SECONDS + 60)
        size = sum(part["bytes"] for part in clinic.recorded().values())
        newest = clinic.record(SECONDS, RIGS[0][0])  # is recorded while the others are sent
        clinic.line.sent_bytes = 0
        clinic.line.restore()
        begun_s = time.monotonic()
        wait_until("the facts of the newest session are there", lambda: centre.query(f"SELECT count(*) FROM session WHERE id = '{newest}'") == "1")
        facts_s = time.monotonic() - begun_s
        wait_until("the recordings that waited have receipts", lambda: len(centre.receipts() or ()) >= len(RIGS), 300)
        elapsed_s = time.monotonic() - begun_s
        share = size / (RATE_BYTES_PER_S * elapsed_s)
        lost = sum(rig["lost_scans_total"] for rig in json.loads(clinic.dtsctl("status", "--json"))["rigs"])
        print(f"        {size / 1e6:.1f} MB in {elapsed_s:.1f} s of a line of 10 Mbit/s, from the moment when it was back; "
              f"{clinic.line.sent_bytes / size:.3f} times the bytes were sent")
        checks.expect(f"the files used {share:.0%} of the line (bar: 80 %)", share >= 0.8)
        checks.expect(f"the facts of the newest session arrived after {facts_s:.1f} s (bar: 5 s)", facts_s <= 5)
        checks.expect("no scan was lost at the rigs", lost == 0, lost)
    finally:
        clinic.close()
        centre.close()


if __name__ == "__main__":
    run_test(offline)
