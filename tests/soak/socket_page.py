# SPDX-License-Identifier: Apache-2.0
"""A page of the dashboard without a browser: socket_page.py URL GATEWAY_PID SECONDS TOPIC ...

Subscribes through dts-gateway's WebSocket, confirms each frame, and asks for the metrics now and then. Says "reading" when it has the first
frame, and at the end what it got and what the gateway has dropped for it, as JSON. A missed scan is excused if the gateway said with the same frame that it
dropped it, or if one of both waited for a core."""
import importlib.util
import json
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path
from types import ModuleType

import websocket
from starvation import EVERY_S, Starvation

from dts.loss import LossTracker, Position
from dts.v1 import stream_pb2

PROTO = Path(__file__).resolve().parent.parent.parent / "proto"
FRAMES_PER_SECOND = 30.0
METRICS_EVERY_S = 15.0  # as Prometheus does


def gateway_messages() -> ModuleType:
    """Returns the messages between browsers and dts-gateway, which are no part of the Python client."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["protoc", f"--proto_path={PROTO}", f"--python_out={folder}", "dts/v1/gateway.proto"], check=True)
        spec = importlib.util.spec_from_file_location("gateway_pb2", Path(folder) / "dts" / "v1" / "gateway_pb2.py")
        assert spec is not None and spec.loader is not None
        messages = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(messages)
    return messages


def main(url: str, gateway: int, seconds: float, topics: list[str]) -> None:
    messages = gateway_messages()
    counts = {topic: {"scans": 0, "missed": 0, "excused": 0} for topic in topics}
    trackers = {topic: LossTracker() for topic in topics}
    dropped_scans = metrics = 0
    starvation = Starvation((gateway,))
    page = websocket.create_connection(url.replace("http://", "ws://") + "/ws", timeout=60, origin=url, subprotocols=["dts.v1"])
    subscribe = messages.Subscribe(topics=topics, frames_per_second=FRAMES_PER_SECOND)
    page.send_binary(messages.FromBrowser(subscribe=subscribe).SerializeToString())
    first_ns = looked_s = asked_s = 0.0
    newest_ns = 0.0
    while newest_ns - first_ns < seconds * 1e9 or first_ns == 0.0:  # by the time of the data, as client.py
        answer = messages.FromGateway.FromString(page.recv())
        if not answer.HasField("frame"):
            continue
        page.send_binary(messages.FromBrowser(painted=messages.Painted(frame=answer.frame.number)).SerializeToString())
        now_s = time.monotonic()
        is_excused = False
        dropped = answer.frame.dropped_scans_total - dropped_scans  # since the frame before, of all topics
        if now_s - looked_s >= EVERY_S or answer.frame.dropped_scans_total != dropped_scans:
            looked_s = now_s
            is_excused = starvation.is_excuse()
        dropped_scans = answer.frame.dropped_scans_total
        for carried in answer.frame.messages:
            if carried.topic not in counts:
                continue  # status and events, which every page gets
            block = stream_pb2.StreamBlock.FromString(carried.message)
            if first_ns == 0.0:
                print("reading", flush=True)
                first_ns = block.host_time_ns
            newest_ns = max(newest_ns, block.host_time_ns)
            missed = trackers[carried.topic].advance(Position(block.segment, block.first_scan, block.scan_count, block.sequence)).scans
            count = counts[carried.topic]
            count["scans"] += block.scan_count
            count["missed"] += missed
            explained = missed if missed and (is_excused or starvation.is_excuse()) else min(missed, dropped)
            dropped -= min(missed, dropped)
            count["excused"] += explained
        if now_s - asked_s >= METRICS_EVERY_S:
            asked_s = now_s
            with urllib.request.urlopen(f"{url}/metrics", timeout=60) as response:
                metrics += b"dts_up 1" in response.read()
    page.close()
    print(json.dumps({"counts": counts, "dropped_scans": dropped_scans, "metrics": metrics, "starved_s": starvation.most_s}))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), sys.argv[4:])
