// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { bytes, duration, fixed, measured, percent, signed, whole } from './numbers';

test('numbers.UndefinedValue is a dash, never 0', () => {
  expect([fixed(undefined, 1), fixed(NaN, 1), signed(Infinity, 0), measured(NaN), percent(undefined), bytes(undefined), duration(NaN), whole(undefined)]).toEqual(
    Array(8).fill('–'),
  );
});

test('numbers.RoundedToNothing has no sign', () => {
  expect([fixed(-0.04, 1), signed(-0.04, 1), signed(0.04, 1)]).toEqual(['0.0', '0.0', '0.0']);
});

test('numbers.Signed tells both directions', () => {
  expect([signed(1.25, 1), signed(-3, 0)]).toEqual(['+1.3', '-3']);
});

test('numbers.Measured keeps three digits of any size', () => {
  expect([measured(0.012345), measured(1.2345), measured(123.45), measured(1234.5), measured(0)]).toEqual(['0.0123', '1.23', '123', '1,235', '0.00']);
});

test('numbers.Bytes change the unit where the digits do', () => {
  expect([bytes(0), bytes(999n), bytes(1000), bytes(123_456_789), bytes(-1)]).toEqual(['0 B', '999 B', '1.0 kB', '123 MB', '–']);
});

test('numbers.Duration is seconds, minutes or hours', () => {
  expect([duration(8), duration(125), duration(12_000), duration(-1)]).toEqual(['8.0 s', '2:05 min', '3:20 h', '–']);
});
