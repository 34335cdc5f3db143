# SPDX-License-Identifier: Apache-2.0
"""Finds the addresses of a daemon by the same rule as dtsd and clients/libdts (dts/endpoints.h)."""
import dataclasses
import errno
import os
import socket
from collections.abc import Mapping
from pathlib import Path

from .errors import InvalidArgument, NotAllowed, Unreachable

_IPC = "ipc://"
_TCP = "tcp://"
_LONGEST_PATH_BYTES = 107  # sizeof sockaddr_un::sun_path, less its end


@dataclasses.dataclass(frozen=True)
class Endpoints:
    """Where a daemon listens, as ZeroMQ addresses: "ipc:///run/dtsd/control.sock" or "tcp://127.0.0.1:5555"."""

    control: str
    data: str  # empty if only a TCP control address is known: the port of the data socket cannot be guessed
    origin: str  # what decided the addresses, for messages: "DTSD_CONTROL", "/run/dtsd", ...


def find_endpoints(
    control: str = "", data: str = "", environment: Mapping[str, str] = os.environ, system_directory: str = "/run/dtsd"
) -> Endpoints:
    """Finds the addresses of the daemon; does not connect. The first match wins:

    arguments > DTSD_CONTROL, DTSD_DATA > DTSD_RUNTIME_DIR > /run/dtsd if its sockets exist > XDG_RUNTIME_DIR/dtsd > /tmp/dtsd-<uid>

    One address in the form ".../control.sock" or ".../data.sock" decides the other one, so that addresses of two daemons never mix. Raises
    `InvalidArgument` for an address that no daemon can have, and `NotAllowed` if the directory below /tmp belongs to another user.
    """
    from_control = environment.get("DTSD_CONTROL", "")
    from_data = environment.get("DTSD_DATA", "")
    if control or data:
        found = _completed(control, data, "the argument control" if control else "the argument data")
    elif from_control or from_data:
        found = _completed(from_control, from_data, "DTSD_CONTROL" if from_control else "DTSD_DATA")
    else:
        found = _by_directory(environment, system_directory)
    # A TCP address does not decide the other address; the environment may.
    found = dataclasses.replace(found, control=found.control or from_control, data=found.data or from_data)
    for address in (found.control, found.data):
        if address:
            _check_address(address, found.origin)
    return found


def probe(endpoint: str) -> None:
    """Connects to an ipc address and disconnects again. Raises `Unreachable` or `NotAllowed` at once if no daemon can be reached there."""
    path = endpoint.removeprefix(_IPC)
    if path == endpoint or not path.startswith("/"):
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as attempt:
        attempt.setblocking(False)
        outcome = attempt.connect_ex(path)
    if outcome in (errno.ENOENT, errno.ENOTDIR):
        raise Unreachable(
            f"no daemon at {endpoint}: the socket does not exist",
            "start it: systemctl start dtsd, or dtsd --config FILE; if it uses another directory, set DTSD_RUNTIME_DIR or give control=",
        )
    if outcome == errno.ECONNREFUSED:
        raise Unreachable(
            f"no daemon at {endpoint}: the socket exists, but no program listens on it",
            "start it: systemctl start dtsd; find out why it ended: journalctl -u dtsd",
        )
    if outcome in (errno.EACCES, errno.EPERM):
        raise NotAllowed(
            f"no permission to open {endpoint}",
            "join the group that owns the socket's directory (usermod -aG dtsd $USER), then log in again",
        )


def _sibling(endpoint: str, name: str, other: str) -> str:
    is_known = endpoint.startswith(_IPC) and endpoint.endswith("/" + name)
    return endpoint.removesuffix(name) + other if is_known else ""


def _completed(control: str, data: str, origin: str) -> Endpoints:
    control = control or _sibling(data, "data.sock", "control.sock")
    data = data or _sibling(control, "control.sock", "data.sock")
    return Endpoints(control, data, origin)


def _in_directory(directory: str, origin: str) -> Endpoints:
    return Endpoints(f"{_IPC}{directory}/control.sock", f"{_IPC}{directory}/data.sock", origin)


def _by_directory(environment: Mapping[str, str], system_directory: str) -> Endpoints:
    if given := environment.get("DTSD_RUNTIME_DIR"):
        return _in_directory(given.removesuffix("/"), "DTSD_RUNTIME_DIR")
    try:
        is_there = Path(system_directory, "control.sock").exists()
    except PermissionError:  # an unreadable directory is still the daemon's: probe() reports the missing permission
        is_there = True
    if is_there:
        return _in_directory(system_directory, system_directory)
    session = environment.get("XDG_RUNTIME_DIR", "")
    if session.startswith("/"):
        return _in_directory(f"{session.removesuffix('/')}/dtsd", "XDG_RUNTIME_DIR")
    return _in_tmp()


def _in_tmp() -> Endpoints:
    """Rejects a directory of another user: anyone may create a directory in /tmp to intercept commands."""
    directory = f"/tmp/dtsd-{os.geteuid()}"
    try:
        owner = os.stat(directory).st_uid
    except OSError:
        owner = os.geteuid()
    if owner not in (os.geteuid(), 0):
        raise NotAllowed(f"{directory} belongs to another user", "remove it, or set DTSD_RUNTIME_DIR to the directory of the daemon")
    return _in_directory(directory, directory)


def _check_address(endpoint: str, origin: str) -> None:
    subject = f"'{endpoint}' (from {origin})"
    if endpoint.startswith(_IPC):
        path = endpoint.removeprefix(_IPC)
        if not path.startswith(("/", "@")):
            raise InvalidArgument(f"{subject}: the socket path must be absolute", "write ipc:///run/dtsd/control.sock")
        if len(os.fsencode(path)) > _LONGEST_PATH_BYTES:
            raise InvalidArgument(
                f"{subject}: the socket path is longer than {_LONGEST_PATH_BYTES} bytes", "choose a shorter runtime directory"
            )
        return
    host, _, port = endpoint.removeprefix(_TCP).rpartition(":")
    if not endpoint.startswith(_TCP) or not host or not port:
        raise InvalidArgument(f"{subject} is not an address", "write ipc:///path/control.sock or tcp://host:port")
