#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The measures of quiet standing as one would write them down with NumPy and SciPy, for sway_bench --numpy.

sway_peers.py FILE.csv RATE_HZ: rows of ML, AP in mm. Prints, separated by tabs, "time PART ms" (median of some rounds, CPU of this
process) and "value SYMBOL number", so that the bench can say by how much the two programs differ.
"""
import statistics
import sys
import time

import numpy as np
from scipy.signal import butter, filtfilt, welch
from scipy.spatial import ConvexHull
from scipy.spatial.distance import pdist


def prepare(series, rate):
    b, a = butter(4, 10.0 / (rate / 2.0))
    step = max(1, round(rate / 100.0))
    kept = filtfilt(b, a, series, axis=0)[::step]
    return kept - kept.mean(axis=0), rate / step


def time_domain(cop, rate):
    ml, ap = cop.T
    n = len(cop)
    duration = n / rate
    rd = np.hypot(ml, ap)
    steps = np.diff(cop, axis=0)
    path = np.hypot(*steps.T).sum()
    hull = ConvexHull(cop)
    det = np.linalg.det(np.cov(ml, ap))
    speed = np.abs(steps) * rate
    window = int(round(2 * rate))
    whole = len(speed) // window * window
    heading_step = max(1, round(rate / 25.0))
    slow = np.diff(cop[::heading_step], axis=0)
    slow = slow[(slow != 0.0).any(axis=1)]
    turn = np.diff(np.arctan2(slow[:, 1], slow[:, 0]))
    turn = np.degrees((turn + np.pi) % (2.0 * np.pi) - np.pi)
    return {
        "MDIST": rd.mean(), "RDIST": np.sqrt((rd**2).mean()), "TOTEX": path, "MVELO": path / duration,
        "MDIST_AP": np.abs(ap).mean(), "RDIST_AP": ap.std(), "TOTEX_AP": np.abs(steps[:, 1]).sum(),
        "RANGE": pdist(cop[hull.vertices]).max(), "RANGE_AP": np.ptp(ap), "RANGE_ML": np.ptp(ml), "MAXDIST": rd.max(),
        "PEA95_F": np.pi * np.sqrt(det) * ((n * n - 1) / n) * (0.05 ** (-2 / (n - 2)) - 1),
        "AREA_HULL": hull.volume, "AREA_SW": np.abs(ap[1:] * ml[:-1] - ap[:-1] * ml[1:]).sum() / (2 * duration),
        "MFREQ": path / (2 * np.pi * rd.mean() * duration), "VMAX_AP": speed[:, 1].max(),
        "AAMV2S_AP": speed[:whole, 1].reshape(-1, window).max(axis=1).mean(),
        "HC_MEANABS": np.abs(turn).mean(),
    }


def multitaper(x, rate):
    n = len(x)
    k = np.arange(1, 9)[:, None]
    tapers = np.sqrt(2.0 / (n + 1)) * np.sin(np.pi * k * np.arange(1, n + 1) / (n + 1))
    density = 2.0 / (8 * rate) * (np.abs(np.fft.rfft(tapers * x, axis=1)) ** 2).sum(axis=0)
    f = np.arange(len(density)) * rate / n
    band = (f >= 0.15 - 1e-9) & (f <= 5.0 + 1e-9)
    return f[band], density[band]


def spectra(cop, rate):
    ml, ap = cop.T
    rd = np.hypot(ml, ap)
    values = {}
    for name, x in (("RD", rd - rd.mean()), ("AP", ap), ("ML", ml)):
        f, density = multitaper(x, rate)
        mu = [(f**k * density).sum() for k in range(3)]
        running = np.cumsum(density)
        values[f"POWER_{name}_MT8"] = mu[0] * (f[1] - f[0])
        values[f"PF50_{name}_MT8"] = f[np.searchsorted(running, 0.5 * running[-1])]
        values[f"PF95_{name}_MT8"] = f[np.searchsorted(running, 0.95 * running[-1])]
        values[f"CFREQ_{name}_MT8"] = np.sqrt(mu[2] / mu[0])
        values[f"FREQD_{name}_MT8"] = np.sqrt(1 - mu[1] ** 2 / (mu[0] * mu[2]))
        values[f"MPF_{name}_MT8"] = mu[1] / mu[0]
    weighted = total = 0.0
    segment = (len(cop) + 1) // 2
    for x in (ap, ml):
        f, power = welch(x, rate, "hann", segment, segment // 2)
        weighted += np.trapz(f * power, f) / np.trapz(power, f) * power.sum()
        total += power.sum()
    values["MPF_RES_WELCHHALF"] = weighted / total
    return values


def random_walk(cop, rate):
    values = {}
    lags = np.unique(np.round(np.arange(1, 1001) * 0.01 * rate).astype(int))
    lags = lags[(lags > 0) & (lags <= len(cop) // 2)]
    tau = lags / rate
    for axis, x in (("ML", cop[:, 0]), ("AP", cop[:, 1])):
        msd = np.array([((x[k:] - x[:-k]) ** 2).mean() for k in lags])
        for region, low, high in (("S", 0.0, 0.5), ("L", 2.0, 10.0)):
            inside = (tau >= low - 1e-9) & (tau <= high + 1e-9)
            values[f"SDA_D{region}_{axis}"] = np.polyfit(tau[inside], msd[inside], 1)[0] / 2
            values[f"SDA_H{region}_{axis}"] = np.polyfit(np.log(tau[inside]), np.log(msd[inside]), 1)[0] / 2
        values[f"MSD_{axis}_1s"] = msd[np.argmin(np.abs(tau - 1.0))]
    return values


def sample_entropy(x, m=2, r=0.2):
    tolerance = r * x.std()
    n = len(x) - m
    columns = [x[k : k + n] for k in range(m + 1)]
    near = np.ones((n, n), dtype=bool)
    pairs = []
    for k, column in enumerate(columns):
        near &= np.abs(column[:, None] - column[None, :]) <= tolerance
        if k >= m - 1:
            pairs.append((near.sum() - n) // 2)
    return -np.log(pairs[1] / pairs[0])


def entropy(cop, rate):
    kept = cop[:: max(1, round(rate / 20.0))]
    return {"SAMPEN_ML_20HZ": sample_entropy(kept[:, 0]), "SAMPEN_AP_20HZ": sample_entropy(kept[:, 1])}


def main():
    series = np.loadtxt(sys.argv[1], delimiter=",")
    rate = float(sys.argv[2])
    cop, analysis_rate = prepare(series, rate)
    parts = {
        "prepare": lambda: prepare(series, rate) and {},
        "time domain": lambda: time_domain(cop, analysis_rate),
        "spectra": lambda: spectra(cop, analysis_rate),
        "random walk": lambda: random_walk(cop, analysis_rate),
        "entropy": lambda: entropy(cop, analysis_rate),
    }
    whole = 0.0
    for name, part in parts.items():
        values = part()
        times = []
        for _ in range(7):
            begun = time.process_time()
            part()
            times.append(1e3 * (time.process_time() - begun))
        whole += statistics.median(times)
        print(f"time\t{name}\t{statistics.median(times)}")
        for symbol, value in values.items():
            print(f"value\t{symbol}\t{float(value)!r}")
    print(f"time\tall\t{whole}")


if __name__ == "__main__":
    main()
