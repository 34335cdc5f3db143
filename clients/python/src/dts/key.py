# SPDX-License-Identifier: Apache-2.0
"""The key with which a client on another machine proves who it is (CURVE); the files of clients/libdts (dts/key.h)."""
import dataclasses
import os
import re
import stat
import tomllib

import zmq

from .errors import InvalidArgument, NotAllowed

_Z85_KEY = re.compile(r"[0-9a-zA-Z.:+=^!/*?&<>()\[\]{}@%$#-]{40}")  # ZeroMQ RFC 32
_PARTS = ("public_key", "secret_key", "server_public_key")


@dataclasses.dataclass(frozen=True, repr=False)  # no secret in a traceback
class Key:
    """All keys are 40 characters of Z85; the addresses are those of the daemon."""

    name: str
    public_key: str
    secret_key: str
    server_public_key: str
    control: str
    data: str

    def use(self, context: "zmq.Context[zmq.Socket[bytes]]") -> None:
        """For every socket that the context makes from now on."""
        context.setsockopt(zmq.CURVE_SERVERKEY, self.server_public_key.encode())
        context.setsockopt(zmq.CURVE_PUBLICKEY, self.public_key.encode())
        context.setsockopt(zmq.CURVE_SECRETKEY, self.secret_key.encode())


def read_key(file: str | os.PathLike[str]) -> Key:
    """`NotAllowed` when others than its owner may read it, `InvalidArgument` when it is no key file."""
    try:
        if not stat.S_ISREG(os.stat(file).st_mode):  # a pipe would wait
            raise InvalidArgument(f"key file {file} is no regular file")
        with open(file, "rb") as stream:
            if stat.S_IMODE(os.fstat(stream.fileno()).st_mode) & 0o077:
                raise NotAllowed(f"key file {file} is open to others: its secret is none", f"chmod 0600 {file}")
            table = tomllib.load(stream)
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
        raise InvalidArgument(f"key file {file}: {problem}", "take the file as dtsctl key new wrote it") from None
    values = {field.name: str(table.get(field.name, "")) for field in dataclasses.fields(Key)}
    for part in _PARTS:
        if not _Z85_KEY.fullmatch(values[part]):
            raise InvalidArgument(f"{file}: {part} is no key of 40 characters", "take the file as dtsctl key new wrote it")
    return Key(**values)
