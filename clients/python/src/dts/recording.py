# SPDX-License-Identifier: Apache-2.0
"""Recordings: XDF files as scans, segments and events, like daemon/record/recording.h in C++."""
import dataclasses
import json
import os
import re
from typing import Any

import numpy as np
from google.protobuf import json_format
from google.protobuf.descriptor import Descriptor, FieldDescriptor
from numpy.typing import NDArray

from .errors import DataDamaged
from .events import Event, fields_of
from .options import kind_of
from .streams import Missing, Samples, scans_at, to_utc
from .v1 import stream_pb2
from .xdf import XdfFile, XdfStream, read_xdf

_FORMAT_VERSION = "1"
_MAX_EVENT_BYTES = 64 << 10
_MAX_EVENT_KEYS = 64
_LATER_ENUMERATOR = 2**31 - 1  # the number of no enumerator: `word_of` returns "unknown"
_PLACE = frozenset(("segment", "scan", "host_time_ns"))
_ENVELOPE = _PLACE | {"instance_id"}


@dataclasses.dataclass(frozen=True)
class SessionFacts:
    """Properties of the session in a recording of dtsd. They never contain the name of a person."""

    session_id: str
    part: int
    rig: str
    kind: str
    protocol: str
    subject: str
    label: str
    software: str
    device_uri: str
    calibration_id: str
    started_utc: np.datetime64
    fields: dict[str, str]  # the protocol's fields about the subject
    stages: tuple[str, ...]
    all: dict[str, str] = dataclasses.field(repr=False)  # all properties, also "device_serial", "boot_id", "rig_definition", ...


@dataclasses.dataclass(frozen=True, eq=False)
class RecordedStream(Samples):
    """A stream of a recording. `time_s` includes the clock offsets, which XDF stores separately from the stamps."""

    content: str  # type in XDF: "DTS", "Quality", "Markers"; other programs use other types
    stamps_s: NDArray[np.float64]  # as in the file: time of the device's clock in seconds, without jitter
    clock_offsets: NDArray[np.float64]  # n x 2, in seconds: stamp, and the offset to add at this stamp
    facts: dict[str, str]


@dataclasses.dataclass(frozen=True)
class Loss:
    """Scans missing between the first and the last scan of a recording, for one reason; `dtsctl session show` counts the same way."""

    reason: str  # "overrun", "unplugged", "ring_full", ...; "none": no reason recorded, but the time stamps have a gap
    gaps: int
    scans: int  # of the rig's raw stream; a gap of unknown length counts by the time between the scans around it


@dataclasses.dataclass(frozen=True, eq=False)
class Recording:
    """A recording: its session, streams and events. `load` returns it."""

    file: str  # path as given to `load`
    session: SessionFacts | None  # None: a file of another program
    streams: dict[str, RecordedStream]  # by name, "floor/cop"; a second stream with the same name is "name-2"
    events: tuple[Event, ...]  # in order of time; texts of other programs become markers
    damage: str  # why the file is damaged or incomplete, and where; empty: no damage
    losses: tuple[Loss, ...]  # by reason, in order of first occurrence; empty: no scan is missing

    @property
    def lost_scans(self) -> int:
        """Number of missing scans, over all reasons."""
        return sum(loss.scans for loss in self.losses)

    @property
    def lost_in_gaps(self) -> int:
        """Number of gaps, over all reasons."""
        return sum(loss.gaps for loss in self.losses)

    def __getitem__(self, name: str) -> RecordedStream:
        """Returns a stream by its full name or by the part after "/": recording["cop"]. Raises KeyError for an unknown name."""
        if name in self.streams:
            return self.streams[name]
        for full, stream in self.streams.items():
            if full.rpartition("/")[2] == name:
                return stream
        raise KeyError(f"no stream '{name}'; the streams are {', '.join(self.streams)}")

    def __contains__(self, name: str) -> bool:
        """Returns whether `recording[name]` finds a stream."""
        return name in self.streams or any(full.rpartition("/")[2] == name for full in self.streams)

    def events_of(self, kind: str) -> list[Event]:
        """Returns the events of one kind in order of time: "marker", "segment", "loss", "trial", ..."""
        return [event for event in self.events if event.kind == kind]

    def __str__(self) -> str:
        session = self.session.session_id if self.session else "no session of dtsd"
        lines = [f"{self.file}: {session}, {len(self.events)} events", *map(str, self.streams.values())]
        if self.losses:
            reasons = ", ".join(f"{loss.reason} {loss.gaps}" for loss in self.losses)
            lines.append(f"{self.lost_scans} scans lost in {self.lost_in_gaps} gaps: {reasons}")
        return "\n  ".join(lines + ([f"damaged: {self.damage}"] if self.damage else []))


