# SPDX-License-Identifier: Apache-2.0
"""Python client of dtsd, the distributive tactile sensing daemon: live data, sessions and recordings as NumPy arrays.

    import dts

    with dts.connect() as daemon:                          # live
        for block in daemon.stream("floor/cop"):
            print(block.scans[-1], block["ap_mm"][-1])

    recording = dts.load("FILE.xdf")                       # recorded
    print(recording["cop"]["ap_mm"].mean())
"""
from .daemon import Daemon, Session, connect
from .endpoints import Endpoints, find_endpoints
from .errors import (
    DataDamaged,
    DeviceGone,
    Error,
    ErrorCode,
    Failed,
    Internal,
    InvalidArgument,
    LimitExceeded,
    NotAllowed,
    NotFound,
    Timeout,
    Unreachable,
    Unsupported,
    WrongState,
)
from .events import Event
from .key import Key, read_key
from .live import EventStream, Stream
from .recording import Loss, RecordedStream, Recording, SessionFacts, load
from .streams import Block, Missing, Samples, StreamFormat
from .subscriber import Statistics
from .v1.stream_pb2 import Quality

__all__ = [
    "Block",
    "Daemon",
    "DataDamaged",
    "DeviceGone",
    "Endpoints",
    "Error",
    "ErrorCode",
    "Event",
    "EventStream",
    "Failed",
    "Internal",
    "InvalidArgument",
    "Key",
    "LimitExceeded",
    "Loss",
    "Missing",
    "NotAllowed",
    "NotFound",
    "Quality",
    "RecordedStream",
    "Recording",
    "Samples",
    "Session",
    "SessionFacts",
    "Statistics",
    "Stream",
    "StreamFormat",
    "Timeout",
    "Unreachable",
    "Unsupported",
    "WrongState",
    "connect",
    "find_endpoints",
    "load",
    "read_key",
]
