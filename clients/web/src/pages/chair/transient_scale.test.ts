// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import type { Block } from '../../link/types';
import type { Examination } from './examination';
import { noExamination } from './examination';
import { TransientRing } from './transient_ring';
import type { Range } from './transient_scale';
import { fitRange, gridStep, timeWindow } from './transient_scale';

const ringUntil = (endScan: number): TransientRing => {
  const ring = new TransientRing(16);
  ring.push({ firstScan: endScan - 1, scanCount: 1, columns: [Float32Array.of(1)], segment: 0, rateHz: 100 } as unknown as Block);
  return ring;
};
const goAt = { segment: 0, scan: 1000 };

const go = { ...noExamination, step: 'go', goAt } as const;

test.each<[string, Examination, number, object]>([
  ['WithoutExamination passes by until now', noExamination, 5000, { zeroScan: 5000, fromS: -10, toS: 0, isTrial: false }],
  ['ReadyTrial waits for its go', { ...noExamination, step: 'ready' }, 900, { zeroScan: 900, fromS: -1, toS: 6, isTrial: true }],
  ['Trial begins at go', go, 1100, { zeroScan: 1000, fromS: -1, toS: 6, isTrial: true }],
  ['Trial stands still', go, 1600, { zeroScan: 1000, fromS: -1, toS: 6, isTrial: true }],
  ['LongTrial widens in steps', go, 1610, { zeroScan: 1000, fromS: -1, toS: 8, isTrial: true }],
  ['LongTrial stands still again', go, 1790, { zeroScan: 1000, fromS: -1, toS: 8, isTrial: true }],
  ['LongReturn widens as well', { ...go, step: 'back' }, 1810, { zeroScan: 1000, fromS: -1, toS: 10, isTrial: true }],
  ['EndlessTrial is cut off', go, 9000, { zeroScan: 1000, fromS: -1, toS: 16, isTrial: true }],
  ['Rest stays at the trial', { ...go, step: 'resting' }, 1900, { zeroScan: 1000, fromS: -1, toS: 6, isTrial: true }],
  ['GoOfASegmentThatIsOver is not shown', { ...go, goAt: { segment: 3, scan: 1000 } }, 1100, { zeroScan: 1100, fromS: -10, toS: 0, isTrial: false }],
])('timeWindow.%s', (_, examination, endScan, expected) => {
  expect(timeWindow(examination, ringUntil(endScan))).toEqual(expected);
});

test.each<[string, Range, readonly [number, number], Range]>([
  ['ValuesInside do not move the axis', { low: 3, high: 7 }, [3.2, 6.5], { low: 3, high: 7 }],
  ['ValuesAtItsEnds neither', { low: 3, high: 7 }, [3, 7], { low: 3, high: 7 }],
  ['ValueAbove widens with room', { low: 3, high: 5 }, [3.7, 5.2], { low: 3, high: 6 }],
  ['ValueBelow as well', { low: 3, high: 5 }, [2.8, 4.2], { low: 2, high: 5 }],
  ['LargelyEmpty shrinks', { low: 0, high: 20 }, [3.6, 3.8], { low: 3, high: 5 }],
  ['HalfEmpty stays', { low: 0, high: 5 }, [1.2, 1.8], { low: 0, high: 5 }],
  ['NothingToShow does not move the axis', { low: 3, high: 7 }, [Infinity, -Infinity], { low: 3, high: 7 }],
])('fitRange.%s', (_, present, [low, high], expected) => {
  expect(fitRange(present, low, high)).toEqual(expected);
});

test.each([
  [2, 0.5],
  [5, 1],
  [7.4, 1],
  [9, 2],
  [17.6, 5],
  [40, 10],
])('gridStep.Range %d has round steps of %d', (range, step) => {
  expect(gridStep(range, 5)).toBeCloseTo(step);
});
