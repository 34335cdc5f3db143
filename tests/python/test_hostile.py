# SPDX-License-Identifier: Apache-2.0
import random
import socket
import tempfile
import time
import unittest
from collections.abc import Callable
from unittest import mock

import numpy as np
from support import PATIENCE_S, FakeDaemon, block_of, first, status_of, wait_for

import dts
from dts.inbox import Inbox
from dts.v1 import control_pb2, stream_pb2


class WithFake(unittest.TestCase):
    def setUp(self) -> None:
        self.fake = FakeDaemon()
        self.addCleanup(self.fake.close)
        self.daemon = self.fake.connect()
        self.addCleanup(self.daemon.close)


class Losses(WithFake):
    def test_SkippedBlocksAreCountedAndThoseThatGoBack(self) -> None:
        stream = self.daemon.stream("rig/cop")
        self.fake.publish_blocks(block_of(1, 0), block_of(2, 10), block_of(6, 50), block_of(7, 60), block_of(5, 50))

        blocks = first(stream, 5)

        self.assertEqual([block.lost_scans for block in blocks], [0, 0, 30, 0, 0])
        self.assertEqual([block.is_loss_exact for block in blocks], [True] * 4 + [False])
        self.assertEqual(stream.statistics.inconsistent, 1)

    def test_AnotherInstanceIsARestart(self) -> None:
        stream = self.daemon.stream("rig/cop")
        self.fake.publish_blocks(block_of(9, 90))
        next(stream)
        status = status_of(instance_id=2, channels=("c_mm", "d_mm"))
        self.fake.publish_blocks(block_of(1, 0, instance_id=2))
        self.fake.publish("dtsd/status", status.SerializeToString())

        block = next(stream)

        self.assertEqual((block.is_restart, block.is_loss_exact, block.channels), (True, False, ("c_mm", "d_mm")))


def damaged_blocks() -> dict[str, bytes]:
    two, other = block_of(2, 10), block_of(2, 10)
    two.scan_count = 11
    other.channel_count, other.scan_count, other.quality = 4, 5, b"\0\0\0\0"
    return {
        "too many scans for its values": two.SerializeToString(),
        "channels that the format does not have": other.SerializeToString(),
        "no protobuf": b"\xff" * 40,
        "too long": b"\0" * (2 << 20),
    }


class Malformed(WithFake):
    def test_EachIsIgnoredAndCounted(self) -> None:
        good = block_of(1, 0).SerializeToString()
        cases = [(name, "rig/cop", (body,), 1) for name, body in damaged_blocks().items()]
        cases += [("three frames", "rig/cop", (good, b"more"), 1), ("a topic that begins the same", "rig/cop2", (good,), 0)]
        for name, topic, bodies, malformed in cases:
            with self.subTest(name), self.daemon.stream("rig/cop") as stream:
                self.fake.publish_blocks(block_of(1, 0))
                self.fake.publish(topic, *bodies)
                self.fake.publish_blocks(block_of(2, 10))

                blocks = first(stream, 2)

                self.assertEqual([block.first_scan for block in blocks], [0, 10])
                self.assertEqual(stream.statistics.malformed, malformed)

    def test_RandomBytesNeverRaise(self) -> None:
        generator = random.Random(7)
        inbox = Inbox(lambda topic: True)
        good = block_of(1, 0).SerializeToString()
        event = stream_pb2.Event(instance_id=1, marker=stream_pb2.Marker(text="x")).SerializeToString()
        topics = (b"rig/cop", b"rig/marker", b"rig/gap", b"dtsd/status", b"\xff\xfe", b"")
        seeds = (good, event, status_of().SerializeToString(), b"")

        for _ in range(5000):
            body = bytearray(generator.choice(seeds))
            for _ in range(generator.randrange(4)):
                if body:
                    body[generator.randrange(len(body))] = generator.randrange(256)
            inbox.accept([generator.choice(topics), bytes(body)])
            while inbox.next() is not None:
                pass

        self.assertGreater(inbox.statistics.malformed, 0)
        self.assertGreater(inbox.statistics.messages, 0)


