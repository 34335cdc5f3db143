// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { comparable, compare, difference, shareOfChange } from './comparison';

interface Result {
  name: string;
  value: number;
  unit?: string;
  details?: string;
}

const session = (id: string, started: number, results: readonly Result[], more: { rig?: string; subject?: string } = {}): SessionRecord =>
  create(SessionRecordSchema, { sessionId: id, startedUtcNs: BigInt(started), rig: 'floor', subject: 'P017', results: [...results], ...more });

const length = (seconds: number): Result => ({ name: 'eyes-open/MVELO', value: 9, unit: 'mm/s', details: JSON.stringify({ duration_s: seconds }) });

describe('Compare', () => {
  it('TwoSessions.StandOldestFirstWithTheChange', () => {
    const { sessions, figures } = compare([
      session('new', 2, [{ name: 'MVELO', value: 12, unit: 'mm/s' }]),
      session('old', 1, [{ name: 'MVELO', value: 8, unit: 'mm/s' }]),
    ]);

    expect(sessions.map(({ sessionId }) => sessionId)).toEqual(['old', 'new']);
    expect(figures[0]?.values).toEqual([8, 12]);
    expect(difference(8, 12)).toBe(4);
    expect(shareOfChange(figures[0]!, 0, 1)).toBe(0.5);
  });

  it('FigureOfOneSessionOnly.HasNoChange', () => {
    const { figures } = compare([session('a', 1, [{ name: 'MVELO', value: 8 }]), session('b', 2, [{ name: 'RDIST', value: 3 }])]);

    expect(figures.map(({ values }) => values)).toEqual([
      [8, undefined],
      [undefined, 3],
    ]);
    expect(shareOfChange(figures[0]!, 0, 1)).toBeUndefined();
  });

  it('UndefinedValue.IsNotANumber', () => {
    const { figures } = compare([session('a', 1, [{ name: 'x', value: Number.NaN }]), session('b', 2, [{ name: 'x', value: 1 }])]);

    expect(figures[0]?.values).toEqual([undefined, 1]);
  });

  it.each([
    ['Degrees', { unit: 'deg', values: [10, 20] }],
    ['NegativeScore', { unit: '1', values: [-2, -1] }],
    ['Zero', { unit: 'mm', values: [0, 1] }],
  ])('%s.HaveNoShareOfChange', (_, figure) => {
    expect(shareOfChange({ name: 'x', ...figure }, 0, 1)).toBeUndefined();
  });

  it('TrialsOfOtherLengths.AreWarnedOfOnce', () => {
    const { cautions } = compare([session('a', 1, [length(30), { ...length(30), name: 'eyes-open/RDIST' }]), session('b', 2, [length(60), { ...length(60), name: 'eyes-open/RDIST' }])]);

    expect(cautions).toEqual([{ kind: 'analysis', condition: 'eyes-open', of: 'duration_s', one: '30', other: '60' }]);
  });

  it('TrialsOfNearlyTheSameLength.Compare', () => {
    expect(compare([session('a', 1, [length(30)]), session('b', 2, [length(30.01)])]).cautions).toEqual([]);
  });

  it('OtherUnitSubjectAndUnevenLength.AreWarnedOf', () => {
    const one = session('a', 1, [length(30)]);
    const other = session('b', 2, [{ name: 'eyes-open/MVELO', value: 1, unit: 'm/s', details: '{}' }], { subject: 'P018' });

    expect(compare([one, other]).cautions.map(({ kind }) => kind)).toEqual(['subjects', 'unit', 'uneven']);
  });

  it('DetailsThatAreNoJson.AreNotBelieved', () => {
    const broken = { ...length(30), details: '{"duration_s":' };

    expect(compare([session('a', 1, [broken]), session('b', 2, [broken])]).cautions).toEqual([]);
  });
});

describe('Comparable', () => {
  it('SessionsOfOtherRigsAndWithoutFigures.AreLeftOut', () => {
    const sessions = [
      session('empty', 4, []),
      session('newest', 3, [{ name: 'x', value: 1 }], { rig: 'chair' }),
      session('floor', 2, [{ name: 'x', value: 1 }]),
      session('oldest', 1, [{ name: 'x', value: 1 }], { rig: 'chair' }),
    ];

    expect(comparable(sessions).map(({ sessionId }) => sessionId)).toEqual(['newest', 'oldest']);
  });
});
