# SPDX-License-Identifier: Apache-2.0
"""Samples in memory: a block as it comes, and any number of scans in one piece."""
import dataclasses
from fractions import Fraction
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Times = NDArray[np.datetime64]
_Scalar = TypeVar("_Scalar", bound=np.generic)


@dataclasses.dataclass(frozen=True)
class StreamFormat:
    """What is constant about a stream while the daemon runs."""

    topic: str  # "floor/cop"
    channels: tuple[str, ...]  # ("ml_mm", "ap_mm", "load_n")
    units: tuple[str, ...]
    rate: Fraction  # scans per second, exact
    delay_s: float  # group delay of the filters: a value describes the input this long before its scan


@dataclasses.dataclass(frozen=True, eq=False)
class Block:
    """Consecutive scans of one stream, as the daemon published them."""

    format: StreamFormat
    segment: int  # counts up at every gap of the device; scan indices restart
    first_scan: int  # index within the segment
    rate: Fraction
    values: NDArray[np.float32]  # scans x channels; NaN where undefined
    quality: NDArray[np.uint8]  # per channel: bits of dts.Quality, or-ed over the scans
    host_time_ns: int  # CLOCK_MONOTONIC of the daemon's host at the first scan's instant
    host_time_uncertainty_ns: int  # how far that may be off; 0: simulated, exact
    utc_minus_monotonic_ns: int
    sequence: int  # blocks of this stream so far
    # Scans missing between the block delivered before and this one, lost on the way or dropped by a full queue. Gaps of the device are
    # not in it: events tell of those.
    lost_scans: int
    is_loss_exact: bool  # False: how long the old segment became is unknown, lost_scans is the least it can be
    instance_id: int  # changes when the daemon restarts
    is_restart: bool  # the daemon was restarted before this block: segments and scans start anew, what was lost is unknown

    @property
    def topic(self) -> str:
        return self.format.topic

    @property
    def rig(self) -> str:
        return self.format.topic.partition("/")[0]

    @property
    def channels(self) -> tuple[str, ...]:
        return self.format.channels

    @property
    def units(self) -> tuple[str, ...]:
        return self.format.units

    @property
    def scans(self) -> NDArray[np.int64]:
        """Index of each scan within the segment."""
        return np.arange(self.first_scan, self.first_scan + len(self), dtype=np.int64)

    @property
    def time_s(self) -> NDArray[np.float64]:
        """CLOCK_MONOTONIC of the daemon's host: compares with time.monotonic() there."""
        return (self.host_time_ns + self._since_first_ns()) * 1e-9

    @property
    def utc(self) -> Times:
        return to_utc(self._since_first_ns().astype(np.int64), self.host_time_ns + self.utc_minus_monotonic_ns)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, channel: str) -> NDArray[np.float32]:
        """A channel by its name: block["ap_mm"]."""
        return column(self.values, self.channels, channel)

    def _since_first_ns(self) -> NDArray[np.float64]:
        since_first_ns: NDArray[np.float64] = np.rint(np.arange(len(self)) * (1e9 * self.rate.denominator / self.rate.numerator))
        return since_first_ns


@dataclasses.dataclass(frozen=True)
class Missing:
    """Scans that are not there, before row `index` of the arrays."""

    index: int
    scans: int  # at least, if not exact
    is_exact: bool
    reason: str  # "overrun", "unplugged", ...: of the device; "lost": on the way here; "restart": of the daemon, no number is known


@dataclasses.dataclass(frozen=True, eq=False)
class Samples:
    """Scans of one stream in one piece; `daemon.record` and `dts.load` make the same."""

    name: str  # "floor/cop"
    channels: tuple[str, ...]
    units: tuple[str, ...]
    rate: Fraction | None  # None: irregular, each scan has its own time
    delay_s: float
    values: NDArray[np.generic]  # scans x channels
    segments: NDArray[np.int64]
    scans: NDArray[np.int64]  # index within the segment
    time_s: NDArray[np.float64]  # CLOCK_MONOTONIC of the daemon's host
    utc_minus_monotonic_ns: int
    gaps: tuple[Missing, ...]

    @property
    def utc(self) -> Times:
        return to_utc(np.rint(self.time_s * 1e9), self.utc_minus_monotonic_ns)

    @property
    def duration_s(self) -> float:
        """From the first to the last scan."""
        return float(self.time_s[-1] - self.time_s[0]) if len(self) else 0.0

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, channel: str) -> NDArray[np.generic]:
        """A channel by its name: samples["ap_mm"]."""
        return column(self.values, self.channels, channel)

    def __str__(self) -> str:
        rate = f"{float(self.rate):g} Hz" if self.rate else "irregular"
        return f"{self.name}: {len(self)} scans of {', '.join(self.channels)} at {rate}, {len(self.gaps)} gaps"


def column(values: NDArray[_Scalar], channels: tuple[str, ...], channel: str) -> NDArray[_Scalar]:
    try:
        return values[:, channels.index(channel)]
    except ValueError:
        raise KeyError(f"no channel '{channel}'; there are {', '.join(channels)}") from None


def to_utc(time_ns: NDArray[np.float64] | NDArray[np.int64], offset_ns: int) -> Times:
    """Times beyond what 64 bits hold come from a damaged peer or file: they are undefined, not wrapped."""
    times = np.asarray(time_ns, dtype=np.float64) + offset_ns
    is_known = (np.abs(times) < 9.2e18) & (abs(offset_ns) < 2**63)
    whole = np.where(is_known, time_ns, 0).astype(np.int64) + np.int64(offset_ns if abs(offset_ns) < 2**63 else 0)
    return np.where(is_known, whole.astype("datetime64[ns]"), np.datetime64("NaT"))
