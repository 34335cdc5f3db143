// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { fakeLink } from '../testing';
import { hasResults } from './results';

// requirement: REP-11
test.each<[string[], boolean]>([
  [[], true],
  [['floor', 'floor'], true],
  [['chair'], true],
  [['sessions', 's1'], true],
  [['compare', 's1', 's2'], true],
  [['subjects', 'P017'], true],
  [['trends'], true],
  [['health'], false],
])('hasResults.%j %s', (path, expected) => {
  const { link } = fakeLink();
  expect(hasResults(link, path)).toBe(expected);
  (link.state as { value: string }).value = 'login';
  expect(hasResults(link, path)).toBe(false);
});
