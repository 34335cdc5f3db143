# SPDX-License-Identifier: Apache-2.0
"""Checks every code, counter and tick of a long run of the firmware in simavr. scripts/firmware-soak runs it."""

import sys
import time

from board_host import DESCRIPTOR, LOST, STOP, Board, ScanChecker

RATE = 1000
PERIOD = 2000
STREAMING = 8

seconds = float(sys.argv[1])
with Board("dts-firmware.elf", "--fast") as board:
    board.open()
    board.describe()
    board.start()
    while not board.until(DESCRIPTOR)[-1]["flags"] & STREAMING:
        pass
    board.damaged = 0
    checker = ScanChecker(PERIOD)
    descriptors = 0
    begun = time.monotonic()
    while checker.scans + checker.lost < seconds * RATE:
        frame = board.frame()
        checker.take(frame)
        descriptors += frame["kind"] == DESCRIPTOR
    board.send(STOP)
    for frame in board.until(LOST, reason=4):
        checker.take(frame)
    stack = board.ask("stack")
print(f"{checker.scans} scans x 4 channels at {RATE} Hz ({checker.scans / RATE:.0f} s of the board) in {time.monotonic() - begun:.0f} s: "
      f"every code, counter and tick exact; {checker.lost} scans lost, {board.damaged} frames damaged, {descriptors} descriptors, "
      f"at most {stack} bytes of stack")
sys.exit(1 if checker.lost or board.damaged else 0)
