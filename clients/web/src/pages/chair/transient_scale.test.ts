// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';

import type { Block } from '../../link/types';
import { noExamination } from './examination';
import { TransientRing } from './transient_ring';
import { fitRange, gridStep, timeWindow } from './transient_scale';

const ringUntil = (endScan: number): TransientRing => {
  const ring = new TransientRing(16);
  ring.push({ firstScan: endScan - 1, scanCount: 1, columns: [Float32Array.of(1)], segment: 0, rateHz: 100 } as unknown as Block);
  return ring;
};
const goAt = { segment: 0, scan: 1000 };

describe('TimeWindow', () => {
  it('WithoutExamination.PassesByUntilNow', () => {
    expect(timeWindow(noExamination, ringUntil(5000))).toEqual({ zeroScan: 5000, fromS: -10, toS: 0, isTrial: false });
  });

  it('InATrial.StandsStillAtGo', () => {
    const examination = { ...noExamination, step: 'go', goAt } as const;

    expect(timeWindow(examination, ringUntil(1100))).toEqual(timeWindow(examination, ringUntil(1500)));
    expect(timeWindow(examination, ringUntil(1100)).zeroScan).toBe(1000);
  });

  it('LongTrial.WidensInSteps', () => {
    const examination = { ...noExamination, step: 'go', goAt } as const;

    expect(timeWindow(examination, ringUntil(1000 + 610)).toS).toBe(8);
    expect(timeWindow(examination, ringUntil(1000 + 790)).toS).toBe(8);
  });

  it('GoOfASegmentThatIsOver.IsNotShown', () => {
    const examination = { ...noExamination, step: 'go', goAt: { segment: 3, scan: 1000 } } as const;

    expect(timeWindow(examination, ringUntil(1100)).isTrial).toBe(false);
  });
});

describe('FitRange', () => {
  it('ValuesInside.DoNotMoveTheAxis', () => {
    const range = { low: 3, high: 7 };

    expect(fitRange(range, 3.2, 6.5)).toBe(range);
  });

  it('ValueOutside.WidensWithRoom', () => {
    expect(fitRange({ low: 3, high: 5 }, 3.7, 5.2)).toEqual({ low: 3, high: 6 });
  });

  it('LargelyEmpty.Shrinks', () => {
    expect(fitRange({ low: 0, high: 20 }, 3.6, 3.8)).toEqual({ low: 3, high: 5 });
  });

  it('NothingToShow.DoesNotMoveTheAxis', () => {
    const range = { low: 3, high: 7 };

    expect(fitRange(range, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY)).toBe(range);
  });
});

describe('GridStep', () => {
  it.each([
    [2, 0.5],
    [5, 1],
    [9, 2],
    [40, 10],
  ])('Range%d.HasRoundSteps', (range, step) => {
    expect(gridStep(range, 5)).toBeCloseTo(step);
  });
});
