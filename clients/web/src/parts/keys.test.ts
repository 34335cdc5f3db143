// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { isTakenByFocus } from './keys';

test.each([
  ['a', 'INPUT', true],
  [' ', 'INPUT', true],
  ['Escape', 'INPUT', false],
  [' ', 'BUTTON', true],
  ['a', 'BUTTON', false],
  [' ', 'BODY', false],
  ['r', 'SELECT', true],
])('keys.%j on %s: the element takes it, %s', (key, tag, isTaken) => {
  expect(isTakenByFocus(key, tag)).toBe(isTaken);
});
