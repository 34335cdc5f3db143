// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { watchedClinic } from './live_page';

test.each<[string[], string | undefined]>([
  [['clinics', 'kent', 'floor', 'floor'], 'kent'],
  [['clinics', 'kent', 'chair'], 'kent'],
  [['clinics', 'kent'], undefined],
  [['clinics', 'kent', 'health'], undefined],
  [['clinics'], undefined],
  [['floor', 'kent', 'floor'], undefined],
  [[], undefined],
])('watchedClinic.%j', (path, expected) => {
  expect(watchedClinic(path)).toBe(expected);
});
