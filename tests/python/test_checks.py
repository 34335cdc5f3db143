# SPDX-License-Identifier: Apache-2.0
"""What needs no daemon: limits of what a peer may say, what is missing between blocks, words, addresses."""
import os
import tempfile
import unittest
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import zmq
from support import block_of, status_of

import dts
from dts.control import ControlClient, _response_of
from dts.errors import error_of
from dts.events import fields_of, words_of_bits
from dts.inbox import Inbox
from dts.live import Collector
from dts.loss import ScanGap, LossTracker, Position
from dts.recording import _on_host
from dts.streams import to_utc
from dts.subscriber import Subscriber, check_timeout
from dts.v1 import control_pb2, stream_pb2
from dts.wire_check import check_answer, is_block

STREAM: dict[str, Any] = {"name": "cop", "rate": {"numerator": 100, "denominator": 1}, "channels": [{}]}
RIG: dict[str, Any] = {"name": "rig", "streams": [STREAM]}
PART = {"state": 1}
Answer = Callable[[Any], dict[str, Any]]


def rigs(**fields: Any) -> dict[str, Any]:
    return {"rigs": {"rigs": [RIG | fields]}}


def stream(**fields: Any) -> dict[str, Any]:
    return rigs(streams=[STREAM | fields])


def status(**fields: Any) -> dict[str, Any]:
    return {"status": {"instance_id": 1, **fields}}


def record(**fields: Any) -> dict[str, Any]:
    return {"session_record": {"session_id": "s", **fields}}


def part(**fields: Any) -> dict[str, Any]:
    return {"sessions": {"sessions": [{"session_id": "s", "parts": [PART | fields]}]}}


def protocol(**fields: Any) -> dict[str, Any]:
    return {"protocols": {"protocols": [{"name": "p", **fields}]}}


def field(**fields: Any) -> dict[str, Any]:
    return protocol(fields=[{"name": "f", **fields}])


