// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { comparable, compare, difference, shareOfChange } from './comparison';

interface Result {
  name: string;
  value: number;
  unit?: string;
  details?: string;
}

const session = (id: string, started: number, results: readonly Result[], more: { rig?: string; subject?: string; fields?: Record<string, string> } = {}): SessionRecord =>
  create(SessionRecordSchema, { sessionId: id, startedUtcNs: BigInt(started), rig: 'floor', subject: 'P017', results: [...results], ...more });

const length = (seconds: number): Result => ({ name: 'eyes-open/MVELO', value: 9, unit: 'mm/s', details: JSON.stringify({ duration_s: seconds }) });

const mvelo = (value: number): Result => ({ name: 'MVELO', value, unit: 'mm/s' });

test.each<[string, SessionRecord[], readonly (readonly unknown[])[]]>([
  ['TwoSessions are oldest first', [session('new', 2, [mvelo(12)]), session('old', 1, [mvelo(8)])], [[8, 12]]],
  ['ResultOfOneSession has no other', [session('a', 1, [{ name: 'MVELO', value: 8 }]), session('b', 2, [{ name: 'RDIST', value: 3 }])], [[8, undefined], [undefined, 3]]],
  ['UndefinedValue is left out', [session('a', 1, [{ name: 'x', value: NaN }]), session('b', 2, [{ name: 'x', value: 1 }])], [[undefined, 1]]],
])('compare.%s', (_, sessions, values) => {
  expect(compare(sessions).results.map((result) => result.values)).toEqual(values);
});

test.each<[string, string, (number | undefined)[], number | undefined, number | undefined]>([
  ['Length', 'mm/s', [8, 12], 4, 0.5],
  ['Degrees', 'deg', [10, 20], 10, undefined],
  ['NegativeScore', '1', [-2, -1], 1, undefined],
  ['Zero', 'mm', [0, 1], 1, undefined],
  ['Unknown', 'mm', [8, undefined], undefined, undefined],
])('shareOfChange.%s', (_, unit, values, apart, share) => {
  expect([difference(values[0], values[1]), shareOfChange({ name: 'x', unit, values }, 0, 1)]).toEqual([apart, share]);
});

test.each<[string, readonly Result[], readonly Result[], readonly object[]]>([
  ['TrialsOfOtherLengths once', [length(30), { ...length(30), name: 'eyes-open/RDIST' }], [length(60), { ...length(60), name: 'eyes-open/RDIST' }],
    [{ kind: 'analysis', condition: 'eyes-open', of: 'duration_s', one: '30', other: '60' }]],
  ['TrialsOfNearlyTheSameLength not', [length(30)], [length(30.01)], []],
  ['OtherUnit and a length that one has', [length(30)], [{ name: 'eyes-open/MVELO', value: 1, unit: 'm/s', details: '{}' }], [{ kind: 'unit' }, { kind: 'uneven' }]],
  ['DetailsThatAreNoJson not', [{ ...length(30), details: '{"duration_s":' }], [{ ...length(30), details: '{"duration_s":' }], []],
])('compare.Warns of %s', (_, one, other, cautions) => {
  expect(compare([session('a', 1, one), session('b', 2, other)]).cautions).toMatchObject(cautions);
});

test('compare.Warns of another subject', () => {
  expect(compare([session('a', 1, []), session('b', 2, [], { subject: 'P018' })]).cautions).toMatchObject([{ kind: 'subjects' }]);
});

test('comparable.SessionsOfOtherRigs and without results are left out', () => {
  const chair = { rig: 'chair' };
  const sessions = [session('empty', 4, []), session('newest', 3, [mvelo(1)], chair), session('floor', 2, [mvelo(1)]), session('oldest', 1, [mvelo(1)], chair)];

  expect(comparable(sessions).map(({ sessionId }) => sessionId)).toEqual(['newest', 'oldest']);
});

test('compare.Warns once of reaches of both arms', () => {
  const reaching = (id: string, at: number, side: string, name = 'targets') => session(id, at, [{ name, value: 3, unit: '1' }], { fields: { side } });
  const [left, right] = [reaching('a', 1, 'left'), reaching('b', 2, 'right')];

  expect(compare([left, right, reaching('c', 3, 'left')]).cautions).toMatchObject([{ kind: 'arms' }]);
  expect(compare([left, reaching('b', 2, 'right', 'targets_part_2')]).cautions).toMatchObject([{ kind: 'arms' }]);
  expect(compare([left, reaching('c', 3, 'left')]).cautions).toEqual([]);
  expect(compare([reaching('a', 1, 'left', 'trials'), reaching('b', 2, 'right', 'trials')]).cautions).toEqual([]);
});
