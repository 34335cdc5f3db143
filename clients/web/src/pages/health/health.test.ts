// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { afterEach, expect, test, vi } from 'vitest';

import { SensorInfoSchema } from '../../generated/dts/v1/control_pb';
import { Quality } from '../../generated/dts/v1/stream_pb';
import type { Block } from '../../link/types';
import { qualityWords } from '../../parts/quality';
import { fakeLink, runHook } from '../../testing';
import { barEndsMs, LatencyCounts } from './latency';
import { SecondStatistics } from './second_statistics';
import { sensorRows } from './sensors';
import { useAges, useWatched } from './watch';

const block = (values: readonly number[], quality = 0, more: Partial<Block> = {}): Block =>
  ({ columns: [Float32Array.from(values)], quality: Uint8Array.of(quality), scanCount: values.length, rateHz: 4, isNewSegment: false, ...more }) as Block;

test.each<[string, Block[], object[]]>([
  ['WholeSecond has mean, noise and all quality bits', [block([1, 3], Quality.STUCK), block([1, 3], Quality.RAIL)], [{ mean: 2, noiseRms: 1, quality: Quality.STUCK | Quality.RAIL }]],
  ['PartOfASecond gives no statistics', [block([1, 3])], []],
  ['MillivoltsOnVolts are not drowned', [block([4.9, 4.9002, 4.9, 4.9002])], [{ mean: expect.closeTo(4.9001, 6), noiseRms: expect.closeTo(0.0001, 6), quality: 0 }]],
  ['UndefinedValues are left out', [block([NaN, 2, 4, NaN])], [{ mean: 3, noiseRms: 1, quality: 0 }]],
  ['NewSegment starts again', [block([9, 9]), block([1, 1, 1, 1], 0, { isNewSegment: true })], [{ mean: 1, noiseRms: 0, quality: 0 }]],
  ['EachSecond is reported by itself', [block([9, 9, 9, 9], Quality.RAIL), block([1, 1, 1, 1])], [{ mean: 1, noiseRms: 0, quality: 0 }]],
])('SecondStatistics.%s', (_, blocks, channels) => {
  const statistics = new SecondStatistics();

  blocks.forEach((each) => statistics.push(each));

  expect(statistics.channels).toEqual(channels);
});

test.each<[string, readonly number[], readonly number[], readonly number[]]>([
  ['Nothing has no quantile', [], [NaN, NaN], Array(11).fill(0)],
  ['ManyAges have median and tail', Array.from({ length: 100 }, (_, i) => i + 0.5), [50, 95], [10, 10, 10, 10, 10, 25, 25, 0, 0, 0, 0]],
  ['AgeBeyondTheScale is counted as beyond', [1e6], [Infinity, Infinity], [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]],
  ['LastAgeOnTheScale is not', [1999.5], [2000, 2000], [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]],
  ['EveryBlock is in one bar', [-3, 9.9, 10, 49, 50, 700, NaN], [11, 701], [2, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1]],
])('LatencyCounts.%s', (_, ages, quantiles, bars) => {
  const counts = new LatencyCounts();

  ages.forEach((age) => counts.add(age));

  expect([0.5, 0.95].map((share) => counts.quantileMs(share))).toEqual(quantiles);
  expect(counts.bars().map((share) => Math.round(share * counts.total))).toEqual(bars);
  expect(bars).toHaveLength(barEndsMs.length + 1);
});

test('Sensors.PlateThatCameDown is nearer to the sensor; without data the distance is unknown', () => {
  const sensor = create(SensorInfoSchema, { label: 'w1', unloadedGapMm: 12 });
  const second = (mean: number, quality = 0) => ({ mean, noiseRms: 0, quality });

  const [known, other] = [sensorRows([sensor], [second(4.5)], [second(1.5, Quality.STUCK | Quality.UNTARED)]), sensorRows([sensor], [], [])];

  expect([known[0]?.distanceMm, known[0]?.volts?.mean]).toEqual([10.5, 4.5]);
  expect([other[0]?.distanceMm, other[0]?.volts]).toEqual([NaN, undefined]);
  expect([Quality.UNSPECIFIED, Quality.STUCK | Quality.UNTARED].map((quality) => qualityWords(quality).length)).toEqual([0, 2]);
});

afterEach(() => void vi.useRealTimers());

test('useWatched.Gaps come newest first, 20 at most; sensors once a second', () => {
  const { link, event, block: publish, paint, topics } = fakeLink();
  const { now } = runHook(() => useWatched(link, 'floor'));
  const shown: (number | undefined)[] = [];

  for (let i = 0; i < 21; i += 1) event('floor/gap', { body: { case: 'gap', value: { missingScans: BigInt(i) } } });
  for (const nowMs of [1000, 1999, 2000]) {
    publish('floor/raw', [[nowMs]], { rateHz: 1 });
    publish('floor/deflection', [[-nowMs]], { rateHz: 1 });
    paint(nowMs);
    shown.push(now().seconds.value.raw[0]?.mean, now().seconds.value.deflection[0]?.mean);
  }

  expect(now().gaps.value.map(({ gap }) => Number(gap.missingScans))).toEqual(Array.from({ length: 20 }, (_, i) => 20 - i));
  expect(shown).toEqual([1000, -1000, 1000, -1000, 2000, -2000]);
  expect(topics()).toEqual(['floor/raw floor/deflection floor/gap']);
});

test('useAges.Of every rig are those of the stream that its page draws', () => {
  vi.useFakeTimers({ now: 0, toFake: ['performance'] });
  const streams = { floor: ['raw', 'cop'], chair: ['transient', 'aux'], other: ['raw', 'aux'], mute: [] };
  const { link, block: publish, paint, topics } = fakeLink(Object.entries(streams).map(([name, published]) => ({ rig: { name, published } })));
  const { now } = runHook(() => useAges(link));
  const counted = [1000, 1999, 2000].map((nowMs) => {
    publish('floor/cop', [[0]], { newestMs: -20.5 });
    paint(nowMs);
    return now().value.blocks;
  });

  expect(topics()).toEqual(['floor/cop chair/transient other/raw']);
  expect(counted).toEqual([1, 1, 3]);
  expect(now().value).toMatchObject({ medianMs: 21, p95Ms: 21, bars: [0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0] });
});
