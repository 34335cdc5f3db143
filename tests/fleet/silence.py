#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A line that is silent: no byte arrives, and nothing ends the connection. While a recording is sent and a rig is watched, the line becomes
silent in both directions, then in one only. dts-forward must notice it, must end on request, and must deliver when the line lives again.
What is promised in seconds may take three times as long: a busy machine must not fail the test."""
import json
import signal
import time

from centre import Centre
from checks import Checks, run_test
from child import PATIENCE_S, wait_until
from clinic import LARGE_FLOOR, Clinic
from watcher import Watcher

BYTES_PER_S = 300e3
SECONDS = 6.0
SLOW = 3.0
LONGEST_NOTICE_S = SLOW * 15  # docs/fleet.md: after 10 to 15 s the connection counts as lost
LONGEST_RETURN_S = SLOW * 9  # up to 4 s until the link connects again, then a beat: every 2 s, each waits 3 s for its answer
LONGEST_END_S = SLOW * 10  # 10 s: TimeoutStopSec of the unit
NOTICED = "recordings: the connection is lost: the server is silent"


def watches(viewer: Watcher) -> bool:
    """Asks for the raw signals, as a viewer does every few seconds. Returns true if a block has arrived."""
    viewer.ask("kent", ["floor/raw"])
    time.sleep(0.5)
    return any(letter.subject.endswith(".raw") for letter in viewer.letters())


def status(clinic: Clinic) -> dict:
    return json.loads(clinic.forward("status", "--json"))


def check_end(checks: Checks, clinic: Clinic, when: str) -> None:
    begun_s = time.monotonic()
    clinic.forwarder.send(signal.SIGTERM)
    wait_until(f"dts-forward ends on SIGTERM {when}", lambda: not clinic.forwarder.is_alive(), LONGEST_END_S)
    checks.expect(f"  dts-forward ends on SIGTERM {when}, after {time.monotonic() - begun_s:.1f} s", True)
    clinic.forwarder.start()


def silent(checks: Checks, clinic: Clinic, viewer: Watcher, up: bool, down: bool) -> None:
    name = f"silent {'in both directions' if up and down else 'towards the centre' if up else 'towards the clinic'}"
    clinic.record(SECONDS)
    wait_until("the rig is watched", lambda: watches(viewer))
    wait_until("the session has ended", lambda: not clinic.is_recording(), SECONDS + PATIENCE_S)
    wait_until("a part of the recording has arrived", lambda: status(clinic).get("sending", {}).get("have", 0) > 0)
    known = clinic.forwarder.text().count(NOTICED)
    clinic.line.silence(up, down)
    begun_s = time.monotonic()
    wait_until(f"{name}: the link of the recordings notices it", lambda: clinic.forwarder.text().count(NOTICED) > known, LONGEST_NOTICE_S)
    checks.expect(f"{name}: the link notices it after {time.monotonic() - begun_s:.0f} s", True)
    wait_until("status reports it", clinic.problem)
    checks.expect(f"  status reports \"{clinic.problem()}\", and no time to go", "to_go_s" not in status(clinic), status(clinic))
    check_end(checks, clinic, "after the connection was lost")
    time.sleep(3)  # it is connecting
    check_end(checks, clinic, "while it connects for the first time")
    answered = status(clinic).get("answered_utc")
    clinic.line.speak()
    begun_s = time.monotonic()
    wait_until("the centre answers a beat", lambda: status(clinic).get("answered_utc") != answered, LONGEST_RETURN_S)
    checks.expect(f"  a beat is answered {time.monotonic() - begun_s:.1f} s after the line lives again", True)
    wait_until("the recording has a receipt", lambda: not clinic.undelivered(), 120)
    checks.expect(f"  the recording has a receipt after {time.monotonic() - begun_s:.1f} s", True)
    wait_until("the rig is watched again", lambda: watches(viewer))


def short(checks: Checks, clinic: Clinic) -> None:
    """Shorter than the time after which the connection counts as dead: the same connection continues."""
    clinic.record(SECONDS)
    wait_until("the session has ended", lambda: not clinic.is_recording(), SECONDS + PATIENCE_S)
    wait_until("a part of the recording has arrived", lambda: status(clinic).get("sending", {}).get("have", 0) > 0)
    before = clinic.forwarder.text().count("recordings: connected")
    clinic.line.silence(True, True)
    time.sleep(4)
    clinic.line.speak()
    wait_until("the recording has a receipt", lambda: not clinic.undelivered(), 120)
    checks.expect("silent for 4 s: the recording arrives over the same connection",
                  clinic.forwarder.text().count("recordings: connected") == before)


def unnoticed(checks: Checks, clinic: Clinic) -> None:
    """SIGTERM while the connection is silent and still counts as sound."""
    clinic.record(SECONDS)
    wait_until("the session has ended", lambda: not clinic.is_recording(), SECONDS + PATIENCE_S)
    wait_until("a part of the recording has arrived", lambda: status(clinic).get("sending", {}).get("have", 0) > 0)
    clinic.line.silence(True, True)
    check_end(checks, clinic, "while the connection is silent")
    clinic.line.speak()
    wait_until("the recording has a receipt", lambda: not clinic.undelivered(), 120)


def silence(checks: Checks) -> None:
    centre = Centre()
    clinic = Clinic(centre, "kent", rigs=(LARGE_FLOOR,), bytes_per_s=BYTES_PER_S)
    try:
        centre.start()
        clinic.start()
        wait_until("the centre knows the clinic", lambda: centre.query("SELECT count(*) FROM beat") == "1")
        viewer = Watcher(centre)
        short(checks, clinic)
        unnoticed(checks, clinic)
        for up, down in ((True, True), (True, False), (False, True)):
            silent(checks, clinic, viewer, up, down)
        checks.expect("what is watched has a connection of its own", "kent live: connected" in clinic.forwarder.text())
    finally:
        clinic.close()
        centre.close()


if __name__ == "__main__":
    run_test(silence)
