// SPDX-License-Identifier: Apache-2.0
// What part of time and of the transient a picture shows.
import type { Examination } from './examination';
import { leadS } from './ghosts';
import type { TransientRing } from './transient_ring';

export interface TimeWindow {
  readonly zeroScan: number; // where the axis says 0: "Go", or now
  readonly fromS: number;
  readonly toS: number;
  readonly isTrial: boolean;
}

const freeS = 10;
const trialS = 6;
const stepS = 2; // a trial that lasts longer widens the axis by this, so that it does not creep

/** During a trial time counts from "Go" and stands still; else the last ten seconds pass by. */
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
const leastMm = 2; // or the noise of somebody who sits still would fill the screen

/** Holds what is seen with some room; changes in steps, and shrinks only when most of it is empty: an axis that breathes looks like data. */
export const fitRange = (present: Range, low: number, high: number): Range => {
  if (!(low <= high)) return present;
  const isInside = low >= present.low && high <= present.high;
  const isLargelyEmpty = Math.max(high - low + 2 * roomMm, leastMm) < 0.4 * (present.high - present.low);
  if (isInside && !isLargelyEmpty) return present;
  const floor = Math.floor((low - roomMm) / roomMm) * roomMm;
  const ceiling = Math.ceil((high + roomMm) / roomMm) * roomMm;
  return { low: floor, high: Math.max(ceiling, floor + leastMm) };
};

/** Distance of the grid's lines: 1, 2 or 5 times a power of ten, `about` of them. */
export const gridStep = (range: number, about: number): number => {
  const rough = range / about;
  const power = 10 ** Math.floor(Math.log10(rough));
  const factor = rough / power;
  return power * (factor < 1.5 ? 1 : factor < 3.5 ? 2 : factor < 7.5 ? 5 : 10);
};