LISTS: dict[str, tuple[int, Answer]] = {
    "status: rigs": (64, lambda n: status(rigs=[{"rig": RIG}] * n)),
    "status: notices": (1000, lambda n: status(notices=[""] * n)),
    "rigs": (64, lambda n: {"rigs": {"rigs": [RIG] * n}}),
    "sensors": (256, lambda n: rigs(sensors=[{}] * n)),
    "streams": (64, lambda n: rigs(streams=[STREAM] * n)),
    "stream: channels": (256, lambda n: stream(channels=[{}] * n)),
    "devices": (1000, lambda n: {"devices": {"devices": [{}] * n}}),
    "kinds of device": (1000, lambda n: {"devices": {"kinds": [""] * n}}),
    "test: checks": (1000, lambda n: {"device_test": {"checks": [{}] * n}}),
    "test: channels": (256, lambda n: {"device_test": {"channels": [{}] * n}}),
    "marks": (64, lambda n: {"mark": {"marks": [{}] * n}}),
    "tare": (256, lambda n: {"tare": {"baseline": [0.0] * n}}),
    "sessions": (10_000, lambda n: {"sessions": {"sessions": [{"session_id": "s"}] * n}}),
    "parts": (1000, lambda n: record(parts=[PART] * n)),
    "corrections": (10_000, lambda n: record(corrections=[{}] * n)),
    "subjects": (10_000, lambda n: {"subjects": {"subjects": [{}] * n}}),
    "subject: sessions": (10_000, lambda n: {"subject": {"sessions": [{"session_id": "s"}] * n}}),
    "subject: mentioning sessions": (10_000, lambda n: {"subject": {"mentioning_sessions": [""] * n}}),
    "erased: left": (10_000, lambda n: {"erased": {"left": [""] * n}}),
    "trials": (10_000, lambda n: record(trials=[{}] * n)),
    "losses": (1000, lambda n: part(losses=[{}] * n)),
    "protocols": (1000, lambda n: {"protocols": {"protocols": [{"name": "p"}] * n}}),
    "conditions": (1000, lambda n: protocol(conditions=[{}] * n)),
    "fields": (1000, lambda n: protocol(fields=[{}] * n)),
    "choices": (1000, lambda n: field(choices=["c"] * n)),
    "audit": (10_000, lambda n: {"audit": {"entries": [{}] * n}}),
}
AMOUNTS: dict[str, Answer] = {
    "recordable": lambda value: status(disk={"recordable_s": value}),
    "target": lambda value: {"trial": {"next_target_cm": value}},
    "left of a trial": lambda value: {"session": {"session_id": "s", "trial": {"remaining_s": value}}},
    "trial in a status": lambda value: status(rigs=[{"rig": RIG, "session": {"trial": {"remaining_s": value}}}]),
    "length": lambda value: part(duration_s=value),
    "lost": lambda value: record(parts=[PART | {"lost_s_at_most": value}]),
    "settling": lambda value: protocol(settle_s=value),
    "protocol's length": lambda value: protocol(duration_s=value),
}
# What is given; then what is accepted there, and what is not.
VALUES: list[tuple[Answer, list[Any], list[Any]]] = [
    *((answer, ["x" * 64, "é" * 32], ["", "x" * 65, "é" * 33, "a/b"]) for answer in (
        lambda name: rigs(name=name), lambda name: stream(name=name), lambda name: protocol(name=name))),
    (lambda terms: stream(rate={"numerator": terms[0], "denominator": terms[1]}), [(1, 1), (10**12, 10**12)],
     [(0, 1), (1, 0), (-1, 1), (10**12 + 1, 1), (1, 10**12 + 1)]),
    (lambda channels: stream(channels=channels), [[{}]], [[]]),
    (lambda number: status(instance_id=number), [1], [0]),
    (lambda state: status(disk={"state": state}), [0, 1], [99]),
    (lambda phase: {"trial": {"phase": phase}}, [0, 1], [99]),
    (lambda outcome: {"trial": {"last_outcome": outcome}}, [0, 4], [99]),
    (lambda fault: {"trial": {"last_fault": fault}}, [0, 4], [99]),
    (lambda state: part(state=state), [1, 2], [0, 99]),
    (lambda text: {"session": {"session_id": text}}, ["s"], [""]),
    (lambda text: {"session_record": {"session_id": text}}, ["s"], [""]),
    (lambda ends: field(minimum=ends[0], maximum=ends[1]), [(0, 0), (-1, 1)],
     [(1, 0), (float("-inf"), 0), (0, float("inf")), (float("nan"), 0), (0, float("nan"))]),
]


class WireCheck(unittest.TestCase):
    def assertAccepted(self, is_accepted: bool, answer: dict[str, Any]) -> None:
        response = control_pb2.Response(**answer)
        if is_accepted:
            check_answer(response)
        else:
            self.assertRaises(dts.DataDamaged, check_answer, response)

    def test_WhatIsListedIsBounded(self) -> None:
        for name, (limit, answer) in LISTS.items():
            with self.subTest(name):
                self.assertAccepted(True, answer(limit))
                self.assertAccepted(False, answer(limit + 1))

    def test_ValuesMustMakeSense(self) -> None:
        amounts = [(answer, [0.0, 1.0], [-1e-9, float("nan"), float("inf")]) for answer in AMOUNTS.values()]
        for answer, good, bad in VALUES + amounts:
            for value in good + bad:
                with self.subTest(answer=answer(value)):
                    self.assertAccepted(value in good, answer(value))

    def test_BlocksAreBounded(self) -> None:
        changes: list[tuple[bool, dict[str, Any]]] = [
            (True, {}),
            (True, {"scan_count": 65536, "channel_count": 1, "values": [0.0] * 65536, "quality": b"\0"}),
            (False, {"scan_count": 65537, "channel_count": 1, "values": [0.0] * 65537, "quality": b"\0"}),
            (True, {"scan_count": 1, "channel_count": 256, "values": [0.0] * 256, "quality": b"\0" * 256}),
            (False, {"scan_count": 1, "channel_count": 257, "values": [0.0] * 257, "quality": b"\0" * 257}),
            (False, {"scan_count": 0, "values": []}),
            (False, {"channel_count": 0, "values": [], "quality": b""}),
            (False, {"scan_count": 11}),
            (False, {"quality": b"\0\0\0"}),
            (False, {"instance_id": 0}),
            (True, {"first_scan": 2**62}),
            (False, {"first_scan": 2**62 + 1}),
            (False, {"rate": stream_pb2.Rate(numerator=0, denominator=1)}),
        ]
        for is_good, change in changes:
            with self.subTest(change=str(change)[:80]):
                block = block_of(1, 0)
                for name, value in change.items():
                    block.ClearField(name)
                block.MergeFrom(stream_pb2.StreamBlock(**change))
                self.assertEqual(is_block(block), is_good)