def load(path: str | os.PathLike[str]) -> Recording:
    """Reads a recording of dtsd, or an XDF file of another program. A damaged file is read up to the damage: see `Recording.damage`.

    Raises `NotFound`, `NotAllowed` or `Failed` if the file cannot be read, and `DataDamaged` if it is not an XDF file.
    """
    file = read_xdf(path)
    problems = [file.damage] if file.damage else _problems_of_footers(file)
    session = None
    if "format_version" in file.header.facts:
        try:
            session = _session_of(file.header.facts)
        except DataDamaged as error:
            problems.append(error.what)
    utc_minus_monotonic_ns = _whole(file.header.facts, "utc_minus_monotonic_ns") if session else None
    texts = [stream for stream in file.streams.values() if stream.header.dtype == object]
    parsed = [row for stream in texts for row in _parsed_events(stream)]
    reference = _reference(file)
    table = _SegmentTable(parsed, reference)
    events = sorted((_to_event(row, table, utc_minus_monotonic_ns) for row in parsed), key=lambda event: event.time_s)
    streams: dict[str, RecordedStream] = {}
    for stream in file.streams.values():
        name = _unused_name(stream.header.name, streams)
        streams[name] = _to_stream(name, stream, table, utc_minus_monotonic_ns)
    return Recording(os.fspath(path), session, streams, tuple(events), "; ".join(problems), _losses_of(events, table, reference))


def _losses_of(events: list[Event], table: "_SegmentTable", reference: XdfStream | None) -> tuple[Loss, ...]:
    """Returns losses by the rules of daemon/record/losses.

    The first segment begins the recording; every other segment follows a gap. A "loss" counts scans that the recorder dropped. Files of
    other programs have no segment events; the stamps of the reference stream then show the gaps.
    """
    if not table.has_segment_events:
        return _losses_by_stamps(reference)
    counts: dict[str, list[int]] = {}
    has_begun = False
    for event in events:
        if event.kind == "loss":
            reason, scans = "ring_full", event.fields.get("scans")
        elif event.kind == "segment" and has_begun:
            reason, scans = str(event.fields.get("reason", "none")), event.fields.get("missing_scans")
        else:
            has_begun = has_begun or event.kind == "segment"
            continue
        count = counts.setdefault(reason, [0, 0])
        count[0] += 1
        count[1] += scans if type(scans) is int and scans > 0 else 0
    return tuple(Loss(reason, gaps, scans) for reason, (gaps, scans) in counts.items())


def _losses_by_stamps(reference: XdfStream | None) -> tuple[Loss, ...]:
    """Returns losses by the time stamps alone, by the rules of daemon/record/overview."""
    if reference is None or not reference.header.rate:
        return ()
    rate_hz = float(reference.header.rate)
    stamps_s = reference.times_s
    gaps_at = np.flatnonzero(~_continues(stamps_s, rate_hz))
    if not len(gaps_at):
        return ()
    with np.errstate(invalid="ignore"):
        missing = np.nan_to_num(np.rint((np.diff(stamps_s)[gaps_at] - 1.0 / rate_hz) * rate_hz), nan=0.0)
    return (Loss("none", len(gaps_at), sum(int(scans) for scans in np.clip(missing, 0, 9e15))),)


def _problems_of_footers(file: XdfFile) -> list[str]:
    footers = [stream.footer for stream in file.streams.values()]
    problems = [] if all(footers) else ["no footer: the file was not closed"]
    facts = {name: text for footer in footers if footer for name, text in footer.facts.items()}
    if "incomplete" in facts:
        problems.append(f"incomplete: {facts['incomplete']}")
    if "recovered" in facts:
        problems.append(f"recovered, at most {facts.get('lost_s_at_most', '?')} s lost")
    return problems


