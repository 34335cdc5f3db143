# SPDX-License-Identifier: Apache-2.0
# Records the centre of pressure of a standing person, measures the sway and draws the stabilogram. Start scripts/demo in another terminal,
# then run here:
#
#     export DTSD_RUNTIME_DIR=...                   # the line that the demo prints
#     PYTHONPATH=clients/python/src python3 clients/python/examples/stabilogram.py stabilogram.png
#
# Each `# %%` begins a cell, for editors that support cells.

# %%
import os
import sys
from pathlib import Path

import matplotlib

if not os.environ.get("DISPLAY") and not os.environ.get("WAYLAND_DISPLAY"):
    matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Ellipse
from numpy.typing import NDArray

import dts

picture = Path(sys.argv[1] if len(sys.argv) > 1 else "stabilogram.png")
seconds = float(sys.argv[2] if len(sys.argv) > 2 else 20.0)

# %% Wait until a person is on the plate, then record. The daemon publishes its own measures as events at the same time.
with dts.connect() as daemon:
    for block in daemon.stream("floor/cop", timeout=10):
        if np.nanmean(block["load_n"]) > 50 and not np.isnan(block["ml_mm"]).any():
            break
    running = daemon.events("floor/sway")
    cop = daemon.record("floor/cop", seconds)
    sway = next(event for event in running if event.fields["is_preliminary"] and event.scan >= cop.scans[-1] - 50)
print(cop)


# %% Compute the same measures as the daemon. The daemon filters at 10 Hz first, because sensor noise would lengthen the path.
def smoothed(position_mm: NDArray[np.float64], rate_hz: float, limit_hz: float = 10.0) -> NDArray[np.float64]:
    """Returns the position after a low-pass in the frequency domain. The signal is mirrored at its ends to avoid steps."""
    mirrored = np.r_[2 * position_mm[0] - position_mm[:0:-1], position_mm, 2 * position_mm[-1] - position_mm[-2::-1]]
    trend = np.linspace(mirrored[0], mirrored[-1], len(mirrored))
    spectrum = np.fft.rfft(mirrored - trend)
    frequency_hz = np.fft.rfftfreq(len(mirrored), 1 / rate_hz)
    kept = spectrum / (1 + (frequency_hz / limit_hz) ** 4)  # Butterworth, second order, forward and back: no delay
    filtered = np.fft.irfft(kept, len(mirrored)) + trend
    return np.asarray(filtered[len(position_mm) - 1 : 2 * len(position_mm) - 1])


if cop.gaps or np.isnan(cop["ml_mm"]).any():
    sys.exit("scans are missing, or the person left the plate: record again")
rate_hz = float(cop.rate or 0)
ml_mm = smoothed(cop["ml_mm"].astype(float), rate_hz)
ap_mm = smoothed(cop["ap_mm"].astype(float), rate_hz)
velocity_mm_s = np.hypot(np.diff(ml_mm), np.diff(ap_mm)).sum() / (len(cop) / rate_hz)

# 95 % prediction ellipse (Schubert & Kirchner 2014): its axes are those of the covariance, scaled by the F distribution, which with two
# degrees of freedom needs no table: F = (n - 2) / 2 (0.05^(-2 / (n - 2)) - 1).
n = len(cop)
variances, axes = np.linalg.eigh(np.cov(ml_mm, ap_mm))
f_95 = (n - 2) / 2 * (0.05 ** (-2 / (n - 2)) - 1)
half_axes_mm = np.sqrt(2 * (n - 1) * (n + 1) / (n * (n - 2)) * f_95 * variances)
area_mm2 = np.pi * half_axes_mm.prod()

daemon_values = {symbol: measure["value"] for symbol, measure in sway.fields["measures"].items()}
print(f"                          here, {n / rate_hz:4.1f} s   daemon, {sway.fields['duration_s']:5.1f} s so far")
print(f"mean velocity (mm/s)      {velocity_mm_s:12.2f}   {daemon_values['MVELO']:12.2f}")
print(f"95 % ellipse area (mm2)   {area_mm2:12.1f}   {daemon_values['PEA95_F']:12.1f}")

# %% Draw the stabilogram with the same scale on both axes: front is at the top, the subject's right is at the right.
figure, plots = plt.subplot_mosaic([["map", "ap"], ["map", "ml"]], figsize=(11, 5.5), width_ratios=(1, 1.2), layout="constrained")
blue, orange = "#0072B2", "#D55E00"  # distinguishable for colour-blind people (Okabe & Ito)
middle = (ml_mm.mean(), ap_mm.mean())

plots["map"].plot(ml_mm, ap_mm, color=blue, linewidth=0.8)
angle_deg = np.degrees(np.arctan2(axes[1, 1], axes[0, 1]))
plots["map"].add_patch(
    Ellipse(middle, 2 * half_axes_mm[1], 2 * half_axes_mm[0], angle=angle_deg, fill=False, edgecolor=orange, linewidth=1.8)
)
plots["map"].plot(*middle, "+", color=orange, markersize=10)
plots["map"].set_aspect("equal", adjustable="datalim")
plots["map"].set(xlabel="left   ML (mm)   right", ylabel="back   AP (mm)   front", title=f"95 % ellipse: {area_mm2:.0f} mm²")
plots["map"].margins(0.08)

elapsed_s = cop.time_s - cop.time_s[0]
for name, position_mm in (("ap", ap_mm), ("ml", ml_mm)):
    plots[name].plot(elapsed_s, position_mm, color=blue, linewidth=1.2)
    plots[name].set(ylabel=f"{name.upper()} (mm)", xlim=(0, elapsed_s[-1]))
plots["ap"].set_title(f"mean velocity: {velocity_mm_s:.1f} mm/s")
plots["ap"].tick_params(labelbottom=False)
plots["ml"].set_xlabel("time (s)")
for axis in plots.values():
    axis.grid(color="0.9")
    axis.spines[["top", "right"]].set_visible(False)
figure.suptitle(f"{cop.name}, {len(cop) / rate_hz:.0f} s from {np.datetime_as_string(cop.utc[0], unit='s')} UTC")
figure.savefig(picture, dpi=120)
print(f"drawn: {picture}")
