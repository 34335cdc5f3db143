// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import type { Block } from '../../link/types';
import { Ghosts, ghostTimeS } from './ghosts';
import { newEnvelope, TransientRing } from './transient_ring';

const block = (firstScan: number, values: readonly number[], more: Partial<Block> = {}): Block =>
  ({
    firstScan,
    scanCount: values.length,
    columns: [Float32Array.from(values)],
    segment: 0,
    rateHz: 100,
    isNewSegment: false,
    missingScans: 0,
    ...more,
  }) as Block;

const ramp = (from: number, count: number): number[] => Array.from({ length: count }, (_, index) => from + index);

const ringOf = (capacity: number, ...blocks: readonly Block[]): TransientRing => {
  const ring = new TransientRing(capacity);
  blocks.forEach((each) => ring.push(each));
  return ring;
};

test.each<[string, readonly Block[], number, number, readonly number[], readonly number[]]>([
  ['EveryPeak is kept', [block(0, [1, 9, 1, 1, -5, 1, 1, 1])], 0, 8, [1, -5], [9, 1]],
  ['BeforeTheFirst and after the last scan is nothing', [block(10, [3, 3])], 8, 16, [NaN, 3, NaN, NaN], [NaN, 3, NaN, NaN]],
  ['FinerThanTheScans has no holes', [block(0, [1, 2])], 0, 2, [1, 1, 2, 2], [1, 1, 2, 2]],
])('TransientRing.Decimated: %s', (_, blocks, from, to, low, high) => {
  const envelope = newEnvelope(low.length);

  ringOf(64, ...blocks).decimate(from, to, low.length, envelope);

  expect([[...envelope.low], [...envelope.high]]).toEqual([low, high]);
});

test.each<[string, number, readonly Block[], readonly number[], number, number]>([
  ['Nothing holds nothing', 64, [], [NaN], NaN, 0],
  ['MissingScans stay a hole', 64, [block(0, [1, 1]), block(4, [2])], [1, 1, NaN, NaN, 2, NaN], 2, 5],
  ['HoleOverOldScans is one', 4, [block(0, ramp(0, 4)), block(6, [6])], [NaN, NaN, NaN, 3, NaN, NaN, 6], 6, 7],
  ['HoleAsLongAsItself is kept', 4, [block(0, [0]), block(5, [5])], [NaN, NaN, NaN, NaN, NaN, 5], 5, 6],
  ['Full forgets the oldest', 4, [block(0, ramp(0, 3)), block(3, ramp(3, 3))], [NaN, NaN, 2, 3, 4, 5], 5, 6],
  ['NewSegment starts again', 64, [block(0, ramp(0, 8)), block(9, [7], { segment: 1 })], [NaN, NaN], 7, 10],
  ['RestartedDaemon starts again', 64, [block(0, ramp(0, 8)), block(9, [7], { isNewSegment: true })], [NaN, NaN], 7, 10],
  ['ScansThatGoBack start again', 64, [block(0, ramp(0, 8)), block(0, [7])], [7, NaN], 7, 1],
  ['BlockWithoutColumns is skipped', 64, [block(0, [1]), block(1, [2], { columns: [] })], [1, NaN], 1, 1],
])('TransientRing.%s', (_, capacity, blocks, values, newest, endScan) => {
  const ring = ringOf(capacity, ...blocks);

  expect(values.map((_value, scan) => ring.at(scan))).toEqual(values);
  expect([ring.newest, ring.endScan]).toEqual([newest, endScan]);
});

test('TransientRing.Means across a hole are nothing', () => {
  expect([...ringOf(64, block(0, [1, 3, 5]), block(4, [5, 5, 7])).means(0, 2, 3)]).toEqual([2, NaN, 5]);
});

const ring = ringOf(1024, block(0, ramp(0, 400)));
const goAt = { segment: 0, scan: 200 };

test('Ghosts.OfATarget are the last five, from one second before "Go"; another session has none', () => {
  const ghosts = new Ghosts();
  ghosts.begin('s1');

  for (let trial = 1; trial <= 7; trial += 1) ghosts.keep(trial, '120', goAt, ring);
  ghosts.begin('s1');

  expect(ghosts.of('120').map(({ trial }) => trial)).toEqual([3, 4, 5, 6, 7]);
  expect(ghosts.of('150')).toEqual([]);
  expect([...ghosts.of('120')[0]!.values.slice(0, 2)]).toEqual([100, 101]);
  expect([ghosts.of('120')[0]!.values.length, ghostTimeS(0), ghostTimeS(100)]).toEqual([300, -0.995, expect.closeTo(0.005, 9)]);
  const { version } = ghosts;
  ghosts.drop(4);
  expect([ghosts.of('120').map(({ trial }) => trial), ghosts.version]).toEqual([[3, 5, 6, 7], version + 1]);
  ghosts.begin('s2');
  expect([ghosts.of('120'), ghosts.version]).toEqual([[], version + 2]);
});

test.each<[string, { segment: number; scan: number }, TransientRing]>([
  ['AcrossAGap', { segment: 1, scan: 200 }, ring],
  ['BeforeItsRest', { segment: 0, scan: 500 }, ring],
  ['SlowerThanItsLine', goAt, ringOf(64, block(0, ramp(0, 60), { rateHz: 20 }))],
])('Ghosts.%s are not kept', (_, at, of) => {
  const ghosts = new Ghosts();

  ghosts.keep(1, '120', at, of);

  expect([ghosts.of('120'), ghosts.version]).toEqual([[], 0]);
});
