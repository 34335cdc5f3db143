#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A line that is silent: no byte arrives, and nothing ends the connection. While a recording is sent and a rig is watched, the line becomes
silent in both directions, then in one only. dts-forward must notice it, must end on request, and must deliver when the line lives again."""
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
LONGEST_END_S = 5.0  # systemd waits longer; a clinic that shuts down does not


def watches(viewer: Watcher) -> bool:
    """Asks for the raw signals, as a viewer does every few seconds. Returns true if a block has arrived."""
    viewer.ask("kent", ["floor/raw"])
    time.sleep(0.5)
    return any(letter.subject.endswith(".raw") for letter in viewer.letters())


def status(clinic: Clinic) -> dict:
    return json.loads(clinic.forward("status", "--json"))


def silent(checks: Checks, clinic: Clinic, viewer: Watcher, up: bool, down: bool) -> None:
    name = f"silent {'in both directions' if up and down else 'towards the centre' if up else 'towards the clinic'}"
    clinic.record(SECONDS)
    wait_until("the session has ended", lambda: not clinic.is_recording(), SECONDS + PATIENCE_S)
    wait_until("the rig is watched", lambda: watches(viewer))
    wait_until("a part of the recording has arrived", lambda: status(clinic).get("sending", {}).get("have", 0) > 0)
    clinic.line.silence(up, down)
    begun_s = time.monotonic()
    wait_until("status reports it", lambda: "silent" in clinic.problem() or "does not answer" in clinic.problem())
    checks.expect(f"{name}: status reports \"{clinic.problem()}\" after {time.monotonic() - begun_s:.0f} s", True)
    checks.expect("  and no time to go", "to_go_s" not in status(clinic), status(clinic))
    for what in ("while the connection is silent", "while it tries to connect"):
        begun_s = time.monotonic()
        clinic.forwarder.send(signal.SIGTERM)
        wait_until(f"dts-forward ends on SIGTERM {what}", lambda: not clinic.forwarder.is_alive(), LONGEST_END_S)
        checks.expect(f"  dts-forward ends on SIGTERM {what}, after {time.monotonic() - begun_s:.1f} s", True)
        clinic.forwarder.start()
        time.sleep(3)  # it is connecting
    answered = status(clinic).get("answered_utc")
    clinic.line.speak()
    begun_s = time.monotonic()
    wait_until("the centre answers a beat", lambda: status(clinic).get("answered_utc") != answered)
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


def silence(checks: Checks) -> None:
    centre = Centre()
    clinic = Clinic(centre, "kent", rigs=(LARGE_FLOOR,), bytes_per_s=BYTES_PER_S)
    try:
        centre.start()
        clinic.start()
        wait_until("the centre knows the clinic", lambda: centre.query("SELECT count(*) FROM beat") == "1")
        viewer = Watcher(centre)
        short(checks, clinic)
        for up, down in ((True, True), (True, False), (False, True)):
            silent(checks, clinic, viewer, up, down)
        checks.expect("what is watched has a connection of its own", "kent live: connected" in clinic.forwarder.text())
    finally:
        clinic.close()
        centre.close()


if __name__ == "__main__":
    run_test(silence)