class Losses(unittest.TestCase):
    def test_WhatIsMissingBetweenTwoBlocks(self) -> None:
        at = Position(segment=3, first_scan=50, scan_count=10, sequence=5)
        cases: dict[str, tuple[dict[str, int], ScanGap]] = {
            "continued": ({"first_scan": 60, "sequence": 6}, ScanGap()),
            "skipped": ({"first_scan": 90, "sequence": 9}, ScanGap(30)),
            "repeated": ({}, ScanGap(0, False, False)),
            "sequence goes back": ({"first_scan": 60, "sequence": 4}, ScanGap(0, False, False)),
            "scans go back": ({"first_scan": 59, "sequence": 6}, ScanGap(0, False, False)),
            "segment goes back": ({"segment": 2, "first_scan": 60, "sequence": 6}, ScanGap(0, False, False)),
            "new segment": ({"segment": 4, "first_scan": 7, "sequence": 6}, ScanGap()),
            "new segment after a loss": ({"segment": 4, "first_scan": 7, "sequence": 7}, ScanGap(7, False)),
        }
        for name, (change, gap) in cases.items():
            with self.subTest(name):
                tracker = LossTracker()
                self.assertEqual(tracker.advance(at), ScanGap())
                self.assertEqual(tracker.advance(at._replace(**change)), gap)

    def test_RecordListsWhatIsMissing(self) -> None:
        def gap(segment: int, missing: int, is_exact: bool = True) -> bytes:
            event = stream_pb2.Event(instance_id=1, segment=segment)
            event.gap.missing_scans, event.gap.is_exact, event.gap.reason = missing, is_exact, stream_pb2.GAP_REASON_OVERRUN
            return event.SerializeToString()

        def block(*arguments: int, **fields: int) -> bytes:
            return block_of(*arguments, **fields).SerializeToString()

        begin, restarted = block(1, 0), status_of(instance_id=2).SerializeToString()
        cases: dict[str, tuple[list[bytes], tuple[dts.Missing, ...], int]] = {
            "nothing": ([begin, block(2, 10, scans=89), block(3, 99, scans=9)], (), 100),
            "on the way": ([begin, block(2, 10), block(6, 50), block(7, 60, scans=41)], (dts.Missing(20, 30, True, "lost"),), 70),
            "in the device": ([gap(0, 9), begin, gap(1, 80), block(2, 0, 10, 1)], (dts.Missing(10, 80, True, "overrun"),), 20),
            "in both": ([begin, gap(1, 60, False), block(4, 20, 10, 1)], (dts.Missing(10, 80, False, "overrun"),), 20),
            "in the device, not reported": ([begin, block(2, 0, 90, 1)], (dts.Missing(10, 0, False, "lost"),), 100),
            "a restart": ([begin, restarted, block(1, 0, 90, instance_id=2)], (dts.Missing(10, 0, False, "restart"),), 100),
            "in a segment not seen": ([begin, gap(2, 80), block(3, 0, 10, 2)], (dts.Missing(10, 80, False, "overrun"),), 20),
        }
        for name, (bodies, gaps, count) in cases.items():
            with self.subTest(name):
                collector, inbox = Collector(1.0), Inbox(lambda topic: True)
                inbox.accept([b"dtsd/status", status_of().SerializeToString()])
                for body in bodies:
                    self.assertFalse(collector.is_complete)
                    inbox.accept([b"dtsd/status" if body == restarted else b"rig/gap" if len(body) < 40 else b"rig/cop", body])
                    for item in iter(inbox.next, None):
                        collector.add(item)
                samples = collector.samples()
                self.assertTrue(collector.is_complete)
                self.assertEqual((samples.gaps, len(samples), len(samples.segments), len(samples.time_s)), (gaps, count, count, count))
                np.testing.assert_array_equal(samples["a_mm"], samples.scans)


    def test_RecordCountsGapsInScansOfTheStream(self) -> None:
        event = stream_pb2.Event(instance_id=1, segment=1)
        event.gap.missing_scans, event.gap.is_exact, event.gap.reason = 500, True, stream_pb2.GAP_REASON_UNPLUGGED
        collector, inbox = Collector(1.0, raw_rate_hz=1000.0), Inbox(lambda topic: True)
        inbox.accept([b"dtsd/status", status_of().SerializeToString()])
        for topic, body in ((b"rig/cop", block_of(1, 0)), (b"rig/gap", event), (b"rig/cop", block_of(2, 0, 39, 1)), (b"rig/cop", block_of(3, 39, 1, 1))):
            self.assertFalse(collector.is_complete)
            inbox.accept([topic, body.SerializeToString()])
            for item in iter(inbox.next, None):
                collector.add(item)

        self.assertTrue(collector.is_complete, "10 scans, 50 missing, 40 scans at 100 Hz")
        self.assertEqual(collector.samples().gaps, (dts.Missing(10, 50, True, "unplugged"),))

    def test_RecordEndsIfTheStreamIsAnother(self) -> None:
        collector, inbox = Collector(1.0), Inbox(lambda topic: True)
        blocks: list[dts.Block] = []
        for instance, channels in ((1, ("a_mm", "b_mm")), (2, ("b_mm", "a_mm"))):
            inbox.accept([b"dtsd/status", status_of(instance, channels).SerializeToString()])
            inbox.accept([b"rig/cop", block_of(1, 0, instance_id=instance).SerializeToString()])
            blocks += [item for item in iter(inbox.next, None) if isinstance(item, dts.Block)]
        collector.add(blocks[0])

        with self.assertRaisesRegex(dts.WrongState, "rig/cop has other channels"):
            collector.add(blocks[1])


