# SPDX-License-Identifier: Apache-2.0
"""Samples in memory: one block as received, or any number of scans in one object."""
import dataclasses
from fractions import Fraction
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Times = NDArray[np.datetime64]
_Scalar = TypeVar("_Scalar", bound=np.generic)


@dataclasses.dataclass(frozen=True)
class StreamFormat:
    """Properties of a stream that stay constant while the daemon runs."""

    topic: str  # "floor/cop"
    channels: tuple[str, ...]  # ("ml_mm", "ap_mm", "load_n")
    units: tuple[str, ...]
    rate: Fraction  # scans per second, exact
    delay_s: float  # group delay of the filters: a value describes the input this long before its scan


@dataclasses.dataclass(frozen=True, eq=False)
class Block:
    """Consecutive scans of one stream, as the daemon published them."""

    format: StreamFormat
    segment: int  # increases by 1 at every gap of the device; scan indices then restart
    first_scan: int  # index within the segment
    rate: Fraction
    values: NDArray[np.float32]  # scans x channels; NaN where undefined
    quality: NDArray[np.uint8]  # per channel: bits of dts.Quality, combined with OR over the scans
    host_time_ns: int  # CLOCK_MONOTONIC of the daemon's host at the first scan's instant
    host_time_uncertainty_ns: int  # largest error of host_time_ns; 0: exact (simulated)
    utc_minus_monotonic_ns: int
    sequence: int  # blocks of this stream since the daemon started
    # Scans missing between the previously delivered block and this one: lost in transit, or dropped by a full queue. Scans that the device
    # lost are not counted here; gap events report them.
    lost_scans: int
    is_loss_exact: bool  # False: the length of the old segment is unknown, and lost_scans is a lower limit
    instance_id: int  # changes when the daemon restarts
    is_restart: bool  # the daemon was restarted before this block: segments and scans start again; the loss is unknown

    @property
    def topic(self) -> str:
        """Topic of the stream: "floor/cop"."""
        return self.format.topic

    @property
    def rig(self) -> str:
        """Name of the rig: "floor"."""
        return self.format.topic.partition("/")[0]

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the columns of `values`."""
        return self.format.channels

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the columns of `values`."""
        return self.format.units

    @property
    def scans(self) -> NDArray[np.int64]:
        """Index of each scan within the segment."""
        return np.arange(self.first_scan, self.first_scan + len(self), dtype=np.int64)

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Time of each scan in seconds: CLOCK_MONOTONIC of the daemon's host, comparable with time.monotonic() on that host."""
        return (self.host_time_ns + self._since_first_ns()) * 1e-9

    @property
    def utc(self) -> Times:
        """Time of each scan in UTC; NaT for times that 64 bits cannot hold."""
        return to_utc(self._since_first_ns().astype(np.int64), self.host_time_ns + self.utc_minus_monotonic_ns)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, channel: str) -> NDArray[np.float32]:
        """Returns a channel by its name: block["ap_mm"]. Raises KeyError for an unknown name."""
        return column(self.values, self.channels, channel)

    def _since_first_ns(self) -> NDArray[np.float64]:
        since_first_ns: NDArray[np.float64] = np.rint(np.arange(len(self)) * (1e9 * self.rate.denominator / self.rate.numerator))
        return since_first_ns


@dataclasses.dataclass(frozen=True)
class Missing:
    """Scans that are missing before row `index` of the arrays."""

    index: int
    scans: int  # a lower limit if not exact
    is_exact: bool
    reason: str  # "overrun", "unplugged", ...: lost by the device; "ring_full": the recorder was too
    # slow; "lost": in transit; "restart": the daemon was restarted, number unknown


@dataclasses.dataclass(frozen=True, eq=False)
class Samples:
    """Scans of one stream in one object; `Daemon.record` and `dts.load` return it."""

    name: str  # "floor/cop"
    channels: tuple[str, ...]
    units: tuple[str, ...]
    rate: Fraction | None  # None: irregular, each scan has its own time
    delay_s: float
    values: NDArray[np.generic]  # scans x channels
    segments: NDArray[np.int64]
    scans: NDArray[np.int64]  # index within the segment
    time_s: NDArray[np.float64]  # CLOCK_MONOTONIC of the daemon's host
    utc_minus_monotonic_ns: int | None  # None: not known, in a file of another program
    gaps: tuple[Missing, ...]

    @property
    def utc(self) -> Times:
        """Time of each scan in UTC; NaT for times that 64 bits cannot hold, and in a file of another program."""
        return to_utc(np.rint(self.time_s * 1e9), self.utc_minus_monotonic_ns)

    @property
    def duration_s(self) -> float:
        """Time from the first to the last scan, in seconds; 0 without scans."""
        return float(self.time_s[-1] - self.time_s[0]) if len(self) else 0.0

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, channel: str) -> NDArray[np.generic]:
        """Returns a channel by its name: samples["ap_mm"]. Raises KeyError for an unknown name."""
        return column(self.values, self.channels, channel)

    def __str__(self) -> str:
        rate = f"{float(self.rate):g} Hz" if self.rate else "irregular"
        return f"{self.name}: {len(self)} scans of {', '.join(self.channels)} at {rate}, {len(self.gaps)} gaps"


def scans_at(raw_scans: int, raw_rate_hz: float, rate_hz: float) -> int:
    """Returns how many scans of a stream fit into the time of scans of the device. A rate of 0 is not known: then it is the same."""
    return raw_scans if raw_rate_hz <= 0.0 or rate_hz <= 0.0 else round(raw_scans * (rate_hz / raw_rate_hz))


def column(values: NDArray[_Scalar], channels: tuple[str, ...], channel: str) -> NDArray[_Scalar]:
    """Returns the column of a channel. Raises KeyError for an unknown name."""
    try:
        return values[:, channels.index(channel)]
    except ValueError:
        raise KeyError(f"no channel '{channel}'; the channels are {', '.join(channels)}") from None


def to_utc(time_ns: NDArray[np.float64] | NDArray[np.int64], offset_ns: int | None) -> Times:
    """Returns times in UTC. Times that 64 bits cannot hold come from a damaged peer or file; they become NaT. So do all if the offset is not
    known.
    """
    if offset_ns is None:
        return np.full(np.shape(time_ns), np.datetime64("NaT", "ns"))
    times = np.asarray(time_ns, dtype=np.float64) + offset_ns
    is_known = (np.abs(times) < 9.2e18) & (abs(offset_ns) < 2**63)
    whole = np.where(is_known, time_ns, 0).astype(np.int64) + np.int64(offset_ns if abs(offset_ns) < 2**63 else 0)
    return np.where(is_known, whole.astype("datetime64[ns]"), np.datetime64("NaT"))
