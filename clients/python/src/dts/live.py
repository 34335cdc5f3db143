# SPDX-License-Identifier: Apache-2.0
"""The results of `Daemon.stream`, `Daemon.events` and `Daemon.record`."""
import dataclasses
import math
from types import TracebackType
from typing import Generic, Self, TypeVar

import numpy as np

from .errors import InvalidArgument, Timeout, Unreachable, WrongState
from .events import Event
from .streams import Block, Missing, Samples, scans_at
from .subscriber import Statistics, Subscriber, check_timeout

_Item = TypeVar("_Item", Block, Event)
_MOST_SEGMENTS = 1000  # looked at in one seam, whatever a peer says
_SILENCE_S = 3.0  # the daemon's status comes every second: after this nobody is there


def no_news(subscriber: Subscriber, of_what: str, timeout_s: float) -> Timeout | Unreachable:
    """Returns the reason why no block or event arrived in time."""
    silence_s = subscriber.silence_s()
    if silence_s > _SILENCE_S:
        return Unreachable(
            f"no {of_what}: the daemon has sent nothing for {silence_s:.1f} s",
            "check that dtsd runs: systemctl status dtsd; iterate again to wait for its return",
        )
    return Timeout(f"no {of_what} within {timeout_s:g} s", "check that the device streams: daemon.status(); or give a longer timeout")


class _Live(Generic[_Item]):
    """An endless iterator. After `Timeout` or `Unreachable`, iterate again: the client reconnects automatically.

    Thread: one at a time. Leave the loop with `break`, then call `close`; or use the iterator in a `with`.
    """

    _type: type[_Item]

    def __init__(self, subscriber: Subscriber, of_what: str, timeout: float) -> None:
        self._subscriber = subscriber
        self._of_what = of_what
        self._timeout_s = check_timeout(timeout)

    @property
    def statistics(self) -> Statistics:
        """Counters since the subscription."""
        return self._subscriber.statistics

    def close(self) -> None:
        """Ends the subscription."""
        self._subscriber.close()

    def __iter__(self) -> Self:
        return self

    def __next__(self) -> _Item:
        """Waits for the next item. Raises `Timeout` if none arrives in time, and `Unreachable` if the daemon sends nothing at all."""
        item = self._subscriber.receive(self._timeout_s)
        if isinstance(item, self._type):
            return item
        raise no_news(self._subscriber, self._of_what, self._timeout_s)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()


class Stream(_Live[Block]):
    """The blocks of streams since the subscription. Keeps up to 8192 messages for a slow reader, then drops blocks; `Block.lost_scans`
    counts them.
    """

    _type = Block


class EventStream(_Live[Event]):
    """The events of rigs since the subscription. The latest device and session event of each rig arrive first."""

    _type = Event


@dataclasses.dataclass(frozen=True)
class _Seam:
    """Where a block does not continue the one before."""

    index: int
    before: Block
    after: Block


class Collector:
    """Joins blocks until they cover a given time of the stream, gaps included.

    `raw_rate_hz` is the rate of the rig's device: gap events count its scans. 0: that of the stream.
    """

    def __init__(self, seconds: float, raw_rate_hz: float = 0.0) -> None:
        if not (math.isfinite(seconds) and seconds > 0.0):
            raise InvalidArgument(f"cannot record {seconds} s: give a positive number of seconds")
        self._seconds = seconds
        self._raw_rate_hz = raw_rate_hz
        self._blocks: list[Block] = []
        self._seams: list[_Seam] = []
        self._gap_events: dict[tuple[int, int], Event] = {}  # gap events by daemon and segment
        self._scans = 0
        self._missing = 0

    @property
    def is_complete(self) -> bool:
        return bool(self._blocks) and self._scans + self._missing >= self._wanted()

    def add(self, item: Block | Event) -> None:
        if isinstance(item, Event):
            if item.message is not None and item.kind == "gap":
                self._gap_events[item.message.instance_id, item.segment] = item
                self._missing += self._of_stream(item.fields["missing_scans"]) if self._blocks else 0
            return
        if self._blocks:
            before = self._blocks[-1]
            if item.format != before.format:
                raise WrongState(
                    f"{item.topic} has other channels or another rate since the daemon was restarted", "record again: daemon.record(...)"
                )
            if item.is_restart or item.segment != before.segment or item.lost_scans > 0:
                self._seams.append(_Seam(self._scans, before, item))
            self._missing += item.lost_scans
        self._blocks.append(item)
        self._scans += len(item)

    def samples(self) -> Samples:
        blocks = self._blocks
        last = max(self._wanted() - self._missing, 0)
        count = min(self._scans, max(last, self._scans - len(blocks[-1]) + 1))
        form = blocks[0].format
        return Samples(
            name=form.topic,
            channels=form.channels,
            units=form.units,
            rate=form.rate,
            delay_s=form.delay_s,
            values=np.concatenate([block.values for block in blocks])[:count],
            segments=np.repeat(np.array([block.segment for block in blocks], np.int64), [len(block) for block in blocks])[:count],
            scans=np.concatenate([block.scans for block in blocks])[:count],
            time_s=np.concatenate([block.time_s for block in blocks])[:count],
            utc_minus_monotonic_ns=blocks[0].utc_minus_monotonic_ns,
            gaps=tuple(self._missing_at(seam) for seam in self._seams),
        )

    def _of_stream(self, raw_scans: int) -> int:
        """Returns how many scans of the stream fit into the time of scans of the device."""
        return scans_at(raw_scans, self._raw_rate_hz, float(self._blocks[0].rate))

    def _wanted(self) -> int:
        return max(round(self._seconds * self._blocks[0].rate), 1)

    def _missing_at(self, seam: _Seam) -> Missing:
        """Events report scans that the device lost; blocks report scans lost in transit."""
        after = seam.after
        if after.is_restart:
            return Missing(seam.index, 0, False, "restart")
        first = max(seam.before.segment + 1, after.segment - _MOST_SEGMENTS)
        expected = [self._gap_events.get((after.instance_id, segment)) for segment in range(first, after.segment + 1)]
        known = [event for event in expected if event is not None]
        scans = after.lost_scans + self._of_stream(sum(event.fields["missing_scans"] for event in known))
        is_exact = after.is_loss_exact and len(known) == len(expected) and all(event.fields["is_exact"] for event in known)
        return Missing(seam.index, scans, is_exact, known[-1].fields.get("reason", "unknown") if known else "lost")
