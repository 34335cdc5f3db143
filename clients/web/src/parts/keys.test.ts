// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { isTakenByFocus } from './keys';

test.each([
  ['a', 'INPUT', 0, true],
  [' ', 'INPUT', 0, true],
  ['Escape', 'INPUT', 0, false],
  [' ', 'BUTTON', 0, true],
  [' ', 'BUTTON', -1, true],
  ['a', 'BUTTON', 0, false],
  [' ', 'BODY', -1, false],
  [' ', 'MAIN', -1, false],
  [' ', 'DIV', 0, true],
  ['a', 'DIV', 0, false],
  ['r', 'SELECT', 0, true],
])('keys.%j on %s with tabIndex %i: the element takes it, %s', (key, tag, tabIndex, isTaken) => {
  expect(isTakenByFocus(key, tag, tabIndex)).toBe(isTaken);
});