class BeforeTheStatus(unittest.TestCase):
    def test_WhatWaitsIsBoundedAndCounted(self) -> None:
        inbox = Inbox(lambda topic: True)
        blocks = 20_000
        for sequence in range(blocks):
            inbox.accept([b"rig/cop", block_of(sequence + 1, sequence * 10).SerializeToString()])

        inbox.accept([b"dtsd/status", status_of().SerializeToString()])
        received = 0
        lost = 0
        while (item := inbox.next()) is not None:
            assert isinstance(item, dts.Block)
            received += len(item)
            lost += item.lost_scans

        self.assertEqual(received + lost, blocks * 10)
        self.assertEqual(received, 16384 * 10)

    def test_WhatWaitsIsBoundedInBytes(self) -> None:
        inbox = Inbox(lambda topic: True)
        event = stream_pb2.Event(instance_id=1, marker=stream_pb2.Marker(text="x" * ((1 << 20) - 20))).SerializeToString()
        for _ in range(33):
            inbox.accept([b"rig/marker", event])
        inbox.accept([b"dtsd/status", status_of().SerializeToString()])

        waiting = 0
        while inbox.next() is not None:
            waiting += 1

        self.assertEqual((waiting, inbox.statistics.dropped_events, inbox.statistics.messages), (32, 1, 34))

    def test_NewsIsWhatIsNotRepeatedAndOfATopicThatIsKnown(self) -> None:
        inbox = Inbox(lambda topic: topic != "rig/unwanted")
        inbox.accept([b"dtsd/status", status_of().SerializeToString()])
        device = stream_pb2.Event(instance_id=1, host_time_ns=5, device=stream_pb2.DeviceChange(uri="a")).SerializeToString()
        marker = stream_pb2.Event(instance_id=1, marker=stream_pb2.Marker(text="x")).SerializeToString()
        block = block_of(1, 0).SerializeToString()
        for topic, body in (("device", device), ("device", device), ("marker", marker), ("marker", marker), ("gap", marker), ("raw", block), ("unwanted", block)):
            inbox.accept([f"rig/{topic}".encode(), body])

        received = list(iter(inbox.next, None))

        self.assertEqual([item.kind for item in received if isinstance(item, dts.Event)], ["device", "marker", "marker"])
        self.assertEqual((inbox.statistics.malformed, inbox.statistics.unknown_topics, inbox.statistics.restarts), (1, 1, 0))
        self.assertEqual((received[0].time_s, np.isnat(received[1].utc)), (5e-9, True))


class Closed(WithFake):
    def test_ClosedDaemonSaysSo(self) -> None:
        stream = self.daemon.stream("rig/cop")
        self.fake.publish_blocks(block_of(1, 0))
        next(stream)
        self.daemon.close()

        commands: dict[str, Callable[[], object]] = {
            "status": self.daemon.status,
            "stream": lambda: self.daemon.stream("rig/cop"),
            "record": lambda: self.daemon.record("rig/cop", 1.0),
            "iterate": lambda: next(stream),
            "mark": lambda: self.daemon.mark("late"),
        }
        for name, command in commands.items():
            with self.subTest(name), self.assertRaisesRegex(dts.InvalidArgument, "daemon is closed"):
                command()
        stream.close()
        self.daemon.close()


class FullQueue(WithFake):
    def test_DaemonThatLeavesDoesNotEndTheProcess(self) -> None:
        with mock.patch("dts.subscriber._QUEUE_MESSAGES", 10):
            unread = self.daemon.stream("rig/cop")
        read = self.daemon.stream("rig/cop")
        self.fake.publish_blocks(*(block_of(number, number * 10) for number in range(1, 101)))
        first(read, 100)
        self.fake.close()

        with self.assertRaises(dts.Unreachable):  # by then, every timer of the other connection has run
            next(read)

        self.assertEqual([block.first_scan for block in first(unread, 10)], list(range(10, 110, 10)))


