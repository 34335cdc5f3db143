# SPDX-License-Identifier: Apache-2.0
"""The exceptions of this package: one class per code of dts.v1.ErrorCode, all derived from `Error`."""
import enum
import re

# C0 and C1 controls, and what changes the direction of a text: it may come from a peer, and goes to a terminal.
_DRIVES_A_TERMINAL = re.compile(r"[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def _printable(text: str) -> str:
    return _DRIVES_A_TERMINAL.sub(" ", text)


class ErrorCode(enum.IntEnum):
    """The numbers of dts.v1.ErrorCode. 1 to 7 are also exit statuses of dtsctl; for the others it exits with 1."""

    FAILED = 1
    INVALID_ARGUMENT = 2
    UNREACHABLE = 3
    NOT_ALLOWED = 4
    NOT_FOUND = 5
    WRONG_STATE = 6
    DATA_DAMAGED = 7
    TIMEOUT = 8
    DEVICE_GONE = 9
    UNSUPPORTED = 10
    LIMIT_EXCEEDED = 11
    INTERNAL = 12


class Error(Exception):
    """Base class of all errors. `what`: what failed, on which thing, and why. `hint`: what to try; may be empty. `code`: see
    `ErrorCode`.
    """

    code = ErrorCode.FAILED

    def __init__(self, what: str, hint: str = "") -> None:
        self.what = _printable(what)
        self.hint = _printable(hint)
        super().__init__(self.what, self.hint)

    def __str__(self) -> str:
        return f"{self.what}\n  {self.hint}" if self.hint else self.what


class Failed(Error):
    """The operation failed for a reason outside the program."""


class InvalidArgument(Error):
    """A value given by the caller is wrong."""

    code = ErrorCode.INVALID_ARGUMENT


class Unreachable(Error):
    """No daemon answers at the endpoint."""

    code = ErrorCode.UNREACHABLE


class NotAllowed(Error):
    """The caller's role or the operating system forbids it."""

    code = ErrorCode.NOT_ALLOWED


class NotFound(Error):
    """No such rig, stream, session or file."""

    code = ErrorCode.NOT_FOUND


class WrongState(Error):
    """The operation is valid, but not in the present state."""

    code = ErrorCode.WRONG_STATE


class DataDamaged(Error):
    """Received data or a file contradict themselves."""

    code = ErrorCode.DATA_DAMAGED


class Timeout(Error):
    """The deadline passed."""

    code = ErrorCode.TIMEOUT


class DeviceGone(Error):
    """The device was unplugged or stopped answering."""

    code = ErrorCode.DEVICE_GONE


class Unsupported(Error):
    """This daemon or version cannot do it."""

    code = ErrorCode.UNSUPPORTED


class LimitExceeded(Error):
    """A size, rate or count is above its limit."""

    code = ErrorCode.LIMIT_EXCEEDED


class Internal(Error):
    """A bug in the daemon or in this library."""

    code = ErrorCode.INTERNAL


_CLASSES: dict[int, type[Error]] = {cls.code: cls for cls in Error.__subclasses__()}


def error_of(code: int, what: str, hint: str = "") -> Error:
    """Returns the exception for a code; `Failed` for codes of later versions."""
    return _CLASSES.get(code, Failed)(what, hint)
