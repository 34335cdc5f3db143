# SPDX-License-Identifier: Apache-2.0
"""Events at a scan: one class for published events and for events in recordings."""
import dataclasses
from collections.abc import MutableSequence
from typing import Any

import numpy as np
from google.protobuf.descriptor import EnumDescriptor, FieldDescriptor
from google.protobuf.message import Message

from .options import bits_of
from .v1 import stream_pb2


@dataclasses.dataclass(frozen=True)
class Event:
    """An event at one scan of a rig, for example a marker, a gap or a reach."""

    rig: str
    # "marker", "gap" (published only; recordings have "segment" and "loss"), "device", "session", "trigger", "trial", "result", "reach", "class", "sway"; recordings have more kinds, and of a
    # later version of dtsd also kinds that this version does not know
    kind: str
    segment: int
    scan: int  # of the raw stream
    time_s: float  # CLOCK_MONOTONIC of the daemon's host; NaN for an event before the first scan
    utc: np.datetime64  # NaT for an event before the first scan
    # Enumerators and bits as words; what is not known is NaN, or None if it is no float, or absent. As in the file if the kind is not known.
    fields: dict[str, Any]
    # None: recorded by dtsd 0.1 or another program. Without a body if the kind is not known.
    message: stream_pb2.Event | None = dataclasses.field(default=None, repr=False)

    def __str__(self) -> str:
        values = "  ".join(f"{name} {value}" for name, value in self.fields.items() if not isinstance(value, dict | list))
        return f"{self.rig}  scan {self.scan}  {self.kind}  {values}"


def fields_of(message: Message) -> dict[str, Any]:
    """Returns a message as a dictionary. Omits absent submessages and unspecified enumerators."""
    fields: dict[str, Any] = {}
    for field in message.DESCRIPTOR.fields:
        value = getattr(message, field.name)
        if field.full_name == "dts.v1.Sway.measures":
            value = {measure.symbol: {"value": measure.value, "unit": measure.unit} for measure in value}
        elif field.message_type is not None and field.message_type.GetOptions().map_entry:
            value = dict(value)
        elif isinstance(value, MutableSequence):  # repeated; protobuf 7 has no `label`, protobuf 4 no `is_repeated`
            value = [fields_of(part) if isinstance(part, Message) else part for part in value]
        elif field.message_type is not None:
            if not message.HasField(field.name):
                continue
            value = fields_of(value)
        elif field.has_presence and not message.HasField(field.name):
            value = float("nan") if field.type == FieldDescriptor.TYPE_DOUBLE else None
        elif (enum := bits_of(field)) is not None:
            value = words_of_bits(enum, value)
        elif field.enum_type is not None:
            if value == 0:
                continue
            value = word_of(field.enum_type, value)
        fields[field.name] = value
    return fields


def words_of_bits(enum: EnumDescriptor, bits: int) -> list[str]:
    """Returns the words of the bits that are set: ["resumed", "untared"]."""
    return [word_of(enum, 1 << bit) for bit in range(bits.bit_length()) if bits >> bit & 1]


def word_of(enum: EnumDescriptor, number: int) -> str:
    """Returns an enumerator as a word: DEVICE_STATE_STREAMING is "streaming". Returns "unknown" for enumerators of later versions."""
    value = enum.values_by_number.get(number)
    if value is None:
        return "unknown"
    prefix = "".join("_" + letter if letter.isupper() else letter for letter in enum.name).lstrip("_").upper() + "_"
    return str(value.name).removeprefix(prefix).lower()