class Answers(unittest.TestCase):
    def setUp(self) -> None:
        self.fake = FakeDaemon()
        self.addCleanup(self.fake.close)

    def answered_by(self, *bodies: bytes, timeout: float = PATIENCE_S) -> dts.Error:
        self.fake.answer = lambda request: list(bodies)
        with self.assertRaises(dts.Error) as told:
            self.fake.connect(timeout)
        return told.exception

    def test_NobodyAnswersIsUnreachableAfterAllTriesWithOneId(self) -> None:
        # A try whose connection is not made yet when the next one begins is never sent: a busy machine needs a longer time.
        for timeout in (0.3, 3.0, 30.0):
            self.fake.requests.clear()
            error = self.answered_by(timeout=timeout)
            self.assertIsInstance(error, dts.Unreachable)
            try:
                wait_for(lambda: len(self.fake.requests) == 3, "the fake daemon has read every try", 5.0)
                break
            except AssertionError:
                continue

        self.assertEqual(len(self.fake.requests), 3)
        self.assertEqual(len({request.request_id for request in self.fake.requests}), 1)

    def test_StrangersAnswersAreCountedNotBelieved(self) -> None:
        strange = control_pb2.Response(request_id="other", status=status_of()).SerializeToString()

        # The client waits to the end: a short time is tried first, and a longer one where the fake daemon did not get its turn.
        for timeout in (0.3, 3.0, 30.0):
            error = self.answered_by(b"\xff\xff", strange, timeout=timeout)
            if "other messages arrived" in error.what:
                break

        self.assertRegex(error.what, "other messages arrived")

    def test_AnswerToAnotherCommandIsDamaged(self) -> None:
        self.fake.answer = lambda request: [
            control_pb2.Response(request_id=request.request_id, mark=control_pb2.MarkResponse()).SerializeToString()
        ]

        with self.assertRaises(dts.DataDamaged):
            self.fake.connect()

    def test_StatusThatMakesNoSenseIsDamaged(self) -> None:
        self.fake.status = status_of(channels=())

        with mock.patch.object(dts.Daemon, "close", autospec=True, side_effect=dts.Daemon.close) as close:
            with self.assertRaises(dts.DataDamaged):
                self.fake.connect()

        close.assert_called_once()

    def test_UnknownErrorCodeIsAFailure(self) -> None:
        refusal = control_pb2.Response(error=control_pb2.Error(what="no"))
        refusal.error.code = 99  # type: ignore[assignment]

        error = self.answered_by(refusal.SerializeToString())

        self.assertEqual((type(error), error.what), (dts.Failed, "no"))

    def test_RefusalCannotDriveATerminal(self) -> None:
        refusal = control_pb2.Response(error=control_pb2.Error(what="a\x1b[2Jb\x9bc\u202ed\u061ce", hint="try\n\u2066this"))

        self.assertEqual(str(self.answered_by(refusal.SerializeToString())), "a [2Jb c d e\n  try  this")

    def test_LateAnswerIsNotThatOfTheNextCommand(self) -> None:
        with self.fake.connect() as daemon:
            before = self.fake.requests[-1]
            self.fake.answer = lambda request: self.fake.proper(before) + self.fake.proper(request)

            self.assertEqual(daemon.status().version, "fake")


class Unreachable(unittest.TestCase):
    def test_NoSocketAndALeftoverAreReportedAtOnceWithWhatToTry(self) -> None:
        begun_s = time.monotonic()
        with tempfile.TemporaryDirectory(dir="/tmp") as folder:
            with self.assertRaisesRegex(dts.Unreachable, "does not exist(.|\n)*start it"):
                dts.connect(control=f"ipc://{folder}/control.sock", timeout=600)
            with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
                listener.bind(f"{folder}/control.sock")
            with self.assertRaisesRegex(dts.Unreachable, "no program listens"):
                dts.connect(control=f"ipc://{folder}/control.sock", timeout=600)

        self.assertLess(time.monotonic() - begun_s, 300.0)  # it does not wait for an answer


if __name__ == "__main__":
    unittest.main()
