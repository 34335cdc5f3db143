# SPDX-License-Identifier: Apache-2.0
"""Reads XDF 1.0 (github.com/sccn/xdf/wiki/Specifications) into arrays: files of any program; a damaged file is read up to the damage.

    file:    "XDF:" chunk chunk ...
    chunk:   [bytes of length: 1, 4, 8][length of tag and content][tag, u16][content]
    samples: [stream, u32][bytes of count][count] then per sample [0 or 8][time stamp, f64, if 8][value]...
    text:    [bytes of length][length][bytes]
"""
import dataclasses
import os
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from .errors import DataDamaged, Failed, NotAllowed, NotFound
from .xdf_header import FileHeader, StreamFooter, StreamHeader, file_header, stream_footer, stream_header

_MAGIC = b"XDF:"
_MAX_CHUNK_BYTES = 64 << 20
_MAX_DECODED_BYTES = 4 * _MAX_CHUNK_BYTES  # of one chunk: a hostile one is made of the shortest samples there are
_MAX_STREAMS = 4096
_MAX_HEADER_BYTES = 64 << 20
_LENGTHS = {1: "<B", 4: "<I", 8: "<Q"}
_TEXT_SAMPLE_BYTES = 2  # at least: a text of length 0


@dataclasses.dataclass
class XdfStream:
    """A stream with the values and time stamps of the file."""

    header: StreamHeader
    footer: StreamFooter | None = None
    offsets: list[tuple[float, float]] = dataclasses.field(default_factory=list)  # stream time, to be added to it
    _times: list[NDArray[np.float64]] = dataclasses.field(default_factory=list)
    _values: list[NDArray[np.generic]] = dataclasses.field(default_factory=list)
    _stamp_s: float = 0.0  # the last in the file
    _since_stamp: int = 0  # samples

    @property
    def times_s(self) -> NDArray[np.float64]:
        return np.concatenate(self._times) if self._times else np.empty(0)

    @property
    def values(self) -> NDArray[np.generic]:
        empty: NDArray[np.generic] = np.empty((0, self.header.channel_count), self.header.dtype)
        return np.concatenate(self._values) if self._values else empty

    def add(self, stamps_s: NDArray[np.float64], values: NDArray[np.generic]) -> None:
        """Appends samples. A sample without a stamp (NaN) gets its time from the last stamp and the rate, also across chunks."""
        self._times.append(self._count_on(stamps_s))
        self._values.append(values)

    def _count_on(self, stamps_s: NDArray[np.float64]) -> NDArray[np.float64]:
        given = np.flatnonzero(~np.isnan(stamps_s))
        index = np.arange(len(stamps_s))
        place = np.searchsorted(given, index, side="right") - 1  # of the stamp before, or at, each sample; -1: in an earlier chunk
        base = np.where(place >= 0, stamps_s[given[place]] if len(given) else 0.0, self._stamp_s)
        since = np.where(place >= 0, index - (given[place] if len(given) else 0), index + 1 + self._since_stamp)
        if len(given):
            self._stamp_s, self._since_stamp = float(stamps_s[given[-1]]), len(stamps_s) - 1 - int(given[-1])
        else:
            self._since_stamp += len(stamps_s)
        rate = self.header.rate
        if rate is None:
            return base
        return np.where(since > 0, base + since * float(rate.denominator) / float(rate.numerator), base)


@dataclasses.dataclass
class XdfFile:
    """The content of an XDF file."""

    header: FileHeader
    streams: dict[int, XdfStream]
    damage: str  # what cannot be read, and where; everything before it was read. Empty: no damage


def read_xdf(path: str | os.PathLike[str]) -> XdfFile:
    """Reads an XDF file, up to the damage if there is any.

    Raises `NotFound`, `NotAllowed` or `Failed` if the file cannot be read, and `DataDamaged` if it is not XDF or has no file header.
    """
    try:
        with Path(path).open("rb") as file:
            return _Reader(file, str(path)).read()
    except FileNotFoundError:
        raise NotFound(f"no file {path}") from None
    except PermissionError:
        raise NotAllowed(f"no permission to read {path}") from None
    except OSError as error:
        raise Failed(f"cannot read {path}: {error.strerror}") from None