class Values(unittest.TestCase):
    def test_ChannelsTimesAndUnits(self) -> None:
        inbox = Inbox(lambda topic: True)
        inbox.accept([b"dtsd/status", status_of().SerializeToString()])
        inbox.accept([b"rig/cop", block_of(1, 20).SerializeToString()])
        block = inbox.next()
        assert isinstance(block, dts.Block)

        self.assertEqual((block.rig, block.topic, block.units, block.rate, len(block)), ("rig", "rig/cop", ("mm", "mm"), Fraction(100), 10))
        np.testing.assert_array_equal(block["b_mm"], np.arange(20, 30) + np.float32(0.25))
        np.testing.assert_allclose(block.time_s, 0.2 + 1e-9 + np.arange(10) * 0.01, rtol=0, atol=1e-12)
        np.testing.assert_array_equal(block.utc.astype(np.int64), 10**18 + 200_000_001 + np.arange(10) * 10_000_000)
        np.testing.assert_array_equal(block.quality, [0, 4])
        with self.assertRaisesRegex(KeyError, "a_mm, b_mm"):
            block["c_mm"]

    def test_TimesBeyond64BitsAreUndefined(self) -> None:
        cases = {(0, 0): True, (9 * 10**18, 10**17): True, (2**63 - 1, 1): False, (-(2**63), 0): False, (0, 2**62): True, (0, -(2**63)): False}
        for (time_ns, offset_ns), is_known in cases.items():
            with self.subTest(time=time_ns, offset=offset_ns):
                (utc,) = to_utc(np.array([time_ns]), offset_ns)
                self.assertEqual(None if np.isnat(utc) else int(utc.astype(np.int64)), time_ns + offset_ns if is_known else None)

    def test_ErrorsAreThoseOfTheirCodes(self) -> None:
        for code in dts.ErrorCode:
            error = error_of(code, "what", "hint")
            self.assertEqual((error.code, type(error).__name__.lower(), str(error)), (code, code.name.replace("_", "").lower(), "what\n  hint"))
        self.assertEqual((type(error_of(99, "what")), str(error_of(99, "what"))), (dts.Failed, "what"))

    def test_EnumeratorsAndBitsAreWords(self) -> None:
        movement = stream_pb2.TrunkMovement(reasons=0b101)
        sway = stream_pb2.Sway(measures=[{"symbol": "MVELO", "value": 8.5, "unit": "mm/s"}])
        enum = stream_pb2.DESCRIPTOR.enum_types_by_name["Quality"]

        self.assertEqual(len(fields_of(movement)["reasons"]), 2)
        self.assertEqual(fields_of(sway)["measures"], {"MVELO": {"value": 8.5, "unit": "mm/s"}})
        self.assertEqual(fields_of(stream_pb2.DeviceChange(state=stream_pb2.DEVICE_STATE_STREAMING))["state"], "streaming")
        self.assertNotIn("state", fields_of(stream_pb2.DeviceChange()))
        self.assertEqual(fields_of(stream_pb2.DeviceChange(state=99))["state"], "unknown")
        self.assertEqual(fields_of(control_pb2.StatusSnapshot(notices=["a"], rigs=[{"rig": {"name": "b"}}]))["notices"], ["a"])
        self.assertEqual(fields_of(control_pb2.RigInfo(published=["a"], sensors=[{"label": "b"}]))["sensors"][0]["label"], "b")
        self.assertEqual(words_of_bits(enum, 0), [])
        self.assertEqual(words_of_bits(enum, stream_pb2.QUALITY_NO_CONTACT), ["no_contact"])

    def test_TimeoutsAndTopicsAreBounded(self) -> None:
        context: "zmq.Context[zmq.Socket[bytes]]" = zmq.Context()
        self.addCleanup(context.destroy, 0)
        given: dict[str, tuple[Callable[[Any], object], list[Any], list[Any]]] = {
            "wait": (check_timeout, [0.0, 86400.0], [-0.001, 86400.1, float("nan")]),
            "command": (lambda value: ControlClient(context, "tcp://127.0.0.1:9", value), [0.03, 86400.0], [0.029, 86400.1, float("nan")]),
            "topic": (lambda text: Subscriber(context, "tcp://127.0.0.1:9", ["a", text], bool).close(), ["x" * 200], ["x" * 201, "é" * 101]),
            "address": (lambda text: Subscriber(context, text, [], bool).close(), ["tcp://127.0.0.1:9"], ["", "tcp://"]),
            "record": (Collector, [1e-9, 1e9], [0.0, -1.0, float("nan"), float("inf")]),
        }
        for name, (use, good, bad) in given.items():
            for value in good + bad:
                with self.subTest(name, value=value):
                    if value in good:
                        use(value)
                    else:
                        self.assertRaises(dts.InvalidArgument, use, value)


