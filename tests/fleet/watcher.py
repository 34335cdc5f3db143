# SPDX-License-Identifier: Apache-2.0
"""Somebody who watches rigs with the key of a dashboard, without the dashboard."""
from centre import Centre
from gateway import admit
from nats_client import Letter, NatsClient, NKey
from protobuf import message


class Watcher:
    """Keeps all live data of all clinics that arrive. Thread: one."""

    def __init__(self, centre: Centre) -> None:
        key = NKey.of_file(admit(centre, "watcher"))
        self._inbox = f"_DASHBOARD.{key.public}.watcher"
        self._client = NatsClient(centre.nats_port, centre.folder / "ca.pem", key)
        self._client.subscribe("dts.v1.*.live.>")
        self._client.wait_for_server()

    def ask(self, clinic: str, topics: list[str]) -> None:
        """Asks a clinic for these topics, for the next 10 s."""
        request = b"".join(message({1: topic}) for topic in topics) + message({2: "ann"})
        self._client.publish(f"dts.v1.{clinic}.down.live", request, self._inbox)

    def letters(self) -> list[Letter]:
        """Returns what has arrived since the last call."""
        return [self._client.letters.get() for _ in range(self._client.letters.qsize())]
