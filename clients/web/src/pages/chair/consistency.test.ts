// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';

import { TrialRecordSchema } from '../../generated/dts/v1/sessions_pb';
import type { TrialRecord } from '../../generated/dts/v1/sessions_pb';
import { byTarget, standardDeviation, thesisWindows } from './consistency';

const trial = (condition: string, targetCm: number, trunkDeg: number, trunkClass: number, expectedClass: number, outcome = 'done'): TrialRecord =>
  create(TrialRecordSchema, { condition, outcome, result: { condition, targetCm, expectedClass, movement: { trunkClass, trunkDeg } } });

describe('ByTarget', () => {
  it('TrialsOfTwoTargets.AreSummarisedNearestFirst', () => {
    const summaries = byTarget([trial('max', 124, 50, 3, 3), trial('120', 80, 3, 1, 1), trial('max', 124, 54, 2, 3)]);

    expect(summaries.map(({ condition }) => condition)).toEqual(['120', 'max']);
    expect(summaries[1]).toMatchObject({ trials: 2, meanDeg: 52, window: thesisWindows[2] });
    expect(summaries[1]?.sdDeg).toBeCloseTo(Math.sqrt(8));
    expect(summaries[0]?.sdDeg).toBeNaN();
  });

  it.each(['redone', 'rejected', 'aborted'])('TrialThatWas %s.IsInNoResult', (outcome) => {
    expect(byTarget([trial('120', 80, 3, 1, 1, outcome)])).toEqual([]);
  });

  it('RejectedReach.CountsAsATrialWithoutAngle', () => {
    const [summary] = byTarget([trial('120', 80, 9, -1, 1), trial('120', 80, 3, 1, 1)]);

    expect(summary).toMatchObject({ trials: 2, withAngle: 1, meanDeg: 3 });
  });

  it('TargetOfTheArmAlone.HasNoWindow', () => {
    expect(byTarget([trial('80', 53, 0, 0, 0)])[0]?.window).toBeUndefined();
  });
});

describe('StandardDeviation', () => {
  it('OfASample.IsDividedByOneLess', () => {
    expect(standardDeviation([1, 2, 3, 4])).toBeCloseTo(1.29099, 5);
  });
});
