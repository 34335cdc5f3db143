#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The dashboard of a centre in a real browser, with a clinic whose line fails.

    dashboard.py    needs node, Chromium and the built dashboard; dashboard.mjs is what the person at the browser does"""
import json
import os
import shutil
import subprocess
import sys
import threading

from centre import Centre
from checks import SKIPPED, Checks, run_test
from child import PROGRAMS, REPOSITORY, wait_until
from clinic import Clinic
from gateway import WEB_ROOT, Gateway

PROTOCOL = """\
name = "standing"
title = "Standing"
sentence = "Standing still for 4 s"
rig_kind = "floor"
[trials]
order = "as-listed"
trials_per_block = 1
blocks = 1
starts_by_itself = true
settle_s = 0.5
duration_s = 4
[[trials.condition]]
name = "eyes-open"
title = "Eyes open"
"""
BROWSER_S = 300.0


def stands(clinic: Clinic) -> bool:
    """Returns true if there is a centre of pressure."""
    block = json.loads(clinic.dtsctl("watch", "floor/cop", "--count", "1", "--jsonl").splitlines()[0])
    return block["values"][0][0] is not None


def trials_of(clinic: Clinic, session: str) -> list[dict]:
    return json.loads(clinic.dtsctl("session", "show", session, "--json")).get("trials", [])


def examine(clinic: Clinic) -> str:
    """Records a session with one valid trial. The first attempts may have a fault: the person has just stepped on the plate."""
    session = clinic.dtsctl("session", "start", "--rig", "floor", "--protocol", "standing", "--subject", "P017").strip()
    for attempt, action in enumerate(("next", "redo", "redo", "redo"), start=1):
        clinic.dtsctl("session", "trial", action, "--rig", "floor")
        wait_until("the trial has its values",
                   lambda count=attempt: len(trials_of(clinic, session)) >= count and "sway" in trials_of(clinic, session)[-1])
        if not trials_of(clinic, session)[-1].get("fault"):
            break
    clinic.dtsctl("session", "stop", "--rig", "floor")
    return session


def dashboard(checks: Checks) -> None:
    centre = Centre()
    gateway = Gateway(centre)
    kent = Clinic(centre, "kent")
    kent.protocols["standing"] = PROTOCOL
    try:
        centre.start()
        kent.start("Kent and Canterbury")
        gateway.start()
        wait_until("the dashboard listens", gateway.address)
        wait_until("the simulated person stands on the plate", lambda: stands(kent))
        session = examine(kent)
        wait_until("the recording has a receipt", centre.receipts)
        wait_until("the results are at the centre", lambda: "MVELO" in centre.query("SELECT string_agg(name, ' ') FROM result"))
        browse(checks, kent, gateway.address() or "", session)
        gateway.expect_alive()
    finally:
        gateway.stop()
        kent.close()
        centre.close(keep=checks.failed > 0)


def browse(checks: Checks, kent: Clinic, address: str, session: str) -> None:
    """Prints what the browser checks. The browser asks for the line to be cut and restored."""
    with subprocess.Popen(["node", str(REPOSITORY / "tests/fleet/dashboard.mjs"), address, session], stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE, text=True) as browser:
        assert browser.stdin is not None and browser.stdout is not None
        limit = threading.Timer(BROWSER_S, browser.kill)  # a page that hangs ends no line
        limit.daemon = True
        limit.start()
        for line in browser.stdout:
            match line.split(maxsplit=1):
                case ["cut"]:
                    kent.line.cut()
                case ["restore"]:
                    kent.line.restore()
                case ["ok" | "FAILED" as result, what]:
                    checks.expect(what.rstrip(), result == "ok")
                case _:
                    print(line, end="", flush=True)
                    continue
            browser.stdin.write("done\n")
            browser.stdin.flush()
        status = browser.wait(timeout=BROWSER_S)
        limit.cancel()
    checks.expect("the browser came to its end", status == 0, status)


if __name__ == "__main__":
    for needed in ("node", os.environ.get("DTS_CHROMIUM", "chromium")):
        if shutil.which(needed) is None:
            print(f"skipped: {needed} is not installed")
            sys.exit(SKIPPED)
    if not os.path.exists(f"{WEB_ROOT}/index.html") or not (PROGRAMS / "dts-fleet-gateway").exists():
        print("skipped: the dashboard is not built")
        sys.exit(SKIPPED)
    run_test(dashboard)
