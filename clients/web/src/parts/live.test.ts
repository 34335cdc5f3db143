// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, test, vi } from 'vitest';

import { oldAfterMs, watchOld } from './live';

beforeEach(() => vi.useFakeTimers());
afterEach(() => vi.useRealTimers());

/** A link that ticks like the real one and never paints. */
const ticking = (lastBlockAt: () => number) => ({
  lastBlockAt,
  onTick: (handler: (nowMs: number) => void): (() => void) => {
    const timer = setInterval(() => handler(performance.now()), 250);
    return () => clearInterval(timer);
  },
});

test.each([0, 100, 240])('watchOld.Silence that begins %i ms after a tick is reported within two seconds, without a frame', (afterTickMs) => {
  vi.setSystemTime(1_000_000);
  let lastMs = 0;
  let isOld = false;
  const reported: number[] = [];
  const stop = watchOld(ticking(() => lastMs), 'floor', (is) => {
    if (is && !isOld) reported.push(Date.now() - lastMs);
    isOld = is;
  });
  vi.advanceTimersByTime(250 + afterTickMs);
  lastMs = Date.now();

  vi.advanceTimersByTime(5000);
  lastMs = Date.now();
  vi.advanceTimersByTime(250);
  stop();

  expect(reported).toHaveLength(1);
  expect(reported[0]).toBeGreaterThan(oldAfterMs);
  expect(reported[0]).toBeLessThanOrEqual(1750);
  expect(isOld).toBe(false);
});

test('watchOld.PageThatJustOpened waits for its first data before it reports old data', () => {
  vi.setSystemTime(1_000_000);
  const reported: boolean[] = [];
  const stop = watchOld(ticking(() => 0), 'floor', (is) => reported.push(is));

  vi.advanceTimersByTime(2000);
  stop();

  expect(reported).toEqual([false, false, false, false, false, false, true, true]);
});
