// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import type { TrendPoint } from './asking';
import { linesOf, tableOf } from './trend';

const week = 604_800_000;
const point = (clinic: string, weeks: number, median: number, count = 1): TrendPoint => [clinic, weeks * week, count, median - 1, median, median + 1];

test('linesOf.Weeks without results are gaps in the line', () => {
  const { timesMs, lines, clinics } = linesOf([point('kent', 1, 10), point('kent', 3, 30), point('dover', 2, 5)], 8);

  expect(timesMs).toEqual([week, 2 * week, 3 * week]);
  expect(lines).toEqual([
    { name: 'dover', values: [null, 5, null] },
    { name: 'kent', values: [10, null, 30] },
  ]);
  expect(clinics).toBe(2);
});

test('linesOf.Many clinics: those with the most results, by name', () => {
  const { lines, clinics } = linesOf([point('a', 1, 1, 5), point('b', 1, 1, 1), point('c', 1, 1, 3), point('c', 2, 1, 3)], 2);

  expect(lines.map(({ name }) => name)).toEqual(['a', 'c']);
  expect(clinics).toBe(3);
});

test('tableOf.One clinic has all weeks, several have the newest week of each', () => {
  const kent = [point('kent', 1, 10), point('kent', 3, 30)];

  expect(tableOf(kent).map(({ weekMs }) => weekMs)).toEqual([3 * week, week]);
  expect(tableOf([...kent, point('dover', 2, 5)])).toEqual([
    { clinic: 'dover', weekMs: 2 * week, count: 1, low: 4, median: 5, high: 6 },
    { clinic: 'kent', weekMs: 3 * week, count: 1, low: 29, median: 30, high: 31 },
  ]);
});
