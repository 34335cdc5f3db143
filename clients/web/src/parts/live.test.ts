// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, test, vi } from 'vitest';

import type { Instant } from '../link/types';
import { instantNow } from '../link/types';
import { oldAfterMs, watchOld } from './live';

beforeEach(() => vi.useFakeTimers());
afterEach(() => vi.useRealTimers());

/** A link that ticks like the real one and never paints. */
const ticking = (lastBlockAt: () => Instant | undefined) => ({
  lastBlockAt,
  onTick: (handler: (nowMs: number) => void): (() => void) => {
    const timer = setInterval(() => handler(performance.now()), 250);
    return () => clearInterval(timer);
  },
});

test.each([0, 100, 240])('watchOld.Silence that begins %i ms after a tick is reported within two seconds, without a frame', (afterTickMs) => {
  let last: Instant | undefined;
  let isOld = false;
  const reported: number[] = [];
  const stop = watchOld(ticking(() => last), 'floor', (is) => {
    if (is && !isOld) reported.push(performance.now() - last!.atMs);
    isOld = is;
  });
  vi.advanceTimersByTime(250 + afterTickMs);
  last = instantNow();

  vi.advanceTimersByTime(5000);
  last = instantNow();
  vi.advanceTimersByTime(250);
  stop();

  expect(reported).toHaveLength(1);
  expect(reported[0]).toBeGreaterThan(oldAfterMs);
  expect(reported[0]).toBeLessThanOrEqual(1750);
  expect(isOld).toBe(false);
});

test('watchOld.PageThatJustOpened waits for its first data before it reports old data', () => {
  const reported: boolean[] = [];
  const stop = watchOld(ticking(() => undefined), 'floor', (is) => reported.push(is));

  vi.advanceTimersByTime(2000);
  stop();

  expect(reported).toEqual([false, false, false, false, false, false, true, true]);
});

test.each([-3600, 3600])('watchOld.ClockOfTheComputer that is set by %i s changes no age', (stepS) => {
  vi.setSystemTime(10_000_000);
  const reported: boolean[] = [];
  const last = instantNow();
  const stop = watchOld(ticking(() => last), 'floor', (is) => reported.push(is));

  vi.setSystemTime(Date.now() + 1000 * stepS);
  vi.advanceTimersByTime(2000);
  stop();

  expect(reported).toEqual([false, false, false, false, false, false, true, true]);
});
