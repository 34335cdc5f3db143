// SPDX-License-Identifier: Apache-2.0
// The ranges of time and of the transient that the picture shows.
import type { Examination } from './examination';
import { leadS } from './ghosts';
import type { TransientRing } from './transient_ring';

export interface TimeWindow {
  readonly zeroScan: number; // the scan at 0 of the axis: Go, or now
  readonly fromS: number;
  readonly toS: number;
  readonly isTrial: boolean;
}

const freeS = 10;
const trialS = 6;
const stepS = 2; // a longer trial widens the axis in these steps, so that it does not creep

/** During a trial the axis starts at Go and stays; otherwise it shows the last ten seconds and moves. */
export const timeWindow = (examination: Examination, ring: TransientRing): TimeWindow => {
  const { step, goAt } = examination;
  if (goAt !== undefined && goAt.segment === ring.segment) {
    const elapsedS = (ring.endScan - goAt.scan) / ring.rateHz;
    const isMeasured = step === 'go' || step === 'back';
    const longerS = isMeasured && elapsedS > trialS ? Math.ceil((elapsedS - trialS) / stepS) * stepS : 0;
    return { zeroScan: goAt.scan, fromS: -leadS, toS: trialS + Math.min(longerS, freeS), isTrial: true };
  }
  if (step === 'ready') return { zeroScan: ring.endScan, fromS: -leadS, toS: trialS, isTrial: true };
  return { zeroScan: ring.endScan, fromS: -freeS, toS: 0, isTrial: false };
};

export interface Range {
  readonly low: number;
  readonly high: number;
}

const roomMm = 0.5;
const leastMm = 2; // otherwise the noise of a person who sits still would fill the screen

/** Returns a range that holds the values with some room. It changes in steps and shrinks only if mostly empty: an axis that moves all the time looks like data. */
export const fitRange = (present: Range, low: number, high: number): Range => {
  if (!(low <= high)) return present;
  const isInside = low >= present.low && high <= present.high;
  const isLargelyEmpty = Math.max(high - low + 2 * roomMm, leastMm) < 0.4 * (present.high - present.low);
  if (isInside && !isLargelyEmpty) return present;
  const floor = Math.floor((low - roomMm) / roomMm) * roomMm;
  const ceiling = Math.ceil((high + roomMm) / roomMm) * roomMm;
  return { low: floor, high: Math.max(ceiling, floor + leastMm) };
};

/** Returns the distance of about `about` grid lines: 1, 2 or 5 times a power of ten. */
export const gridStep = (range: number, about: number): number => {
  const rough = range / about;
  const power = 10 ** Math.floor(Math.log10(rough));
  const factor = rough / power;
  return power * (factor < 1.5 ? 1 : factor < 3.5 ? 2 : factor < 7.5 ? 5 : 10);
};
