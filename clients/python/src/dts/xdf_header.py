# SPDX-License-Identifier: Apache-2.0
"""The XML in XDF files: descriptions of the file and its streams, as dtsd and other programs write them."""
import dataclasses
import math
import re
import xml.etree.ElementTree as ElementTree
from fractions import Fraction

import numpy as np

from .errors import DataDamaged

_MAX_XML_BYTES = 8 << 20
_MAX_CHANNELS = 4096
_MAX_RATE_TERM = 10**12
_RATE_TOLERANCE = 1e-9  # between the exact rate and nominal_srate, relative: rounding of 17 digits and no more
_DTYPES = {"float32": "<f4", "double64": "<f8", "int8": "i1", "int16": "<i2", "int32": "<i4", "int64": "<i8", "string": "O"}


@dataclasses.dataclass(frozen=True)
class FileHeader:
    facts: dict[str, str]


@dataclasses.dataclass(frozen=True)
class StreamHeader:
    name: str
    content: str  # XDF's type: "DTS", "Markers", "Quality", "EEG"
    dtype: np.dtype[np.generic]  # object: texts
    rate: Fraction | None  # None: irregular
    labels: tuple[str, ...]
    units: tuple[str, ...]
    delay_s: float
    facts: dict[str, str]

    @property
    def channel_count(self) -> int:
        return len(self.labels)


@dataclasses.dataclass(frozen=True)
class StreamFooter:
    sample_count: int | None
    facts: dict[str, str]  # "incomplete", "recovered", "lost_s_at_most"


def file_header(xml: bytes) -> FileHeader:
    info = _parse(xml)
    version = _text(info, "version")
    if version != "1" and not version.startswith("1."):
        raise DataDamaged(f"XDF version '{version[:40]}', only 1.x is known")
    return FileHeader(_facts(info))


def stream_header(xml: bytes) -> StreamHeader:
    info = _parse(xml)
    form = _text(info, "channel_format")
    if form not in _DTYPES:
        raise DataDamaged(f"unknown channel_format '{form[:40]}'")
    count = _whole(info, "channel_count") or 0
    if not 1 <= count <= _MAX_CHANNELS:
        raise DataDamaged(f"channel_count {count} is not within 1 to {_MAX_CHANNELS}")
    # As many as channel_count says: other programs leave the descriptions out, or describe more.
    described = info.findall("desc/channels/channel")[:count]
    missing = count - len(described)
    return StreamHeader(
        name=_text(info, "name"),
        content=_text(info, "type"),
        dtype=np.dtype(_DTYPES[form]),
        rate=_rate(info),
        labels=tuple(_text(channel, "label") for channel in described) + ("",) * missing,
        units=tuple(_text(channel, "unit") for channel in described) + ("",) * missing,
        delay_s=(_whole(info, "desc/dts/delay_ns") or 0) * 1e-9,
        facts=_facts(info),
    )


def stream_footer(xml: bytes) -> StreamFooter:
    info = _parse(xml)
    return StreamFooter(_whole(info, "sample_count"), _facts(info))


def _parse(xml: bytes) -> ElementTree.Element:
    if len(xml) > _MAX_XML_BYTES:
        raise DataDamaged(f"XML of {len(xml)} bytes, at most 8 MiB are read")
    if b"<!DOCTYPE" in xml:  # entities that grow without end need one; no XDF file does
        raise DataDamaged("XML with a document type")
    try:
        info = ElementTree.fromstring(xml.rstrip(b"\0"))
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise DataDamaged(f"not XML: {error}") from None
    if info.tag != "info":
        raise DataDamaged("XML without <info>")
    return info


def _text(node: ElementTree.Element, path: str) -> str:
    return (node.findtext(path) or "").strip()


def _whole(node: ElementTree.Element, path: str) -> int | None:
    text = _text(node, path)
    if not text:
        return None
    if not re.fullmatch("-?[0-9]{1,19}", text):
        raise DataDamaged(f"<{path}> is not a number: '{text[:40]}'")
    return int(text)


def _facts(info: ElementTree.Element) -> dict[str, str]:
    ours = {fact.get("name", ""): fact.text or "" for fact in info.findall("desc/dts/fact")}
    others = {node.tag: node.text for node in info.findall("desc/*") if node.tag != "dts" and node.text and node.text.strip()}
    return {**others, **ours}


def _rate(info: ElementTree.Element) -> Fraction | None:
    """Returns the rate. Files of other programs have only nominal_srate; files of dtsd also have the exact fraction."""
    text = _text(info, "nominal_srate")
    try:
        nominal_hz = float(text or 0)
    except ValueError:
        raise DataDamaged(f"<nominal_srate> is not a number: '{text[:40]}'") from None
    if nominal_hz == 0.0:
        return None
    if not (math.isfinite(nominal_hz) and 1e-6 <= nominal_hz <= 1e6):
        raise DataDamaged(f"impossible nominal_srate {nominal_hz}")
    exact = info.find("desc/dts/rate")
    if exact is None:
        return Fraction(round(nominal_hz * 1e6), 10**6)
    terms = [exact.get(name, "") for name in ("numerator", "denominator")]
    if not all(term.isdecimal() and len(term) <= 13 and 0 < int(term) <= _MAX_RATE_TERM for term in terms):
        raise DataDamaged("the exact rate is not a positive fraction")
    rate = Fraction(int(terms[0]), int(terms[1]))
    if not abs(float(rate) - nominal_hz) <= _RATE_TOLERANCE * nominal_hz:
        raise DataDamaged(f"the exact rate contradicts nominal_srate {nominal_hz}")
    return rate
