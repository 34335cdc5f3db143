# SPDX-License-Identifier: Apache-2.0
"""The hostile peers of dts-relay in the soak: hostile_remote.py KEY_FILE, until SIGTERM; then prints how often each attack ran, as JSON.

Strangers send junk, stop in the middle of a handshake, come with unknown keys, and open connections without a word. A viewer whose key is
valid subscribes and sends invalid requests in floods. Each attack is short and is followed by a rest, in which all its connections are
closed: so a descriptor that stays open is seen."""
import json
import random
import signal
import socket
import sys
import time
from collections.abc import Callable

import zmq
from judge import HELD

import dts

REST_S = 0.3


def greeting(mechanism: bytes) -> bytes:
    """Returns the greeting of ZMTP 3.1 (ZeroMQ RFC 37): signature, version, mechanism."""
    return (b"\xff" + bytes(8) + b"\x7f\x03\x01" + mechanism).ljust(64, b"\0")


class Attacker:
    def __init__(self, key: dts.Key) -> None:
        self._key = key
        self._endpoints = (key.control, key.data)
        self._ports = [int(endpoint.rpartition(":")[2]) for endpoint in self._endpoints]
        self._chance = random.Random(7)
        self._context: "zmq.Context[zmq.Socket[bytes]]" = zmq.Context()

    def junk(self) -> None:
        noise = self._chance.randbytes(64 * 1024)
        for port in self._ports:
            for before in (b"", greeting(b"CURVE"), greeting(b"NULL") + b"\x06\0\0\0\0\x04\0\0\0"):  # the last announces a command of 64 MB
                self._strangers(port, 1, before + noise)

    def half_handshakes(self) -> None:
        for port in self._ports:
            self._strangers(port, HELD["dts-relay"] // 2, greeting(b"CURVE") + b"\x04\xc8\x05HELLO" + 40 * b"x")

    def silent_connections(self) -> None:
        for port in self._ports:
            self._strangers(port, HELD["dts-relay"], b"")

    def unknown_keys(self) -> None:
        for endpoint in self._endpoints:
            public, secret = zmq.curve_keypair()
            self._peers(endpoint, 10, public, secret, lambda peer: None)

    def subscriptions(self) -> None:
        def subscribe(peer: "zmq.Socket[bytes]") -> None:
            for number in range(1000):
                peer.send(b"\1" + str(number).encode().ljust(200 + number % 240, b"x"), zmq.NOBLOCK)

        self._peers(self._key.data, 1, self._key.public_key.encode(), self._key.secret_key.encode(), subscribe)

    def requests(self) -> None:
        def request(peer: "zmq.Socket[bytes]") -> None:
            for _ in range(500):
                peer.send(self._chance.choice((b"\x0a\x04\xc3\x28\xff\xfe", self._chance.randbytes(300))), zmq.NOBLOCK)

        self._peers(self._key.control, 1, self._key.public_key.encode(), self._key.secret_key.encode(), request)

    def _strangers(self, port: int, count: int, bytes_: bytes) -> None:
        strangers = []
        try:
            for _ in range(count):
                strangers.append(socket.create_connection(("127.0.0.1", port), timeout=10))
                strangers[-1].settimeout(0.2)  # a peer that does not read must not stop its attacker
                try:
                    strangers[-1].sendall(bytes_)
                except OSError:
                    pass  # the relay hung up, as it should
            time.sleep(0.1)
        finally:
            for stranger in strangers:
                stranger.close()

    def _peers(self, endpoint: str, count: int, public: bytes, secret: bytes, attack: Callable[["zmq.Socket[bytes]"], None]) -> None:
        peers = [self._context.socket(zmq.XSUB if endpoint == self._key.data else zmq.DEALER) for _ in range(count)]
        for peer in peers:
            peer.linger = 0
            peer.sndhwm = 0
            peer.curve_serverkey = self._key.server_public_key.encode()
            peer.curve_publickey, peer.curve_secretkey = public, secret
            peer.connect(endpoint)
            attack(peer)
        time.sleep(0.5)
        for peer in peers:
            peer.close()


class Stopped(Exception):
    pass


def stop(*_: object) -> None:
    raise Stopped


def main(key_file: str) -> None:
    signal.signal(signal.SIGTERM, stop)
    attacker = Attacker(dts.read_key(key_file))
    attacks = (
        attacker.junk, attacker.half_handshakes, attacker.silent_connections, attacker.unknown_keys, attacker.subscriptions, attacker.requests,
    )
    counts = {attack.__name__: 0 for attack in attacks}
    try:
        while True:
            for attack in attacks:
                attack()
                counts[attack.__name__] += 1
                time.sleep(REST_S)
    except Stopped:
        print(json.dumps(counts))


if __name__ == "__main__":
    main(sys.argv[1])
