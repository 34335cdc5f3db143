# SPDX-License-Identifier: Apache-2.0
"""Counts the scans missing before each block of a stream, by the rules of clients/libdts/loss_tracker.h."""
from typing import NamedTuple


class Position(NamedTuple):
    """Position of a block in its stream."""

    segment: int
    first_scan: int
    scan_count: int
    sequence: int


class ScanGap(NamedTuple):
    """Scans missing between two blocks."""

    scans: int = 0
    is_exact: bool = True
    is_consistent: bool = True  # False: the position went backwards, which no loss can explain


class LossTracker:
    """
    same segment             exact from the scan indices:   [0..9] [10..19]  (20..39 missing)  [40..49]   20
    next segment, and the
      sequence has no gap   no loss: the old segment ended with the last block
      sequence has a gap    the end of the old segment is unknown: at least the missing start of the new segment
    """

    def __init__(self) -> None:
        self._last: Position | None = None

    def advance(self, position: Position) -> ScanGap:
        """Returns the gap before `position`; an empty one before the first block."""
        last, self._last = self._last, position
        if last is None:
            return ScanGap()
        if position.sequence <= last.sequence or position.segment < last.segment:
            return ScanGap(0, is_exact=False, is_consistent=False)
        if position.segment > last.segment:
            is_adjacent = position.sequence == last.sequence + 1
            return ScanGap() if is_adjacent else ScanGap(position.first_scan, is_exact=False)
        expected = last.first_scan + last.scan_count
        if position.first_scan < expected:
            return ScanGap(0, is_exact=False, is_consistent=False)
        return ScanGap(position.first_scan - expected)
