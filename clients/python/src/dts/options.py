# SPDX-License-Identifier: Apache-2.0
"""Topics, commands and bits as proto/dts/v1/options.proto defines them, read from the descriptors."""
import functools

from google.protobuf.descriptor import EnumDescriptor, FieldDescriptor

from .v1 import control_pb2, options_pb2, stream_pb2


def _fields_of(message: type, oneof: str) -> list[FieldDescriptor]:
    return list(message.DESCRIPTOR.oneofs_by_name[oneof].fields)  # type: ignore[attr-defined]


# By the field of Event.body, of Request.command.
TOPICS: dict[str, options_pb2.Topic] = {
    field.name: field.GetOptions().Extensions[options_pb2.topic] for field in _fields_of(stream_pb2.Event, "body")
}
COMMANDS: dict[str, options_pb2.CommandRules] = {
    field.name: field.GetOptions().Extensions[options_pb2.rules] for field in _fields_of(control_pb2.Request, "command")
}
EVENT_TOPICS = frozenset(topic.name for topic in TOPICS.values() if topic.name)  # what has none is only recorded
_KINDS: dict[str, str] = {
    field.name: field.GetOptions().Extensions[options_pb2.kind] or TOPICS[field.name].name or field.name
    for field in _fields_of(stream_pb2.Event, "body")
}


def topic_of(message: stream_pb2.Event) -> options_pb2.Topic:
    """Returns the topic of an event; without a name if the event is only recorded, or if this version does not know its body."""
    return TOPICS.get(message.WhichOneof("body") or "", options_pb2.Topic())


def kind_of(message: stream_pb2.Event) -> str:
    """The word for an event: "reach", "class", "result"; empty: it has no body that this version knows."""
    return _KINDS.get(message.WhichOneof("body") or "", "")


@functools.cache
def bits_of(field: FieldDescriptor) -> EnumDescriptor | None:
    """Returns the enum whose values are the bits of this field, or None."""
    name = field.GetOptions().Extensions[options_pb2.bits]
    return stream_pb2.DESCRIPTOR.enum_types_by_name[name] if name else None
