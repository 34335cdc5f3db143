// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { comparable, compare, difference, mostCompared, shareOfChange } from './comparison';

interface Result {
  name: string;
  value: number;
  unit?: string;
  details?: string;
}

const session = (id: string, started: number, results: readonly Result[], more: MessageInitShape<typeof SessionRecordSchema> = {}): SessionRecord =>
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

test.each<[string, MessageInitShape<typeof SessionRecordSchema>, object]>([
  ['another subject', { subject: 'P018' }, { kind: 'subjects' }],
  ['another rig', { rig: 'plate' }, { kind: 'rigs' }],
  ['another protocol', { protocol: 'romberg' }, { kind: 'protocols', protocols: ['', 'romberg'] }],
  ['lost scans', { parts: [{ losses: [{ gapsTotal: 2n, lostScansTotal: 120n }] }] }, { kind: 'lost', losses: '120 scans lost in 2 gaps' }],
])('compare.Warns of %s', (_, more, caution) => {
  expect(compare([session('a', 1, []), session('b', 2, [], more)]).cautions).toMatchObject([caution]);
});

test('compare.Result of one part of a resumed session is that of the session; results of several parts have rows of their own', () => {
  const named = (names: readonly string[]): Result[] => names.map((name, index) => ({ name, value: index + 1 }));
  const whole = session('whole', 1, named(['eyes-open/MVELO', 'deg']));
  const resumed = session('resumed', 2, named(['eyes-open/MVELO_part_2', 'deg', 'deg_part_2']));
  const { results, cautions } = compare([whole, resumed]);

  expect(results.map(({ name, values }) => [name, ...values])).toEqual([
    ['eyes-open/MVELO', 1, 1],
    ['deg', 2, 2],
    ['deg_part_2', undefined, 3],
  ]);
  expect(cautions).toMatchObject([{ kind: 'resumed' }]);
});

const idsOfComparable = async (sessions: readonly SessionRecord[], signal = new AbortController().signal): Promise<readonly string[]> => {
  const found = await comparable(sessions, (id) => Promise.resolve(sessions.find(({ sessionId }) => sessionId === id)!), signal);
  return found.map(({ sessionId }) => sessionId);
};

test('comparable.SessionsOfOtherRigs and without results are left out', async () => {
  const chair = { rig: 'chair' };
  const sessions = [session('empty', 4, []), session('newest', 3, [mvelo(1)], chair), session('floor', 2, [mvelo(1)]), session('oldest', 1, [mvelo(1)], chair)];

  expect(await idsOfComparable(sessions)).toEqual(['newest', 'oldest']);
  expect(await idsOfComparable(sessions, AbortSignal.abort())).toEqual([]);
});

test('comparable.Sessions that are left out take no place', async () => {
  const numbers = [...Array(2 * mostCompared + 1).keys()];
  const sessions = numbers.map((number) => session(`s${number}`, -number, number % 2 === 0 ? [mvelo(1)] : []));

  expect(await idsOfComparable(sessions)).toEqual(numbers.filter((number) => number % 2 === 0).slice(0, mostCompared).map((number) => `s${number}`));
});

test('compare.Warns once of reaches of both arms', () => {
  const reaching = (id: string, at: number, side: string, name = 'targets') => session(id, at, [{ name, value: 3, unit: '1' }], { fields: { side } });
  const [left, right] = [reaching('a', 1, 'left'), reaching('b', 2, 'right')];

  expect(compare([left, right, reaching('c', 3, 'left')]).cautions).toMatchObject([{ kind: 'arms' }]);
  expect(compare([left, reaching('b', 2, 'right', 'targets_part_2')]).cautions).toMatchObject([{ kind: 'arms' }]);
  expect(compare([left, reaching('c', 3, 'left')]).cautions).toEqual([]);
  expect(compare([reaching('a', 1, 'left', 'trials'), reaching('b', 2, 'right', 'trials')]).cautions).toEqual([]);
});
