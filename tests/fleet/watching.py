#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What dashboards of the centre let through: a study's dashboard only its clinics, and a hostile clinic not the whole memory."""
import json
import time
import urllib.error
import urllib.request

from centre import Centre
from checks import Checks, run_test
from child import wait_until
from gateway import Gateway, Tab, is_let_in, make_key
from nats_client import NatsClient, NKey
from protobuf import fixed64, message

MOST_GROWTH = 64 << 20
LEASE = message({1: 10})
INSTANCE = {1: fixed64(7)}
LARGE_SESSION = message(INSTANCE | {8: message({1: "S" * 100_000})})  # Event.session, a retained event


def status_of(rigs: list[str]) -> bytes:
    return message(INSTANCE) + b"".join(message({6: message({1: message({1: rig, 10: "cop"})})}) for rig in rigs)


def enrol(centre: Centre, clinic: str) -> NKey:
    key = centre.folder / f"{clinic}.nk"
    centre.enrol(clinic, clinic.capitalize(), make_key(key), [centre.nats_port], centre.folder / f"{clinic}.toml")
    wait_until(f"nats-server lets {clinic} in", lambda: is_let_in(centre, NKey.of_file(key)))
    return NKey.of_file(key)


def get(gateway: Gateway, path: str) -> tuple[int, dict]:
    try:
        with urllib.request.urlopen(f"{gateway.address()}{path}", timeout=60) as answer:
            return answer.status, json.loads(answer.read())
    except urllib.error.HTTPError as refusal:
        return refusal.code, {}


def expect_own_clinics_only(checks: Checks, centre: Centre, study: Gateway, everything: Gateway) -> None:
    centre.query("INSERT INTO session (clinic, id, revision, rig, protocol, state, started, planned_trials, is_deleted, fields) "
                 "SELECT c, 'S-' || c, 1, 'floor', 'romberg', 'complete', now(), 1, false, '{}' FROM unnest(ARRAY['kent', 'essex']) c")
    centre.query("INSERT INTO result (clinic, session, name, analysis, value, unit) "
                 "SELECT c, 'S-' || c, 'MVELO', 'clinic', 1, 'mm/s' FROM unnest(ARRAY['kent', 'essex']) c")
    centre.query(f"INSERT INTO permit (role, clinic) VALUES ('{study.role}', 'kent')")

    def seen(gateway: Gateway) -> list[set[str]]:
        return [{row["name"] for row in get(gateway, "/api/fleet/clinics")[1]["clinics"]},
                {row["clinic"] for row in get(gateway, "/api/fleet/sessions")[1]["sessions"]},
                {point[0] for point in get(gateway, "/api/fleet/trend?measure=MVELO")[1]["points"]}]

    checks.expect("the dashboard of all shows both clinics, their sessions and trends", seen(everything) == [{"kent", "essex"}] * 3, seen(everything))
    checks.expect("the dashboard of the study shows its clinic only", seen(study) == [{"kent"}] * 3, seen(study))
    checks.expect("  and no page of the other", get(study, "/api/fleet/clinics/essex")[0] == 404)
    client = NatsClient(centre.nats_port, centre.folder / "ca.pem", NKey.of_file(study.key_file))
    client.subscribe("dts.v1.kent.live.>")
    client.publish("dts.v1.kent.down.live")
    client.wait_for_server()
    checks.expect("its key may watch its clinic", not client.taken_errors())
    client.subscribe("dts.v1.essex.live.>")
    client.subscribe("dts.v1.*.live.>")
    client.publish("dts.v1.essex.down.live")
    client.wait_for_server()
    errors = client.taken_errors()
    checks.expect("  and no other", len(errors) == 3 and all("Permissions Violation" in error for error in errors), errors)
    client.close()


def expect_bounded_memory(checks: Checks, centre: Centre, gateway: Gateway, key: NKey) -> None:
    """A clinic's key may publish any live topic of the clinic, as fast as the line carries it."""
    clinic = NatsClient(centre.nats_port, centre.folder / "ca.pem", key)
    clinic.subscribe("dts.v1.kent.down.live")
    tab = Tab(gateway, "kent")
    clinic.publish(clinic.next_letter().reply, LEASE)
    clinic.publish("dts.v1.kent.live.dtsd.status", status_of(["floor"]))
    wait_until("the tab has the status", lambda: b"dtsd/status" in tab.received)
    before = gateway.resident_bytes()

    for number in range(2000):  # 200 MB
        clinic.publish(f"dts.v1.kent.live.r{number}.session", LARGE_SESSION)
    for number in range(100):  # 400,000 rigs in all, each time with other names
        clinic.publish("dts.v1.kent.live.dtsd.status", status_of([f"r{number}-{rig}" for rig in range(4000)]))
    clinic.publish("dts.v1.kent.live.dtsd.status", status_of([f"rig{rig}" for rig in range(10_000)]))
    for turn in range(60):  # allowed numbers of rigs, whose names change; all topics were asked for
        rigs = [f"t{turn}-{rig}" for rig in range(30)]
        clinic.publish("dts.v1.kent.live.dtsd.status", status_of(rigs))
        clinic.wait_for_server()
        time.sleep(0.1)  # for the next request of the dashboard
        for rig in rigs:
            clinic.publish(f"dts.v1.kent.live.{rig}.session", LARGE_SESSION)
    clinic.wait_for_server()
    tab.received = b""
    clinic.publish("dts.v1.kent.live.dtsd.status", status_of(["floor"]))
    tab.close()
    other = Tab(gateway, "kent")
    wait_until("the dashboard still answers", lambda: other.received != b"")
    other.close()
    growth = gateway.resident_bytes() - before
    print(f"        the memory of the dashboard grew by {growth / 1e6:.1f} MB while a clinic sent 380 MB")
    checks.expect("the memory of the dashboard is bounded", growth < MOST_GROWTH, growth)
    gateway.expect_alive()
    clinic.close()


def watching(checks: Checks) -> None:
    centre = Centre()
    root = centre.folder / "web"
    root.mkdir()
    (root / "index.html").write_text("<title>none</title>")
    everything = Gateway(centre, web_root=str(root))
    study = Gateway(centre, name="study", group="study_dashboard", clinics=("kent",), web_root=str(root))
    try:
        centre.start()
        kent = enrol(centre, "kent")
        enrol(centre, "essex")
        for gateway in (everything, study):
            gateway.start()
            wait_until(f"{gateway.name} listens", gateway.address)
        expect_own_clinics_only(checks, centre, study, everything)
        expect_bounded_memory(checks, centre, everything, kent)
    finally:
        for gateway in (everything, study):
            gateway.stop()
        centre.close(keep=checks.failed > 0)


if __name__ == "__main__":
    run_test(watching)
