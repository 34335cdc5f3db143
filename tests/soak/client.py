# SPDX-License-Identifier: Apache-2.0
"""A client of the soak: client.py SECONDS TOPIC ... reads streams. Says "reading" when it has the first block, and at the end what
it got and what it missed, as JSON."""
import json
import sys
import time

import dts


def main(seconds: float, topics: list[str]) -> None:
    counts = {topic: {"scans": 0, "missed": 0} for topic in topics}
    with dts.connect(timeout=20) as daemon, daemon.stream(*topics, timeout=20) as stream:
        end_s = time.monotonic() + seconds
        for number, block in enumerate(stream):
            if number == 0:
                print("reading", flush=True)
            counts[block.topic]["scans"] += len(block)
            counts[block.topic]["missed"] += block.lost_scans
            if time.monotonic() > end_s:
                break
    print(json.dumps(counts))


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2:])
