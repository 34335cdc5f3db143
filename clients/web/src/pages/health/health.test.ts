// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';

import { SensorInfoSchema } from '../../generated/dts/v1/control_pb';
import { Quality } from '../../generated/dts/v1/stream_pb';
import type { Block } from '../../link/types';
import { barEndsMs, LatencyCounts } from './latency';
import { SecondStatistics } from './second_statistics';
import { gapMm, qualityWords, sensorRows } from './sensors';

const block = (values: readonly number[], quality = 0, more: Partial<Block> = {}): Block =>
  ({ columns: [Float32Array.from(values)], quality: Uint8Array.of(quality), scanCount: values.length, rateHz: 4, isNewSegment: false, ...more }) as Block;

describe('SecondStatistics', () => {
  it('WholeSecond.HasMeanNoiseAndAllQualityBits', () => {
    const statistics = new SecondStatistics();

    statistics.push(block([1, 3], Quality.STUCK));
    statistics.push(block([1, 3], Quality.RAIL));

    expect(statistics.channels).toEqual([{ mean: 2, noiseRms: 1, quality: Quality.STUCK | Quality.RAIL }]);
  });

  it('PartOfASecond.TellsNothing', () => {
    const statistics = new SecondStatistics();

    statistics.push(block([1, 3]));

    expect(statistics.channels).toEqual([]);
  });

  it('MillivoltsOnVolts.AreNotDrowned', () => {
    const statistics = new SecondStatistics();

    statistics.push(block([4.9, 4.9002, 4.9, 4.9002]));

    expect(statistics.channels[0]?.noiseRms).toBeCloseTo(0.0001, 6);
  });

  it('UndefinedValues.AreLeftOut', () => {
    const statistics = new SecondStatistics();

    statistics.push(block([Number.NaN, 2, 4, Number.NaN]));

    expect(statistics.channels[0]).toMatchObject({ mean: 3, noiseRms: 1 });
  });

  it('NewSegment.BeginsAnew', () => {
    const statistics = new SecondStatistics();
    statistics.push(block([9, 9]));

    statistics.push(block([1, 1, 1, 1], 0, { isNewSegment: true }));

    expect(statistics.channels[0]?.mean).toBe(1);
  });
});

describe('LatencyCounts', () => {
  it('NothingCounted.HasNoQuantile', () => {
    expect(new LatencyCounts().quantileMs(0.5)).toBeNaN();
  });

  it('ManyAges.HaveMedianAndTail', () => {
    const counts = new LatencyCounts();
    for (let age = 1; age <= 100; age += 1) counts.add(age - 0.5);

    expect(counts.quantileMs(0.5)).toBe(50);
    expect(counts.quantileMs(0.95)).toBe(95);
  });

  it('AgesBeyondTheScale.AreCountedAsBeyond', () => {
    const counts = new LatencyCounts();
    counts.add(1e6);

    expect(counts.quantileMs(0.5)).toBe(Number.POSITIVE_INFINITY);
    expect(counts.bars().at(-1)).toBe(1);
  });

  it('Bars.HoldEveryBlockOnce', () => {
    const counts = new LatencyCounts();
    for (const age of [-3, 9.9, 10, 49, 50, 700, Number.NaN]) counts.add(age);

    expect(counts.bars().map((share) => Math.round(share * counts.total))).toEqual([2, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1]);
    expect(counts.bars()).toHaveLength(barEndsMs.length + 1);
  });
});

describe('Sensors', () => {
  const sensor = create(SensorInfoSchema, { label: 'w1', unloadedGapMm: 12 });

  it('PlateThatCameDown.IsNearerToTheSensor', () => {
    expect(gapMm(sensor, 1.5)).toBe(10.5);
  });

  it('StreamNotYetHeard.LeavesTheGapUnknown', () => {
    const [row] = sensorRows([sensor], [], []);

    expect(row?.gapMm).toBeNaN();
    expect(row?.volts).toBeUndefined();
  });

  it('QualityBits.AreWords', () => {
    expect(qualityWords(Quality.UNSPECIFIED)).toEqual([]);
    expect(qualityWords(Quality.STUCK | Quality.UNTARED)).toHaveLength(2);
  });
});
