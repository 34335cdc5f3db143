# SPDX-License-Identifier: Apache-2.0
"""Messages of fleet.proto by number of the field: tests send what no program of ours would send, and read without generated code."""


def varint(value: int) -> bytes:
    out = b""
    while value > 127:
        out += bytes([value & 127 | 128])
        value >>= 7
    return out + bytes([value])


class fixed64(int):  # noqa: N801
    """A field of 8 bytes."""


def message(fields: dict[int, int | bytes | str]) -> bytes:
    out = b""
    for number, value in fields.items():
        if isinstance(value, fixed64):
            out += varint(number << 3 | 1) + int(value).to_bytes(8, "little")
        elif isinstance(value, int):
            out += varint(number << 3) + varint(value)
        else:
            data = value.encode() if isinstance(value, str) else value
            out += varint(number << 3 | 2) + varint(len(data)) + data
    return out


def decoded(data: bytes) -> dict[int, list]:
    """Returns the values of each field: numbers and bytes; fixed fields as bytes."""
    fields: dict[int, list] = {}
    at = 0

    def read_varint() -> int:
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    while at < len(data):
        key = read_varint()
        if key & 7 == 0:
            fields.setdefault(key >> 3, []).append(read_varint())
            continue
        size = {1: 8, 5: 4}.get(key & 7) or read_varint()
        fields.setdefault(key >> 3, []).append(data[at:at + size])
        at += size
    return fields


def text_of(fields: dict[int, list], number: int) -> str:
    return fields.get(number, [b""])[0].decode()