class _Reader:
    def __init__(self, file: BinaryIO, name: str) -> None:
        self._file = file
        self._name = name
        self._size = os.fstat(file.fileno()).st_size
        self._streams: dict[int, XdfStream] = {}
        self._header: FileHeader | None = None
        self._header_bytes = 0

    def read(self) -> XdfFile:
        if self._file.read(len(_MAGIC)) != _MAGIC:
            raise DataDamaged(f"{self._name} is not an XDF file", "XDF files start with 'XDF:'")
        damage = ""
        try:
            for offset, tag, content in self._chunks():
                try:
                    self._add_chunk(tag, content)
                except DataDamaged as error:
                    raise DataDamaged(f"{_PARTS.get(tag, f'chunk of tag {tag}')} damaged at byte {offset}: {error.what}") from None
        except DataDamaged as error:
            damage = error.what
        if self._header is None:
            raise DataDamaged(f"{self._name}: {damage or 'it ends before its file header'}")
        return XdfFile(self._header, self._streams, damage)

    def _chunks(self) -> Iterator[tuple[int, int, bytes]]:
        """Yields the offset (bytes), the tag and the content of each chunk."""
        while (offset := self._file.tell()) < self._size:
            width = self._file.read(1)[0]
            if width not in _LENGTHS:
                raise DataDamaged(f"no chunk at byte {offset}")
            prefix = self._file.read(width)
            if len(prefix) < width:
                raise DataDamaged(f"chunk torn at byte {offset}")
            (length,) = struct.unpack(_LENGTHS[width], prefix)
            if length < 2:
                raise DataDamaged(f"chunk without a tag at byte {offset}")
            if length > _MAX_CHUNK_BYTES:
                raise DataDamaged(f"chunk of {length} bytes, at most 64 MiB are read, at byte {offset}")
            chunk = self._file.read(min(length, self._size))
            if len(chunk) < length:
                raise DataDamaged(f"chunk torn at byte {offset}")
            yield offset, int.from_bytes(chunk[:2], "little"), chunk[2:]

    def _add_chunk(self, tag: int, content: bytes) -> None:
        if (self._header is None) != (tag == 1):
            raise DataDamaged("a file starts with a file header" if self._header is None else "a second file header")
        if tag == 1:
            self._header = file_header(content)
        elif tag in _OF_STREAM:
            if len(content) < 4:
                raise DataDamaged("no stream number")
            self._add_to_stream(tag, int.from_bytes(content[:4], "little"), content[4:])

    def _add_to_stream(self, tag: int, number: int, content: bytes) -> None:
        if tag == 2:
            return self._add_stream_header(number, content)
        stream = self._streams.get(number)
        if stream is None:
            raise DataDamaged(f"stream {number} has no header")
        if tag == 3:
            stream.add(*samples(content, stream.header))
        elif tag == 4:
            if len(content) != 16:
                raise DataDamaged("not two numbers")
            at_s, offset_s = struct.unpack("<dd", content)
            stream.offsets.append((at_s, offset_s))
        else:
            stream.footer = stream_footer(content)

    def _add_stream_header(self, number: int, content: bytes) -> None:
        if number in self._streams:
            raise DataDamaged(f"a second header of stream {number}")
        self._header_bytes += len(content)
        if self._header_bytes > _MAX_HEADER_BYTES or len(self._streams) >= _MAX_STREAMS:
            raise DataDamaged("too many streams")
        self._streams[number] = XdfStream(stream_header(content))


_PARTS = {1: "file header", 2: "stream header", 3: "samples", 4: "clock offset", 5: "boundary", 6: "stream footer"}
_OF_STREAM = (2, 3, 4, 6)


