// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { queryOf } from './asking';
import { parametersOf, trendSince } from './filters';
import { rangeOf } from './line_plot';

const none = { clinic: '', rig: '', protocol: '', subject: '', since: '' };

test('filters.Empty ones are not sent', () => {
  expect(queryOf(parametersOf(none))).toBe('');
});

test('filters.Subject without spaces, day as midnight of the reader', () => {
  const query = queryOf(parametersOf({ ...none, clinic: 'kent', subject: ' P 1&x ', since: '2026-01-31' }));

  expect(query).toBe(`?clinic=kent&subject=P+1%26x&since=${new Date(2026, 0, 31).getTime()}`);
});

test('trendSince.The same request all day', () => {
  const morning = Date.UTC(2026, 10, 26, 8);

  expect(trendSince('year', morning)).toBe(trendSince('year', morning + 3_600_000));
  expect(Number(trendSince('year', morning))).toBeLessThanOrEqual(morning - 365 * 86_400_000);
  expect(trendSince('all', morning)).toBe('');
});

test.each<[string, (number | null)[], [number, number]]>([
  ['near zero begins at zero', [1, 3, null], [0, 3.1]],
  ['far from zero', [100, 110], [99.5, 110.5]],
  ['one value', [10], [9.5, 10.5]],
  ['zeros', [0, 0], [-1, 1]],
  ['no value', [null], [0, 1]],
])('rangeOf.%s', (_, values, expected) => {
  expect(rangeOf(values)).toEqual(expected);
});