def _whole(facts: dict[str, str], name: str) -> int:
    text = facts.get(name, "0")
    if not re.fullmatch("-?[0-9]{1,19}", text) or not -(2**63) <= int(text) < 2**63:
        raise DataDamaged(f"the fact {name} is not a valid number: '{text[:40]}'")
    return int(text)


def _session_of(facts: dict[str, str]) -> SessionFacts:
    if facts["format_version"] != _FORMAT_VERSION:
        raise DataDamaged(f"the fact format_version is '{facts['format_version'][:40]}'; supported: {_FORMAT_VERSION}")
    names = ("session_id", "rig", "kind", "protocol", "subject", "label", "software", "device_uri", "calibration_id")
    _whole(facts, "utc_minus_monotonic_ns")
    stages = _whole(facts, "stages")
    if not 0 <= stages <= 256:
        raise DataDamaged(f"the fact stages is {stages}; the limit is 256")
    return SessionFacts(
        **{name: facts.get(name, "") for name in names},
        part=_whole(facts, "part"),
        started_utc=np.datetime64(_whole(facts, "started_utc_ns"), "ns"),
        fields={name.removeprefix("field."): text for name, text in facts.items() if name.startswith("field.")},
        stages=tuple(facts.get(f"stage.{stage + 1}", "") for stage in range(stages)),
        all=dict(facts),
    )


@dataclasses.dataclass(frozen=True)
class _ParsedEvent:
    stream: XdfStream
    stamp_s: float
    values: dict[str, Any] | None  # "event", "segment", "scan" and the fields; None: not an event of dtsd
    message: stream_pb2.Event | None  # None: recorded by dtsd 0.1 or another program
    text: str


def _as_list(values: NDArray[Any]) -> list[Any]:
    """Returns an array as a list of Python values: the types of NumPy do not state how deep `tolist` nests."""
    rows: Any = values.tolist()
    return list(rows)


def _parsed_events(stream: XdfStream) -> list[_ParsedEvent]:
    rows = zip(_as_list(stream.times_s), _as_list(stream.values), strict=True)
    return [_parsed_event(stream, stamp_s, text) for stamp_s, texts in rows for text in texts]


def _parsed_event(stream: XdfStream, stamp_s: float, text: str) -> _ParsedEvent:
    event = _object_of_json(text)
    if event is None:
        return _ParsedEvent(stream, stamp_s, None, None, text)
    message = _message_of(event)
    if message is None:
        return _ParsedEvent(stream, stamp_s, _old_event_of(event), None, text)
    if body := message.WhichOneof("body"):
        kind, fields = kind_of(message), fields_of(getattr(message, body))
    else:
        kind = _later_kind_of(event)
        fields = event[kind]
    values = {**fields, "event": kind, "segment": message.segment, "scan": message.scan}
    return _ParsedEvent(stream, stamp_s, values, message, text)


def _object_of_json(text: str) -> dict[str, Any] | None:
    if len(text) > _MAX_EVENT_BYTES:
        return None
    try:
        event = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return event if isinstance(event, dict) else None


def _message_of(event: dict[str, Any]) -> stream_pb2.Event | None:
    """An event as dtsd records it: protobuf's JSON of dts.v1.Event. It has no body if a later version of dtsd recorded it."""
    message = stream_pb2.Event()
    try:
        json_format.ParseDict(_with_known_enumerators(event, message.DESCRIPTOR), message, ignore_unknown_fields=True)
    except (json_format.ParseError, ValueError, TypeError, AttributeError, RecursionError):
        return None
    return message if (message.WhichOneof("body") or _later_kind_of(event)) and message.scan < 2**62 else None


def _with_known_enumerators(event: dict[str, Any], descriptor: Descriptor) -> dict[str, Any]:
    """Replaces the enumerators of later versions: protobuf rejects a message with an unknown name, and accepts an unknown number."""

    def known(value: Any, field: FieldDescriptor | None) -> Any:
        if field is None:
            return value
        if isinstance(value, list):
            return [known(part, field) for part in value]
        if isinstance(value, dict) and field.message_type is not None:
            return _with_known_enumerators(value, field.message_type)
        is_later = isinstance(value, str) and field.enum_type is not None and value not in field.enum_type.values_by_name
        return _LATER_ENUMERATOR if is_later else value

    return {name: known(value, descriptor.fields_by_name.get(name)) for name, value in event.items()}