class Answers(unittest.TestCase):
    def test_CommandsThatTakeLongerHaveTheirTime(self) -> None:
        context: "zmq.Context[zmq.Socket[bytes]]" = zmq.Context()
        self.addCleanup(context.destroy, 0)
        given = {"status": [3.0, 2.0, 30.0], "tare": [15.0, 2.0, 30.0], "stop_session": [20.0, 2.0, 30.0]}

        for command, expected in given.items():
            clients = [ControlClient(context, "tcp://127.0.0.1:9", timeout_s) for timeout_s in (None, 2.0, 30.0)]
            self.assertEqual([client._timeout_of(command) for client in clients], expected)

    def test_EnvelopesAreThoseOfARequester(self) -> None:
        body = control_pb2.Response(request_id="r").SerializeToString()
        longest = control_pb2.Response(error={"what": "x" * ((4 << 20) - 10)}).SerializeToString()
        self.assertEqual(len(longest), 4 << 20)
        cases = [([body], True), ([b"", body], True), ([b"x", body], False), ([b"", b"", body], False), ([], False), ([b"\xff"], False)]
        for frames, is_good in cases + [([b"", longest], True), ([longest + b"\x1a\0"], False)]:
            with self.subTest(frames=str(frames)[:60]):
                self.assertEqual(_response_of(frames) is not None, is_good)

    def test_OffsetsOfTheClockMayBeInAnyOrderAndDamaged(self) -> None:
        cases: list[tuple[list[tuple[float, float]], float]] = [
            ([], 10.0),
            ([(12.0, 2.0), (8.0, 1.0)], 11.5),
            ([(12.0, 2.0), (float("nan"), 9.0), (8.0, float("inf"))], 12.0),
        ]
        for offsets, expected in cases:
            self.assertEqual(_on_host(np.array([10.0]), offsets)[0], expected)


