# SPDX-License-Identifier: Apache-2.0
"""A client of the soak: client.py SECONDS TOPIC ... reads so many seconds of streams. Says "reading" when it has the first block, and at
the end what it got, what it missed and how late it was, as JSON."""
import collections
import json
import os
import sys
import time
from pathlib import Path

import dts

QUEUE_S = 2.0  # the daemon keeps so much for a client that does not read
LOOK_BACK_S = 2 * QUEUE_S  # a loss shows after what the queue had kept was read
EVERY_S = 0.1


def waited_s() -> dict[str, float]:
    """How long each thread of this process has waited for a core since it began. The kernel counts that, so a late daemon is not in it."""
    threads = Path("/proc/self/task")
    if not (threads / str(os.getpid()) / "schedstat").exists():
        return {"": 0.0}  # a kernel that does not count: no loss is excused
    return {thread: int((threads / thread / "schedstat").read_text().split()[1]) * 1e-9 for thread in os.listdir(threads)}


class Starvation:
    """How long this process waited for a core in the last LOOK_BACK_S: the longest wait of its threads."""

    def __init__(self) -> None:
        self._samples = collections.deque([(time.monotonic(), waited_s())])
        self.most_s = 0.0

    def look(self) -> float:
        now_s = time.monotonic()
        while len(self._samples) > 1 and self._samples[1][0] < now_s - LOOK_BACK_S:
            self._samples.popleft()
        before, now = self._samples[0][1], waited_s()
        if now_s - self._samples[-1][0] >= EVERY_S:
            self._samples.append((now_s, now))
        starved_s = max(waited - before.get(thread, 0.0) for thread, waited in now.items())
        self.most_s = max(self.most_s, starved_s)
        return starved_s


def main(seconds: float, topics: list[str]) -> None:
    counts = {topic: {"scans": 0, "missed": 0, "excused": 0} for topic in topics}
    oldest_s = 0.0
    starvation = Starvation()
    looked_s = end_s = 0.0
    with dts.connect(timeout=60) as daemon, daemon.stream(*topics, timeout=60) as stream:
        for number, block in enumerate(stream):
            if number == 0:
                print("reading", flush=True)
                end_s = block.time_s[-1] + seconds
            count = counts[block.topic]
            count["scans"] += len(block)
            now_s = time.monotonic()
            oldest_s = max(oldest_s, now_s - block.time_s[-1])
            if block.lost_scans > 0 or now_s - looked_s >= EVERY_S:
                looked_s = now_s
                is_starved = starvation.look() > QUEUE_S
                count["missed"] += block.lost_scans
                count["excused"] += block.lost_scans if is_starved else 0
            if block.time_s[-1] > end_s:  # by the time of the data: a client that is late reads as much as one in time
                break
    print(json.dumps({"counts": counts, "oldest_s": oldest_s, "starved_s": starvation.most_s}))


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2:])