def _later_kind_of(event: dict[str, Any]) -> str:
    """Returns the kind of an event that a later version of dtsd recorded: the name of its body. Returns "" if it is something else."""
    names = sorted(event.keys() - _ENVELOPE)
    is_placed = not event.keys().isdisjoint(_PLACE)
    return names[0] if is_placed and len(names) == 1 and isinstance(event[names[0]], dict) else ""


def _old_event_of(event: dict[str, Any]) -> dict[str, Any] | None:
    """An event of dtsd 0.1: one flat object, {"event":"marker","segment":0,"scan":1250,"text":"eyes closed"}."""
    if not isinstance(event.get("event"), str) or len(event) > _MAX_EVENT_KEYS:
        return None
    is_placed = all(type(event.get(key, 0)) is int and 0 <= event.get(key, 0) < 2**62 for key in ("segment", "scan"))
    return event if is_placed else None


def _reference(file: XdfFile) -> XdfStream | None:
    """Returns the stream whose scans number the events: the raw stream, or the fastest stream if raw is not recorded."""
    regular = [stream for stream in file.streams.values() if stream.header.rate and stream.header.dtype != object]
    raw = [stream for stream in regular if stream.header.name.rpartition("/")[2] == "raw"]
    by_rate = sorted(regular, key=lambda stream: stream.header.rate or 0, reverse=True)
    return next(iter(raw + by_rate), None)


