# SPDX-License-Identifier: Apache-2.0
"""A subscriber that somebody wrote with pyzmq and the .proto files alone, without the package dts: the local socket must serve it."""
import unittest

import zmq
from support import WithDaemon

from dts.v1 import control_pb2, stream_pb2


class PlainZmq(WithDaemon):
    def setUp(self) -> None:
        super().setUp()
        self.context = zmq.Context()
        self.addCleanup(self.context.destroy, 0)

    def subscribe(self, *prefixes: str) -> zmq.Socket:
        socket = self.context.socket(zmq.SUB)
        self.addCleanup(socket.close, 0)
        socket.setsockopt(zmq.RCVTIMEO, 60_000)
        socket.connect(f"ipc://{self.process.folder}/data.sock")
        for prefix in prefixes:
            socket.setsockopt_string(zmq.SUBSCRIBE, prefix)
        return socket

    def test_BlocksFollowEachOther(self) -> None:
        socket = self.subscribe("floor/cop")
        sequences = []
        for _ in range(50):
            topic, body = socket.recv_multipart()
            self.assertEqual(topic, b"floor/cop")
            sequences.append(stream_pb2.StreamBlock.FromString(body).sequence)
        self.assertEqual(sequences, list(range(sequences[0], sequences[0] + 50)))

    def test_ANewSubscriberGetsTheStatusAtOnce(self) -> None:
        # requirement: PUB-5
        socket = self.subscribe("dtsd/status")
        topic, body = socket.recv_multipart()
        self.assertEqual(topic, b"dtsd/status")
        self.assertEqual({rig.rig.name for rig in control_pb2.StatusSnapshot.FromString(body).rigs}, {"floor", "chair"})

    def test_APollerAndChangingTopics(self) -> None:
        socket = self.subscribe("floor/cop", "chair/")
        poller = zmq.Poller()
        poller.register(socket, zmq.POLLIN)
        seen: set[bytes] = set()
        while not {b"floor/cop", b"chair/transient"} <= seen:
            self.assertTrue(poller.poll(60_000))
            seen.add(socket.recv_multipart(zmq.NOBLOCK)[0])
        socket.setsockopt_string(zmq.UNSUBSCRIBE, "chair/")
        in_a_row = 0
        while in_a_row < 20:  # what was on its way comes first
            in_a_row = in_a_row + 1 if socket.recv_multipart()[0] == b"floor/cop" else 0


if __name__ == "__main__":
    unittest.main()
