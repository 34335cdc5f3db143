# SPDX-License-Identifier: Apache-2.0
"""The subscriber without its socket: decodes and checks messages, and counts missing scans."""
import collections
import dataclasses
from collections.abc import Callable
from fractions import Fraction

import numpy as np
from google.protobuf.message import DecodeError

from .errors import DataDamaged
from .events import Event, fields_of
from .loss import LossTracker, Position
from .options import EVENT_TOPICS, kind_of, topic_of
from .streams import Block, StreamFormat
from .v1 import control_pb2, stream_pb2
from .wire_check import MAX_MESSAGE_BYTES, check_status, is_block

STATUS_TOPIC = "dtsd/status"
_MAX_WAITING = 16384
_MAX_WAITING_BYTES = 32 << 20


@dataclasses.dataclass
class Statistics:
    """Counters since the subscription."""

    messages: int = 0  # valid messages
    malformed: int = 0  # ignored: messages that the protocol does not allow
    unknown_topics: int = 0  # ignored: topics that neither this version nor the daemon's status knows
    inconsistent: int = 0  # blocks whose position goes backwards; they are delivered, their loss is unknown
    dropped_events: int = 0  # events dropped because the queue was full before the daemon's status arrived
    restarts: int = 0  # restarts of the daemon
    # Connections that the daemon ended, for example because this program read too slowly for an event: events may be missing there.
    interruptions: int = 0


@dataclasses.dataclass
class _Topic:
    tracker: LossTracker = dataclasses.field(default_factory=LossTracker)
    lost_scans: int = 0  # not yet delivered to the caller
    is_loss_exact: bool = True
    is_restart: bool = False
    last_retained: bytes = b""


@dataclasses.dataclass(frozen=True)
class _Waiting:
    topic: str
    message: stream_pb2.StreamBlock | stream_pb2.Event
    size: int