class Clock:
    """Time as a test wants it, in place of the module."""

    now_s = 0.0

    def monotonic(self) -> float:
        return self.now_s


class Reconnecting(unittest.TestCase):
    def test_OnlySilenceThatWasListenedToCounts(self) -> None:
        clock = Clock()
        with mock.patch("dts.subscriber.time", clock), zmq.Context() as context:
            subscriber = Subscriber(context, "tcp://127.0.0.1:9", [], bool)
            self.addCleanup(subscriber.close)
            sockets = [subscriber._socket]

            def looked(*pauses_s: float) -> bool:
                """Whether it connected anew after looking at these intervals."""
                for pause_s in pauses_s:
                    clock.now_s += pause_s
                    self.assertIsNone(subscriber.receive(0.0))
                sockets.append(subscriber._socket)
                return sockets[-1] is not sockets[-2]

            self.assertFalse(looked(1000.0, *[0.0] * 20))  # who was away must read first; looking often is no silence
            self.assertFalse(looked(*[0.625] * 6, 0.5))
            self.assertTrue(looked(0.2))
            self.assertFalse(looked(*[0.7] * 7))
            self.assertTrue(looked(0.7))
            self.assertAlmostEqual(subscriber.silence_s(), clock.now_s)
            subscriber.close()


class FindEndpoints(unittest.TestCase):
    def found(self, *wishes: str, system: str = "/nowhere", **environment: str) -> tuple[str, str]:
        found = dts.find_endpoints(*wishes, environment=environment, system_directory=system)
        return found.control, found.data

    def test_FirstThatIsGivenWins(self) -> None:
        def both(folder: str) -> tuple[str, str]:
            return f"ipc://{folder}/control.sock", f"ipc://{folder}/data.sock"

        with tempfile.TemporaryDirectory() as system:
            (Path(system) / "control.sock").touch()
            run = {"system": system, "XDG_RUNTIME_DIR": "/run/user/7/"}
            cases: list[tuple[tuple[str, ...], dict[str, str], tuple[str, str]]] = [
                (("ipc:///a/control.sock",), {"DTSD_CONTROL": "ipc:///b/control.sock", "DTSD_RUNTIME_DIR": "/c"}, both("/a")),
                (("", "ipc:///a/data.sock"), {"DTSD_CONTROL": "ipc:///b/control.sock"}, both("/a")),
                ((), {"DTSD_DATA": "ipc:///b/data.sock", "DTSD_RUNTIME_DIR": "/c"}, both("/b")),
                ((), {"DTSD_RUNTIME_DIR": "/c/", **run}, both("/c")),
                ((), run, both(system)),
                ((), {"XDG_RUNTIME_DIR": "/run/user/7/"}, both("/run/user/7/dtsd")),
                ((), {"XDG_RUNTIME_DIR": "relative"}, both(f"/tmp/dtsd-{os.geteuid()}")),
                ((), {}, both(f"/tmp/dtsd-{os.geteuid()}")),
                (("tcp://h:1",), {}, ("tcp://h:1", "")),  # says nothing about its sibling ...
                (("tcp://h:1",), {"DTSD_DATA": "tcp://h:2"}, ("tcp://h:1", "tcp://h:2")),  # ... which the environment may
                (("ipc:///a/other.sock",), {}, ("ipc:///a/other.sock", "")),
                (("ipc://@a",), {}, ("ipc://@a", "")),
                (("ipc:///" + "x" * 106,), {}, ("ipc:///" + "x" * 106, "")),
            ]
            for wishes, environment, expected in cases:
                with self.subTest(wishes=wishes, environment=environment):
                    self.assertEqual(self.found(*wishes, **environment), expected)

    def test_WhatIsNoAddressIsRefused(self) -> None:
        for address in ("floor", "ipc://relative", "tcp://host", "tcp://:5", "tcp://host:", "udp://host:5", "ipc:///" + "x" * 107):
            with self.subTest(address), self.assertRaises(dts.InvalidArgument):
                self.found(address)


if __name__ == "__main__":
    unittest.main()
