#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the .proto files with proto/frozen.txt, which lists every message, field and enumerator that a client may rely on.

    protocol_freeze.py check ROOT     fails if one was removed, renamed, renumbered or retyped, or if a new one is not listed yet
    protocol_freeze.py add ROOT       lists what is new; changes nothing else

Exit status 0: nothing found, 1: findings, 2: wrong use.
"""
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from google.protobuf import descriptor_pb2

FROZEN = Path("proto/frozen.txt")
COMMAND = "python3 tests/unit/protocol/protocol_freeze.py add ."
Field = descriptor_pb2.FieldDescriptorProto


def type_of(field: Field) -> str:
    """Everything that decides how the bytes are read, and whether absence is visible: "repeated float", "optional dts.v1.Rate"."""
    kind = field.type_name.lstrip(".") or Field.Type.Name(field.type).removeprefix("TYPE_").lower()
    label = {Field.LABEL_REPEATED: "repeated ", Field.LABEL_REQUIRED: "required "}.get(field.label, "")
    packing = " unpacked" if field.options.HasField("packed") and not field.options.packed else ""
    return f"{'optional ' if field.proto3_optional else label}{kind}{packing}"


def entries_of_enum(enum: descriptor_pb2.EnumDescriptorProto, scope: str) -> Iterator[str]:
    yield f"enum {scope}.{enum.name}"
    for value in enum.value:
        yield f"value {scope}.{enum.name} {value.number} {value.name}"


def entries_of_message(message: descriptor_pb2.DescriptorProto, scope: str) -> Iterator[str]:
    name = f"{scope}.{message.name}"
    yield f"message {name}"
    for field in message.field:
        is_in_oneof = field.HasField("oneof_index") and not field.proto3_optional
        oneof = f" in {message.oneof_decl[field.oneof_index].name}" if is_in_oneof else ""
        yield f"field {name} {field.number} {field.name}: {type_of(field)}{oneof}"
    for enum in message.enum_type:
        yield from entries_of_enum(enum, name)
    for nested in message.nested_type:
        yield from entries_of_message(nested, name)


def entries(root: Path) -> list[str]:
    """One line for each message, field, enum, enumerator and option of the protocol, sorted by its place in the files."""
    protos = root / "proto"
    files = sorted(path.relative_to(protos).as_posix() for path in (protos / "dts" / "v1").glob("*.proto"))
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "set"
        subprocess.run(["protoc", f"--proto_path={protos}", f"--descriptor_set_out={out}", *files], check=True)
        described = descriptor_pb2.FileDescriptorSet.FromString(out.read_bytes())
    found: list[str] = []
    for file in described.file:
        for message in file.message_type:
            found += entries_of_message(message, file.package)
        for enum in file.enum_type:
            found += entries_of_enum(enum, file.package)
        found += [f"option {file.package} {each.number} {each.name}: {type_of(each)} of {each.extendee.lstrip('.')}" for each in file.extension]
    return found


def check(root: Path) -> int:
    frozen = (root / FROZEN).read_text().splitlines()
    present = entries(root)
    gone = [entry for entry in frozen if entry not in set(present)]
    new = [entry for entry in present if entry not in set(frozen)]
    for entry in gone:
        print(f"{FROZEN}: the protocol no longer has '{entry}': clients of earlier versions rely on it. Restore it; add a field with a new number.")
    for entry in new:
        print(f"{FROZEN}: '{entry}' is not listed" + ("" if gone else f": run {COMMAND}"))
    return 1 if gone or new else 0


def add(root: Path) -> int:
    """Writes the present protocol if it has everything that is listed."""
    frozen = (root / FROZEN).read_text().splitlines() if (root / FROZEN).exists() else []
    present = entries(root)
    gone = set(frozen) - set(present)
    if gone:
        for entry in sorted(gone):
            print(f"{FROZEN}: the protocol no longer has '{entry}': nothing is written. Restore it first.", file=sys.stderr)
        return 1
    (root / FROZEN).write_text("\n".join(present) + "\n")
    print(f"{FROZEN}: {len(present) - len(frozen)} new lines")
    return 0


def main(arguments: list[str]) -> int:
    actions = {"check": check, "add": add}
    if len(arguments) != 2 or arguments[0] not in actions:
        print(__doc__, file=sys.stderr)
        return 2
    return actions[arguments[0]](Path(arguments[1]))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
