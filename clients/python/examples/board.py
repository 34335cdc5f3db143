#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A program as a DAQ of dtsd: four channels at 100 Hz. One line for each scan: number of the scan, volts, checksum.

device = "exec:/usr/bin/python3 /etc/dtsd/board.py?format=lines&channels=4&rate_hz=100&counter=1"
"""
import functools
import math
import operator
import sys
import time

RATE_HZ = 100


def read_sensors(scan: int) -> list[float]:
    """Returns the volts of the sensors. Replace it by your own hardware."""
    return [2.5 + 0.5 * math.sin(scan / RATE_HZ + channel) for channel in range(4)]


def main() -> None:
    print("board.py: 4 channels", file=sys.stderr)  # dtsd writes these lines to its log
    start = time.monotonic()
    for scan in range(2**32):
        time.sleep(max(0.0, start + scan / RATE_HZ - time.monotonic()))
        text = ",".join([str(scan), *(f"{volts:.4f}" for volts in read_sensors(scan))])
        print(f"{text}*{functools.reduce(operator.xor, text.encode()):02X}", flush=True)


if __name__ == "__main__":
    main()
