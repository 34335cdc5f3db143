# SPDX-License-Identifier: Apache-2.0
"""A client of the soak: client.py [--behind PID] SECONDS TOPIC ... reads so many seconds of streams; with DTSD_KEY through dts-relay, whose
process is PID. Says "reading" when it has the first block, and at the end what it got, what it missed and how late it was, as JSON."""
import argparse
import json
import time

from starvation import EVERY_S, Starvation

import dts


def main(seconds: float, topics: list[str], behind: list[int]) -> None:
    counts = {topic: {"scans": 0, "missed": 0, "excused": 0} for topic in topics}
    oldest_s = 0.0
    starvation = Starvation(tuple(behind))
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
                is_excused = starvation.is_excuse()
                count["missed"] += block.lost_scans
                count["excused"] += block.lost_scans if is_excused else 0
            if block.time_s[-1] > end_s:  # by the time of the data: a client that is late reads as much as one in time
                break
    print(json.dumps({"counts": counts, "oldest_s": oldest_s, "starved_s": starvation.most_s}))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--behind", type=int, action="append", default=[])
    parser.add_argument("seconds", type=float)
    parser.add_argument("topics", nargs="+")
    options = parser.parse_args()
    main(options.seconds, options.topics, options.behind)
