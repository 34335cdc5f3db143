// SPDX-License-Identifier: Apache-2.0
import type { ScanRing } from '../../parts/scan_ring';

export interface Ellipse {
  readonly centreX: number;
  readonly centreY: number;
  /** Semi-axes in mm, the longer first. */
  readonly long: number;
  readonly short: number;
  /** Angle of the long axis, from x towards y. */
  readonly angleRad: number;
  readonly samples: number;
}

const fewestSamples = 10;

/** Returns the 95 % prediction ellipse of the points from `fromMs` to `toMs`: semi-axis^2 = eigenvalue * (N^2 - 1) / N * (0.05^(-2 / (N - 2)) - 1). */
export const ellipseOf = (ring: ScanRing, xChannel: number, yChannel: number, fromMs: number, toMs: number): Ellipse | undefined => {
  let [n, meanX, meanY, sumXx, sumXy, sumYy] = [0, 0, 0, 0, 0, 0];
  const end = ring.indexAt(toMs);
  for (let index = ring.indexAt(fromMs); index < end; index += 1) {
    const x = ring.value(xChannel, index);
    const y = ring.value(yChannel, index);
    if (Number.isNaN(x) || Number.isNaN(y)) continue;
    n += 1; // Welford's recurrence avoids differences of large sums
    const [stepX, stepY] = [x - meanX, y - meanY];
    meanX += stepX / n;
    meanY += stepY / n;
    sumXx += stepX * (x - meanX);
    sumXy += stepX * (y - meanY);
    sumYy += stepY * (y - meanY);
  }
  if (n < fewestSamples) return undefined;
  const [varX, covariance, varY] = [sumXx / (n - 1), sumXy / (n - 1), sumYy / (n - 1)];
  const factor = ((n * n - 1) / n) * (0.05 ** (-2 / (n - 2)) - 1);
  const half = Math.hypot((varX - varY) / 2, covariance);
  const middle = (varX + varY) / 2;
  return {
    centreX: meanX,
    centreY: meanY,
    long: Math.sqrt(factor * (middle + half)),
    short: Math.sqrt(factor * Math.max(0, middle - half)),
    angleRad: Math.atan2(2 * covariance, varX - varY) / 2,
    samples: n,
  };
};

export const areaOf = (ellipse: Ellipse): number => Math.PI * ellipse.long * ellipse.short;

/** Returns the ellipse with the given area: picture and tile then show the same, although the daemon low-passes the scans first. */
export const withArea = (ellipse: Ellipse, areaMm2: number): Ellipse => {
  const factor = Math.sqrt(areaMm2 / areaOf(ellipse));
  return Number.isFinite(factor) ? { ...ellipse, long: factor * ellipse.long, short: factor * ellipse.short } : ellipse;
};
