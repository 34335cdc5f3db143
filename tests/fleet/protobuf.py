# SPDX-License-Identifier: Apache-2.0
"""Messages of fleet.proto by number of the field, for tests that send what no program of ours would send."""


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
