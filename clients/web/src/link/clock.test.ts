// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { HostClock } from './clock';

const hostNs = (ms: number): bigint => BigInt(Math.round(ms * 1e6));

test('HostClock.ShortestRoundTrip wins over later, longer ones', () => {
  const clock = new HostClock();

  clock.answered(1000, hostNs(500_001), 1002); // offset 499 000, half a trip of 1 ms
  clock.answered(2000, hostNs(501_090), 2100); // took long on the way back: its offset is 40 ms wrong

  expect(clock.toBrowserMs(hostNs(502_000))).toBeCloseTo(3000, 6);
  expect(clock.errorMs).toBeCloseTo(1, 6);
});

test('HostClock.EightLaterAnswers let an old one go, since clocks drift', () => {
  const clock = new HostClock();
  clock.answered(0, hostNs(100), 0);

  for (let probe = 1; probe <= 8; probe += 1) clock.answered(probe * 5000, hostNs(probe * 5000 + 130), probe * 5000 + 20);

  expect(clock.errorMs).toBeCloseTo(10, 6);
  expect(clock.toBrowserMs(hostNs(130))).toBeCloseTo(10, 6);
});

test('HostClock.AnswerFromTheFuture and a host without a time change nothing', () => {
  const clock = new HostClock();

  const taken = [clock.answered(2000, hostNs(1), 1000), clock.answered(1000, 0n, 1001), clock.answered(NaN, hostNs(1), 1001)];

  expect(taken).toEqual([false, false, false]);
  expect(clock.isKnown).toBe(false);
  expect(clock.toBrowserMs(1n)).toBeNaN();
});
