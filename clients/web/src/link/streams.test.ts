// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { beforeEach, expect, test } from 'vitest';

import { StatusSnapshotSchema } from '../generated/dts/v1/control_pb';
import type { StreamBlock } from '../generated/dts/v1/stream_pb';
import { StreamBlockSchema } from '../generated/dts/v1/stream_pb';
import { HostClock } from './clock';
import { isWellFormed, splitTopic, Streams } from './streams';

type Change = { [Name in Exclude<keyof StreamBlock, '$typeName' | '$unknown' | 'rate'>]?: StreamBlock[Name] } & { rate?: { numerator: bigint; denominator: bigint } };

const block = (change: Change = {}) =>
  create(StreamBlockSchema, {
    instanceId: 7n,
    segment: 1,
    firstScan: 100n,
    scanCount: 2,
    channelCount: 2,
    rate: { numerator: 100n, denominator: 1n },
    hostTimeNs: 5_000_000_000n,
    values: [1, 2, 3, NaN],
    quality: new Uint8Array([0, 16]),
    ...change,
  });

let streams: Streams;

beforeEach(() => {
  const clock = new HostClock();
  clock.answered(0, 4_000_000_000n, 0); // the host is 4 s ahead
  streams = new Streams(clock);
  const channels = [
    { name: 'ml_mm', unit: 'mm' },
    { name: 'ap_mm', unit: 'mm' },
  ];
  streams.learn(create(StatusSnapshotSchema, { rigs: [{ rig: { name: 'floor', streams: [{ name: 'cop', channels }] } }] }));
});

test('Streams.WellFormedBlock becomes columns with times of this browser', () => {
  const taken = streams.check('floor/cop', block())!;

  expect(taken.columns.map((column) => [...column])).toEqual([[1, 2], [3, NaN]]);
  expect([taken.timeMs, taken.newestMs, taken.rateHz]).toEqual([1000, 1010, 100]);
  expect([taken.missingScans, taken.isNewSegment]).toEqual([0, false]);
});

test.each<[string, Change, boolean, readonly [number, boolean] | undefined]>([
  ['HoleInASegment is counted exactly', { firstScan: 152n }, false, [50, false]],
  ['NewSegment is reported with what is missing of its beginning', { segment: 2, firstScan: 3n }, false, [3, true]],
  ['RestartedDaemon is a new segment even with the same number', { instanceId: 8n, firstScan: 0n }, false, [0, true]],
  ['Repetition is dropped', {}, false, undefined],
  ['AfterForgetting nothing is missing', { firstScan: 9000n }, true, [0, false]],
  ['RestartedDaemon while it was not subscribed is a new segment', { instanceId: 8n, firstScan: 9000n }, true, [0, true]],
  ['NewSegment while it was not subscribed is one', { segment: 2, firstScan: 9000n }, true, [0, true]],
])('Streams.%s', (_name, change, isForgotten, expected) => {
  streams.check('floor/cop', block());
  if (isForgotten) streams.forget();

  const taken = streams.check('floor/cop', block(change));

  expect(taken && [taken.missingScans, taken.isNewSegment]).toEqual(expected);
});

test('Streams.UnknownStream or other number of channels is rejected', () => {
  const unknown = streams.check('floor/raw', block());
  const other = streams.check('floor/cop', block({ channelCount: 1, values: [1, 2], quality: new Uint8Array(1) }));

  expect([unknown, other]).toEqual([undefined, undefined]);
});

test.each<[string, Change]>([
  ['fewer values than counted', { values: [1, 2, 3] }],
  ['no scans', { scanCount: 0, values: [] }],
  ['too many scans', { scanCount: 65537 }],
  ['too many channels', { channelCount: 257 }],
  ['a quality byte short', { quality: new Uint8Array(1) }],
  ['no rate', { rate: { numerator: 0n, denominator: 1n } }],
  ['a negative rate', { rate: { numerator: 100n, denominator: -1n } }],
  ['no instance', { instanceId: 0n }],
])('Block.With %s is not well formed', (_name, change) => {
  expect(isWellFormed(block())).toBe(true);
  expect(isWellFormed(block(change))).toBe(false);
});

test.each(['', 'floor', '/cop', 'floor/', 'a/b/c'])('Topic.%j is none', (topic) => {
  expect(splitTopic(topic)).toBeUndefined();
});
