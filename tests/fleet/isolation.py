#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Clinics are apart: with the key of one, every subject, inbox and reply subject of another is tried. Then one clinic floods the
centre, and is revoked.

    isolation.py [--keep]    --keep: keeps the folder with the logs"""
import statistics
import sys
import threading
import time

from centre import Centre
from checks import Checks, run_test
from child import PROGRAMS, Failure, wait_until
from clinic import FLOOR, Clinic
from gateway import Gateway, is_let_in
from nats_client import NatsClient, NKey
from protobuf import fixed64, message

BEAT = message({1: fixed64(time.time_ns())})
WORKER = "hub-1"
FACTS_IN_A_FLOOD = 50  # of the other clinic
OWN_PUBLISH = ["up.open", f"up.{WORKER}.chunk", f"up.{WORKER}.commit", "facts", "erase", "beat", "live.floor.cop"]
OWN_SUBSCRIBE = ["down.live"]


def foreign_subjects(victim: str) -> list[str]:
    """Returns what belongs to a clinic, to the centre and to the server."""
    own = [f"dts.v1.{victim}.{rest}" for rest in OWN_PUBLISH + OWN_SUBSCRIBE]
    return [*own, f"_INBOX.{victim}.x", f"_INBOX_{victim}.x", "_INBOX.x", "_INBOX.hub.x", "_HUB.x", "_HUB.x.y", "$JS.API.INFO",
            "$JS.API.STREAM.CREATE.x", "$SYS.REQ.SERVER.PING", "$SYS.ACCOUNT.x.CONNECT", f"dts.v2.{victim}.beat", "dts.v1.beat", "anything"]


def foreign_patterns(victim: str) -> list[str]:
    return [*foreign_subjects(victim), ">", "*", "*.>", "dts.>", "dts.v1.>", "dts.v1.*.>", "dts.v1.*.beat", "dts.v1.*.up.open",
            "dts.*.*.down.live", f"dts.v1.{victim}.>", f"dts.*.{victim}.up.>", f"_INBOX.{victim}.>", "_INBOX.>", "_INBOX.*.>", "_HUB.>", "*.x",
            "$JS.>", "$SYS.>"]


def expect_rejected(checks: Checks, centre: Centre, attacker: Clinic, victim: str) -> None:
    """Tries everything of `victim` with the key of `attacker`."""
    client = NatsClient(centre.nats_port, centre.folder / "ca.pem", NKey.of_file(attacker.folder / f"{attacker.name}.nk"))
    for subject in [f"dts.v1.{attacker.name}.{rest}" for rest in OWN_PUBLISH]:
        client.publish(subject)
    for subject in [f"dts.v1.{attacker.name}.{rest}" for rest in OWN_SUBSCRIBE] + [f"_INBOX.{attacker.name}.>"]:
        client.subscribe(subject)
    client.wait_for_server()
    errors = client.taken_errors()
    checks.expect(f"{attacker.name} may use its own subjects", not errors, errors)
    # A clinic that could publish to what it subscribes to could ask itself, and would be allowed to answer to any subject.
    publish = [*foreign_subjects(victim), f"_INBOX.{attacker.name}.x", f"dts.v1.{attacker.name}.down.live"]
    subscribe = [*foreign_patterns(victim), f"dts.v1.{attacker.name}.>", *(f"dts.v1.{attacker.name}.{rest}" for rest in OWN_PUBLISH)]
    for verb, subjects, act in (("Publish", publish, client.publish), ("Subscription", subscribe, client.subscribe)):
        allowed, unlogged = [], []
        for subject in subjects:
            act(subject)
            client.wait_for_server()
            if not any(f'Permissions Violation for {verb} to "{subject}"' in error for error in client.taken_errors()):
                allowed.append(subject)
            words = (f"{verb} Violation", attacker.public_key, f'"{subject}"')
            if not any(all(word in line for word in words) for line in centre.nats.text().splitlines()):
                unlogged.append(subject)
        what = "publish to" if verb == "Publish" else "subscribe to"
        checks.expect(f"{attacker.name} cannot {what} {len(subjects)} subjects, most of {victim}, the centre and the server", not allowed, allowed)
        checks.expect(f"  each attempt is in the log of nats-server with the key of {attacker.name}", not unlogged, unlogged)
    # Its own inbox gets the answers to the beats of its own dts-forward.
    foreign = [letter.subject for letter in client.letters.queue if not letter.subject.startswith(f"_INBOX.{attacker.name}.")]
    checks.expect(f"{attacker.name} has received nothing of others", not foreign, foreign)
    client.close()


def expect_no_foreign_reply(checks: Checks, centre: Centre, attacker: Clinic, victim: Clinic) -> None:
    """The server does not check reply subjects: the hub must not answer to those of another clinic."""
    ca = centre.folder / "ca.pem"
    attack = NatsClient(centre.nats_port, ca, NKey.of_file(attacker.folder / f"{attacker.name}.nk"))
    watch = NatsClient(centre.nats_port, ca, NKey.of_file(victim.folder / f"{victim.name}.nk"))
    watch.subscribe(f"_INBOX.{victim.name}.canary.>")
    watch.wait_for_server()
    targets = [f"_INBOX.{victim.name}.canary.{number}" for number in range(3)] + [f"dts.v1.{victim.name}.canary"]
    own = f"_INBOX.{attacker.name}.canary"
    attack.subscribe(own)
    for subject in ("beat", "up.open", "facts", "erase"):
        for target in targets:
            attack.publish(f"dts.v1.{attacker.name}.{subject}", BEAT, target)
    attack.publish(f"dts.v1.{attacker.name}.beat", BEAT, own)
    checks.expect(f"the hub answers to {attacker.name} itself", attack.next_letter().subject == own)
    warning = f"clinic {attacker.name} asked for an answer to a subject that is not its own"
    wait_until(f"the log of dts-hub has the attempt of {attacker.name}", lambda: warning in centre.hub.text())
    watch.publish(f"dts.v1.{victim.name}.beat", BEAT, f"_INBOX.{victim.name}.canary.own")
    first = watch.next_letter().subject  # the hub has read all that came before
    checks.expect(f"no answer to {attacker.name} reached {victim.name}", first == f"_INBOX.{victim.name}.canary.own", first)
    attack.close()
    watch.close()


def expect_service_in_a_flood(checks: Checks, centre: Centre, attacker: Clinic, victim: Clinic) -> None:
    """One clinic sends facts as fast as it can; the hub answers another one meanwhile."""
    def flood() -> None:
        client = NatsClient(centre.nats_port, centre.folder / "ca.pem", NKey.of_file(attacker.folder / f"{attacker.name}.nk"))
        while not is_over.is_set():
            client.publish(f"dts.v1.{attacker.name}.facts", facts(f"flood-{sent[0]}"), f"_INBOX.{attacker.name}.flood")
            sent[0] += 1
        client.close()

    is_over, sent = threading.Event(), [0]
    client = NatsClient(centre.nats_port, centre.folder / "ca.pem", NKey.of_file(victim.folder / f"{victim.name}.nk"))
    client.subscribe(f"_INBOX.{victim.name}.facts")
    client.wait_for_server()
    flooding = threading.Thread(target=flood)
    flooding.start()
    try:
        wait_until("the hub slows the flood", lambda: f"clinic {attacker.name} sends more messages" in centre.hub.text())
        times_s = []
        for number in range(FACTS_IN_A_FLOOD):
            begun_s = time.monotonic()
            wait_until(f"the hub answers to {victim.name}", lambda session=f"victim-{number}": is_answered(client, victim.name, session))
            times_s.append(time.monotonic() - begun_s)
        print(f"        {sent[0]} messages of {attacker.name}; an answer to {victim.name} after {statistics.median(times_s) * 1e3:.0f} ms (median), "
              f"{max(times_s) * 1e3:.0f} ms (longest)")
    finally:
        is_over.set()
        flooding.join()
        client.close()
    wait_until("all of them are stored", lambda: centre.query(f"SELECT count(*) FROM session WHERE clinic = '{victim.name}'") == str(FACTS_IN_A_FLOOD))
    stored = int(centre.query(f"SELECT count(*) FROM session WHERE clinic = '{attacker.name}'"))
    checks.expect(f"in a flood of {attacker.name}, all facts of {victim.name} are stored, and few of the flood",
                  stored < sent[0] / 2, stored)


def is_answered(client: NatsClient, clinic: str, session: str) -> bool:
    """Sends facts, as dts-forward does: again if there is no answer."""
    client.publish(f"dts.v1.{clinic}.facts", facts(session), f"_INBOX.{clinic}.facts")
    try:
        client.next_letter(patience_s=5.0)
    except Failure:
        return False
    return True


def facts(session: str) -> bytes:
    return message({1: session.encode(), 2: 1, 6: b"complete", 7: fixed64(time.time_ns())})


def expect_revoked(checks: Checks, centre: Centre, clinic: Clinic, other: Clinic) -> None:
    key = NKey.of_file(clinic.folder / f"{clinic.name}.nk")
    ca = centre.folder / "ca.pem"
    client = NatsClient(centre.nats_port, ca, key)
    begun_s = time.monotonic()
    centre.fleet("clinic", "revoke", clinic.name)
    wait_until("the connection of the revoked key ends", client.ended.is_set)
    print(f"        the connection of {clinic.name} ended {time.monotonic() - begun_s:.2f} s after the command began (bar: 2 s)")
    checks.expect(f"{clinic.name} is not let in again", not is_let_in(centre, key))
    checks.expect(f"{other.name} still is", is_let_in(centre, NKey.of_file(other.folder / f"{other.name}.nk")))
    centre.nats.kill()
    centre.nats.start()
    wait_until("nats-server is back", lambda: is_let_in(centre, NKey.of_file(other.folder / f"{other.name}.nk")))
    checks.expect(f"{clinic.name} is not let in after a restart of nats-server", not is_let_in(centre, key))
    states = {row["clinic"]: row["state"] for row in centre.fleet_lines("clinic", "list")}
    checks.expect("the list of clinics shows it", states.get(clinic.name) == "revoked" and states.get(other.name) != "revoked", states)


def expect_dashboard_watches_only(checks: Checks, centre: Centre, gateway: Gateway, clinic: Clinic, other: Clinic) -> None:
    client = NatsClient(centre.nats_port, centre.folder / "ca.pem", NKey.of_file(gateway.key_file))
    own = f"_DASHBOARD.{NKey.of_file(gateway.key_file).public}"
    client.publish(f"dts.v1.{clinic.name}.down.live")
    for subject in ("dts.v1.*.live.>", f"dts.v1.{clinic.name}.live.>", f"{own}.>"):
        client.subscribe(subject)
    client.wait_for_server()
    errors = client.taken_errors()
    checks.expect("the key of the dashboard may ask for live data and receive them", not errors, errors)
    publish = [subject for subject in foreign_subjects(clinic.name) if not subject.endswith(".down.live")]
    publish += [f"dts.v1.{clinic.name}.down.ask", f"{own}.x", "_DASHBOARD.x.y"]
    subscribe = [pattern for pattern in foreign_patterns(clinic.name) if ".live." not in pattern]
    subscribe += ["dts.v1.*.up.>", "dts.v1.*.facts", "dts.v1.*.down.live", "_DASHBOARD.>", "_DASHBOARD.*.>"]
    for verb, subjects, act in (("Publish", publish, client.publish), ("Subscription", subscribe, client.subscribe)):
        allowed = []
        for subject in subjects:
            act(subject)
            client.wait_for_server()
            if not any(f'Permissions Violation for {verb} to "{subject}"' in error for error in client.taken_errors()):
                allowed.append(subject)
        checks.expect(f"  and nothing else: {verb.lower()} of {len(subjects)} subjects is rejected", not allowed, allowed)
    # The server does not check reply subjects: the clinic must not answer to those of others.
    watch = NatsClient(centre.nats_port, centre.folder / "ca.pem", NKey.of_file(other.folder / f"{other.name}.nk"))
    watch.subscribe(f"_INBOX.{other.name}.canary.>")
    watch.wait_for_server()
    request = message({1: "dtsd/status", 2: "canary"})
    client.publish(f"dts.v1.{clinic.name}.down.live", request, f"_INBOX.{other.name}.canary.x")
    client.publish(f"dts.v1.{clinic.name}.down.live", request, f"{own}.first")
    answered = ""
    while answered != f"{own}.first":
        answered = client.next_letter().subject
    watch.wait_for_server()
    checks.expect(f"the clinic answers to the dashboard, and not to {other.name}", watch.letters.empty())
    watch.close()
    client.close()


def isolation(checks: Checks) -> None:
    centre = Centre()
    clinics: list[Clinic] = []
    try:
        centre.start()
        for number, name in enumerate(("kent", "essex")):
            clinics.append(Clinic(centre, name, rigs=(FLOOR,), seed=number + 1))
            clinics[-1].start()
        kent, essex = clinics
        expect_rejected(checks, centre, kent, "essex")
        expect_rejected(checks, centre, essex, "kent")
        if (PROGRAMS / "dts-fleet-gateway").exists():
            gateway = Gateway(centre)
            gateway.enrol()
            expect_dashboard_watches_only(checks, centre, gateway, kent, essex)
        expect_no_foreign_reply(checks, centre, kent, essex)
        expect_no_foreign_reply(checks, centre, essex, kent)
        expect_service_in_a_flood(checks, centre, kent, essex)
        expect_revoked(checks, centre, kent, essex)
    finally:
        for clinic in clinics:
            clinic.close()
        centre.close(keep="--keep" in sys.argv)


if __name__ == "__main__":
    run_test(isolation)