class Inbox:
    """Holds all messages until the daemon's status arrives, which has the formats and the offset to UTC: 1 s at most.

        accept --decode, check--> [waiting] --next: format, LossTracker--> Block | Event
    """

    def __init__(self, is_wanted: Callable[[str], bool]) -> None:
        self._is_wanted = is_wanted
        self._topics: dict[str, _Topic] = collections.defaultdict(_Topic)
        self._formats: dict[str, StreamFormat] | None = None  # by topic, of the present instance
        self._utc_minus_monotonic_ns = 0
        self._instance_id = 0
        self._waiting: collections.deque[_Waiting] = collections.deque()
        self._waiting_bytes = 0
        self.statistics = Statistics()

    @property
    def has_status(self) -> bool:
        return self._formats is not None

    def accept(self, frames: list[bytes]) -> None:
        """Processes one message from the wire. Call `next` until it returns None before the next call."""
        if len(frames) != 2 or len(frames[1]) > MAX_MESSAGE_BYTES:
            self.statistics.malformed += 1
            return
        topic = frames[0].decode(errors="replace")
        try:
            if topic == STATUS_TOPIC:
                self._accept_status(frames[1])
            elif self._is_wanted(topic):  # a subscription is a prefix: "floor/cop" also brings "floor/cop2"
                self._accept_wanted(topic, frames[1])
        except (DecodeError, DataDamaged):
            self.statistics.malformed += 1

    def next(self) -> Block | Event | None:
        """Returns the next block or event, or None if none is ready."""
        while self._formats is not None and self._waiting:
            waiting = self._waiting.popleft()
            self._waiting_bytes -= waiting.size
            if isinstance(waiting.message, stream_pb2.Event):
                return self._to_event(waiting.topic, waiting.message)
            block = self._to_block(self._formats.get(waiting.topic), waiting.topic, waiting.message)
            if block is not None:
                return block
        return None

    def _accept_status(self, body: bytes) -> None:
        status = control_pb2.StatusSnapshot.FromString(body)
        check_status(status)
        self.statistics.messages += 1
        self._note_instance(status.instance_id)
        self._utc_minus_monotonic_ns = status.utc_minus_monotonic_ns
        if self._formats is None:
            self._formats = formats_of(status)

    def _accept_wanted(self, topic: str, body: bytes) -> None:
        name = topic.partition("/")[2]
        message: stream_pb2.StreamBlock | stream_pb2.Event
        if name in EVENT_TOPICS:
            message = stream_pb2.Event.FromString(body)
            is_valid = message.instance_id != 0 and topic_of(message).name == name
        else:
            message = stream_pb2.StreamBlock.FromString(body)
            is_valid = is_block(message)
        if not is_valid:
            self.statistics.malformed += 1
            return
        self._note_instance(message.instance_id)
        self.statistics.messages += 1
        if isinstance(message, stream_pb2.Event) and topic_of(message).is_retained:  # the daemon sends it again for every new subscriber
            if self._topics[topic].last_retained == body:
                return
            self._topics[topic].last_retained = body
        self._wait(_Waiting(topic, message, len(body)))

    def _note_instance(self, instance_id: int) -> None:
        if instance_id == self._instance_id:
            return
        is_first = self._instance_id == 0
        self._instance_id = instance_id
        if is_first:
            return
        self.statistics.restarts += 1
        self._waiting.clear()  # of the old instance, whose formats are not known any more
        self._waiting_bytes = 0
        self._formats = None
        for topic in self._topics:
            self._topics[topic] = _Topic(is_restart=True)

    def _wait(self, waiting: _Waiting) -> None:
        while self._waiting and (len(self._waiting) >= _MAX_WAITING or self._waiting_bytes + waiting.size > _MAX_WAITING_BYTES):
            oldest = self._waiting.popleft()
            self._waiting_bytes -= oldest.size
            if isinstance(oldest.message, stream_pb2.Event):
                self.statistics.dropped_events += 1
            else:
                self._count_gap(oldest.topic, oldest.message)
                self._topics[oldest.topic].lost_scans += oldest.message.scan_count
        self._waiting.append(waiting)
        self._waiting_bytes += waiting.size

    def _count_gap(self, name: str, block: stream_pb2.StreamBlock) -> None:
        topic = self._topics[name]
        gap = topic.tracker.advance(Position(block.segment, block.first_scan, block.scan_count, block.sequence))
        topic.lost_scans += gap.scans
        topic.is_loss_exact = topic.is_loss_exact and gap.is_exact
        if not gap.is_consistent:
            self.statistics.inconsistent += 1

    def _to_block(self, form: StreamFormat | None, name: str, block: stream_pb2.StreamBlock) -> Block | None:
        if form is None:
            self.statistics.unknown_topics += 1
            return None
        if len(form.channels) != block.channel_count:
            self.statistics.malformed += 1
            return None
        self._count_gap(name, block)
        topic = self._topics[name]
        count = block.scan_count * block.channel_count
        made = Block(
            format=form,
            segment=block.segment,
            first_scan=block.first_scan,
            rate=form.rate if _is_same(form.rate, block.rate) else Fraction(block.rate.numerator, block.rate.denominator),
            values=np.fromiter(block.values, np.float32, count).reshape(block.channel_count, block.scan_count).T,
            quality=np.frombuffer(block.quality, np.uint8),
            host_time_ns=block.host_time_ns,
            host_time_uncertainty_ns=block.host_time_uncertainty_ns,
            utc_minus_monotonic_ns=self._utc_minus_monotonic_ns,
            sequence=block.sequence,
            lost_scans=topic.lost_scans,
            is_loss_exact=topic.is_loss_exact and not topic.is_restart,
            instance_id=block.instance_id,
            is_restart=topic.is_restart,
        )
        topic.lost_scans, topic.is_loss_exact, topic.is_restart = 0, True, False
        return made

    def _to_event(self, topic: str, event: stream_pb2.Event) -> Event:
        has_time = event.HasField("host_time_ns")
        body = getattr(event, str(event.WhichOneof("body")))
        return Event(
            rig=topic.partition("/")[0],
            kind=kind_of(event),
            segment=event.segment,
            scan=event.scan,
            time_s=event.host_time_ns * 1e-9 if has_time else float("nan"),
            utc=_utc_of(event.host_time_ns + self._utc_minus_monotonic_ns) if has_time else np.datetime64("NaT"),
            fields=fields_of(body),
            message=event,
        )


def formats_of(status: control_pb2.StatusSnapshot) -> dict[str, StreamFormat]:
    """Returns the streams of a checked status by topic."""
    return {
        f"{rig.rig.name}/{stream.name}": StreamFormat(
            topic=f"{rig.rig.name}/{stream.name}",
            channels=tuple(channel.name for channel in stream.channels),
            units=tuple(channel.unit for channel in stream.channels),
            rate=Fraction(stream.rate.numerator, stream.rate.denominator),
            delay_s=stream.delay_ns * 1e-9,
        )
        for rig in status.rigs
        for stream in rig.rig.streams
    }


def _is_same(rate: Fraction, wire: stream_pb2.Rate) -> bool:
    return rate.numerator == wire.numerator and rate.denominator == wire.denominator


def _utc_of(utc_ns: int) -> np.datetime64:
    return np.datetime64(utc_ns, "ns") if abs(utc_ns) < 2**63 else np.datetime64("NaT")