class _SegmentTable:
    """Finds the segment and the scan of a stamp: from the events of dtsd, otherwise from the stamps of the reference stream.

        segment   0                      gap   1
        stamp   --|=======================|    |==================>
                stamp of scan 0         start of 1: a sample less than half a raw scan before it belongs to it
    """

    def __init__(self, events: list[_ParsedEvent], reference: XdfStream | None) -> None:
        self.rate_hz = float(reference.header.rate) if reference and reference.header.rate else 0.0
        ours = [(row.stamp_s, row.values) for row in events if row.values and row.values["event"] == "segment"]
        self.has_segment_events = bool(ours) and self.rate_hz > 0.0
        self.gaps = {values.get("segment", 0): values for _, values in ours}
        if self.has_segment_events:
            starts = [(at, values.get("segment", 0), at - values.get("scan", 0) / self.rate_hz) for at, values in ours]
        elif reference is not None:
            stamps = reference.times_s
            firsts = stamps[np.r_[True, ~_continues(stamps, self.rate_hz)]] if len(stamps) else stamps
            starts = [(at, number, at) for number, at in enumerate(_as_list(firsts))]
        else:
            starts = []
        starts.sort()
        self._starts_s = np.array([start[0] for start in starts])
        self._numbers = np.array([start[1] for start in starts], np.int64)
        self._zeros_s = np.array([start[2] for start in starts])

    def places(self, stamps_s: NDArray[np.float64], rate_hz: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Returns the segment and the scan of each stamp; 0 and 0 if unknown."""
        if not len(self._starts_s) or rate_hz == 0.0:
            return np.zeros(len(stamps_s), np.int64), np.zeros(len(stamps_s), np.int64)
        # A start is the stamp of a scan of the raw stream: half a scan of a slower stream could be beyond a short gap.
        tolerance_s = 0.5 / (self.rate_hz if self.has_segment_events else rate_hz)
        at = np.maximum(np.searchsorted(self._starts_s, stamps_s + tolerance_s, side="right") - 1, 0)
        scans = np.nan_to_num(np.rint((stamps_s - self._zeros_s[at]) * rate_hz), nan=0.0)
        return self._numbers[at], np.clip(scans, 0, 9e15).astype(np.int64)


def _continues(stamps_s: NDArray[np.float64], rate_hz: float) -> NDArray[np.bool_]:
    """Returns whether each sample after the first follows the previous one within half a scan.

    Compares neighbours, not a fixed grid: a clock that is off by 50 ppm must not look like a gap after hours.
    """
    with np.errstate(invalid="ignore"):
        return np.asarray(np.abs(np.diff(stamps_s) - 1.0 / rate_hz) <= 0.5 / rate_hz)


def _own_places(stamps_s: NDArray[np.float64], rate_hz: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Returns segment and scan of each stamp from the stamps of the stream alone."""
    breaks = np.r_[False, ~_continues(stamps_s, rate_hz)]
    segments = np.cumsum(breaks)
    index = np.arange(len(stamps_s))
    return segments, index - np.maximum.accumulate(np.where(breaks, index, 0))


def _to_stream(name: str, stream: XdfStream, table: _SegmentTable, utc_minus_monotonic_ns: int | None) -> RecordedStream:
    header = stream.header
    stamps_s = stream.times_s
    if header.rate and not table.has_segment_events and len(stamps_s):
        segments, scans = _own_places(stamps_s, float(header.rate))
    else:
        segments, scans = table.places(stamps_s, float(header.rate or table.rate_hz))
    return RecordedStream(
        name=name,
        channels=header.labels,
        units=header.units,
        rate=header.rate,
        delay_s=header.delay_s,
        values=stream.values.view(np.uint8) if header.content == "Quality" and stream.values.dtype == np.int8 else stream.values,
        segments=segments,
        scans=scans,
        time_s=_on_host(stamps_s, stream.offsets),
        utc_minus_monotonic_ns=utc_minus_monotonic_ns,
        gaps=_gaps_of(segments, scans, table, float(header.rate)) if header.rate else (),
        content=header.content,
        stamps_s=stamps_s,
        clock_offsets=np.array(stream.offsets).reshape(-1, 2),
        facts=header.facts,
    )


def _gaps_of(segments: NDArray[np.int64], scans: NDArray[np.int64], table: _SegmentTable, rate_hz: float) -> tuple[Missing, ...]:
    found = []
    within = "ring_full" if table.has_segment_events else "lost"  # in a file of dtsd, only the queue to the recorder loses scans of a segment
    for index in _as_list(np.flatnonzero((np.diff(segments) != 0) | (np.diff(scans) != 1)) + 1):
        event = table.gaps.get(int(segments[index]), {})
        if segments[index] == segments[index - 1]:
            found.append(Missing(index, max(int(scans[index] - scans[index - 1]) - 1, 0), True, within))
        else:
            missing = event.get("missing_scans")
            count = scans_at(missing, table.rate_hz, rate_hz) if type(missing) is int else 0
            is_exact = type(missing) is int and event.get("is_exact") is True
            found.append(Missing(index, count, is_exact, str(event.get("reason", "unknown"))))
    return tuple(found)


def _on_host(stamps_s: NDArray[np.float64], offsets: list[tuple[float, float]]) -> NDArray[np.float64]:
    """Maps stamps to the clock of the host. dtsd measures offsets every 5 s; between them, this function interpolates."""
    known: NDArray[np.float64] = np.array([offset for offset in offsets if np.isfinite(offset).all()]).reshape(-1, 2)
    if not len(known):
        return stamps_s
    known = known[np.argsort(known[:, 0], kind="stable")]
    return np.asarray(stamps_s + np.interp(stamps_s, known[:, 0], known[:, 1]))


def _to_event(row: _ParsedEvent, table: _SegmentTable, utc_minus_monotonic_ns: int | None) -> Event:
    stamp_s = np.array([row.stamp_s])
    time_s = _on_host(stamp_s, row.stream.offsets)
    values = row.values
    if values is None:
        segments, scans = table.places(stamp_s, table.rate_hz)
        values = {"event": "marker", "segment": int(segments[0]), "scan": int(scans[0]), "text": row.text}
    return Event(
        rig=row.stream.header.name.partition("/")[0],
        kind=values["event"],
        segment=values.get("segment", 0),
        scan=values.get("scan", 0),
        time_s=float(time_s[0]),
        utc=to_utc(np.rint(time_s * 1e9), utc_minus_monotonic_ns)[0],
        fields={
            # The JSON of dtsd 0.1 had no other way to write an undefined number.
            name: float("nan") if value is None and row.message is None else value
            for name, value in values.items()
            if name not in ("event", "segment", "scan")
        },
        message=row.message,
    )


def _unused_name(name: str, taken: dict[str, RecordedStream]) -> str:
    """Returns a name that is not taken: files of other programs may have several streams with the same name."""
    unused, number = name, 2
    while unused in taken:
        unused, number = f"{name}-{number}", number + 1
    return unused
