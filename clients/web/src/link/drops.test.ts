// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { Drops, slowForMs } from './drops';

test('Drops.SlowTab is shown until some seconds after the last drop; the totals stay', () => {
  const drops = new Drops();
  drops.count(1, 30, 0, 0);
  drops.count(2, 64, 0, 4000);

  drops.tick(4000 + slowForMs - 1);
  const before = drops.current.value;
  drops.tick(4000 + slowForMs);

  expect(before).toEqual({ blocks: 2, scans: 64, events: 0, scansLately: 64 });
  expect(drops.current.value).toEqual({ blocks: 2, scans: 64, events: 0, scansLately: 0 });
});

test('Drops.SameTotals again are no drop', () => {
  const drops = new Drops();
  drops.count(1, 30, 0, 0);

  drops.count(1, 30, 0, slowForMs - 1);
  drops.tick(slowForMs);

  expect(drops.current.value.scansLately).toBe(0);
});

test('Drops.SlowAgain counts from 0, and so does a new connection', () => {
  const drops = new Drops();
  drops.count(1, 30, 0, 0);
  drops.tick(slowForMs);

  drops.count(2, 37, 0, 20_000);
  const again = drops.current.value.scansLately;
  drops.forget();
  drops.count(1, 5, 0, 21_000);

  expect(again).toBe(7);
  expect(drops.current.value.scansLately).toBe(5);
});