def samples(content: bytes, header: StreamHeader) -> tuple[NDArray[np.float64], NDArray[np.generic]]:
    """Returns time stamps (NaN if absent) and values of a samples chunk. `content` begins after the stream number."""
    count, start = _read_length(content, 0, "no count of samples")
    value_bytes = header.channel_count * (header.dtype.itemsize if header.dtype != object else _TEXT_SAMPLE_BYTES)
    room = (len(content) - start) // (1 + value_bytes)
    if count > room:
        raise DataDamaged(f"{count} samples declared, there is room for {room}")
    if count * (8 + header.channel_count * 8) > _MAX_DECODED_BYTES:
        raise DataDamaged(f"{count} samples in one chunk are too many to hold")
    if header.dtype == object:
        return _one_by_one(content, start, count, header, _read_texts)
    even = _evenly_stamped(content, start, count, header)
    return even if even is not None else _one_by_one(content, start, count, header, _read_numbers)


def _evenly_stamped(
    content: bytes, start: int, count: int, header: StreamHeader
) -> tuple[NDArray[np.float64], NDArray[np.generic]] | None:
    """Handles the common layouts: every sample has a stamp, or only the first one, or none. An array can then view the bytes directly."""
    if count == 0:
        return None
    has_first = content[start] == 8
    with_stamp = np.dtype([("flag", "u1"), ("stamp", "<f8"), ("values", header.dtype, (header.channel_count,))])
    without = np.dtype([("flag", "u1"), ("values", header.dtype, (header.channel_count,))])
    stamps_s = np.full(count, np.nan)
    if len(content) == start + count * with_stamp.itemsize:
        rows = np.frombuffer(content, with_stamp, count, start)
        if (rows["flag"] == 8).all():
            return rows["stamp"].copy(), rows["values"].copy()
    first_bytes = with_stamp.itemsize if has_first else 0
    if len(content) != start + first_bytes + (count - bool(has_first)) * without.itemsize:
        return None
    rest = np.frombuffer(content, without, offset=start + first_bytes)
    if rest["flag"].any():
        return None
    if not has_first:
        return stamps_s, rest["values"].copy()
    first = np.frombuffer(content, with_stamp, 1, start)
    stamps_s[0] = first["stamp"][0]
    return stamps_s, np.concatenate([first["values"], rest["values"]])


_ReadValues = Callable[[bytes, int, StreamHeader], tuple[NDArray[np.generic], int]]


def _one_by_one(
    content: bytes, at: int, count: int, header: StreamHeader, read_value: _ReadValues
) -> tuple[NDArray[np.float64], NDArray[np.generic]]:
    stamps_s = np.full(count, np.nan)
    values: NDArray[np.generic] = np.empty((count, header.channel_count), header.dtype)
    for sample in range(count):
        if at >= len(content) or content[at] not in (0, 8):
            raise DataDamaged("a time stamp of neither 0 nor 8 bytes")
        if content[at] == 8:
            if len(content) < at + 9:
                raise DataDamaged("samples end within a time stamp")
            (stamps_s[sample],) = struct.unpack_from("<d", content, at + 1)
        values[sample], at = read_value(content, at + 1 + content[at], header)
    if at != len(content):
        raise DataDamaged(f"{len(content) - at} bytes left over after the samples")
    return stamps_s, values


def _read_numbers(content: bytes, at: int, header: StreamHeader) -> tuple[NDArray[np.generic], int]:
    end = at + header.channel_count * header.dtype.itemsize
    if end > len(content):
        raise DataDamaged("samples end within a value")
    return np.frombuffer(content, header.dtype, header.channel_count, at), end


def _read_texts(content: bytes, at: int, header: StreamHeader) -> tuple[NDArray[np.generic], int]:
    texts: NDArray[np.generic] = np.empty(header.channel_count, object)
    for channel in range(header.channel_count):
        length, at = _read_length(content, at, "samples end within a text")
        if length > len(content) - at:
            raise DataDamaged("samples end within a text")
        texts[channel] = content[at : at + length].decode(errors="replace")
        at += length
    return texts, at


def _read_length(content: bytes, at: int, problem: str) -> tuple[int, int]:
    """Returns a length field, whose own size precedes it, and the position after it."""
    width = content[at] if at < len(content) else 0
    if width not in _LENGTHS or len(content) < at + 1 + width:
        raise DataDamaged(problem)
    return int.from_bytes(content[at + 1 : at + 1 + width], "little"), at + 1 + width
