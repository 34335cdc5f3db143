# SPDX-License-Identifier: Apache-2.0
"""Keys of clients on other machines (CURVE), in the file format of clients/libdts (dts/key.h)."""
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
    """A key of this client, with the public key and the addresses of the daemon. All keys have 40 characters of Z85."""

    name: str
    public_key: str
    secret_key: str
    server_public_key: str
    control: str
    data: str

    def use(self, context: "zmq.Context[zmq.Socket[bytes]]") -> None:
        """Makes all new sockets of the context use this key."""
        context.setsockopt(zmq.CURVE_SERVERKEY, self.server_public_key.encode())
        context.setsockopt(zmq.CURVE_PUBLICKEY, self.public_key.encode())
        context.setsockopt(zmq.CURVE_SECRETKEY, self.secret_key.encode())


def read_key(file: str | os.PathLike[str]) -> Key:
    """Reads a key file that `dtsctl key new` wrote.

    Raises `NotAllowed` if users other than its owner may read it, and `InvalidArgument` if it is not a key file.
    """
    try:
        if not stat.S_ISREG(os.stat(file).st_mode):  # a pipe would wait
            raise InvalidArgument(f"key file {file} is not a regular file")
        with open(file, "rb") as stream:
            if stat.S_IMODE(os.fstat(stream.fileno()).st_mode) & 0o077:
                what = f"key file {file} is readable or writable by other users: its secret is not protected"
                raise NotAllowed(what, f"chmod 0600 {file}")
            table = tomllib.load(stream)
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
        raise InvalidArgument(f"key file {file}: {problem}", "use an unchanged file from dtsctl key new") from None
    values = {field.name: str(table.get(field.name, "")) for field in dataclasses.fields(Key)}
    for part in _PARTS:
        if not _Z85_KEY.fullmatch(values[part]):
            raise InvalidArgument(f"{file}: {part} is not a key of 40 characters", "use an unchanged file from dtsctl key new")
    return Key(**values)
