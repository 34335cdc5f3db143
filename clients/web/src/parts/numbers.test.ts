// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { bytes, dayUtc, duration, fixed, measured, percent, signed, whole } from './numbers';

const none = '–';

test.each<[string, readonly string[], readonly string[]]>([
  ['UndefinedValue is a dash, never 0', [fixed(undefined, 1), fixed(NaN, 1), signed(Infinity, 0), measured(NaN), percent(undefined), bytes(undefined), duration(NaN), whole(undefined)], Array(8).fill(none)],
  ['RoundedToNothing has no sign', [fixed(-0.04, 1), signed(-0.04, 1), signed(0.04, 1)], ['0.0', '0.0', '0.0']],
  ['Signed shows the sign of both directions', [signed(1.25, 1), signed(-3, 0)], ['+1.3', '-3']],
  ['Measured keeps three digits of any size', [0.012345, 1.2345, 123.45, 1234.5, 0].map((value) => measured(value)), ['0.0123', '1.23', '123', '1,235', '0.00']],
  ['Bytes change the unit where the digits do', [0, 999n, 1000, 123_456_789, -1].map((value) => bytes(value)), ['0 B', '999 B', '1.0 kB', '123 MB', none]],
  ['Duration is seconds, minutes or hours', [8, 125, 12_000, -1].map((value) => duration(value)), ['8.0 s', '2:05 min', '3:20 h', none]],
])('numbers.%s', (_, shown, expected) => {
  expect(shown).toEqual(expected);
});

test('dayUtc.TheFirstInstantOfADay is that day in every time zone', () => {
  expect(dayUtc(Date.UTC(2026, 10, 23))).toBe('23 Nov 2026');
  expect(dayUtc(Date.UTC(2026, 10, 23, 23, 59))).toBe('23 Nov 2026');
});
