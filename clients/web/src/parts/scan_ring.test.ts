// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import type { Block } from '../link/types';
import type { Line } from './scan_ring';
import { decimate, ScanRing } from './scan_ring';

/** A block at 100 Hz; the value is the number of the scan unless given. */
const block = (firstScan: number, scanCount: number, change: Partial<Block> = {}, values?: readonly number[]): Block =>
  ({
    firstScan,
    scanCount,
    segment: 0,
    rateHz: 100,
    timeMs: firstScan * 10,
    newestMs: (firstScan + scanCount - 1) * 10,
    columns: [Float32Array.from(values ?? Array.from({ length: scanCount }, (_, scan) => firstScan + scan))],
    missingScans: 0,
    isNewSegment: false,
    ...change,
  }) as Block;

const valuesOf = (ring: ScanRing): number[] => Array.from({ length: ring.length }, (_, index) => ring.value(0, index));

test('ScanRing.MoreThanItHolds keeps the newest, in order', () => {
  const ring = new ScanRing(1, 5);

  ring.push(block(0, 4), [0]);
  ring.push(block(4, 4), [0]);

  expect(valuesOf(ring)).toEqual([3, 4, 5, 6, 7]);
  expect([ring.timeMs(0), ring.newestMs, ring.firstNumber]).toEqual([30, 70, 3]);
});

test.each([
  ['missing scans', block(9, 1, { missingScans: 7 })],
  ['a new segment', block(2, 1, { segment: 1, isNewSegment: true })],
  ['a pause of the subscription', block(100, 1)],
])('ScanRing.After %s there is a gap', (_name, next) => {
  const ring = new ScanRing(1, 10);
  ring.push(block(0, 2), [0]);

  ring.push(next, [0]);

  expect(valuesOf(ring).slice(0, 3)).toEqual([0, 1, NaN]);
  expect(ring.length).toBe(4);
});

test.each([-40, 600])('ScanRing.ClockMeasuredAgain by %s ms shifts the stored scans, without a gap', (byMs) => {
  const ring = new ScanRing(1, 10);
  ring.push(block(0, 3), [0]);

  ring.push(block(3, 1, { timeMs: 30 + byMs, newestMs: 30 + byMs }), [0]);

  expect(valuesOf(ring)).toEqual([0, 1, 2, 3]);
  expect([0, 1, 2, 3].map((index) => ring.timeMs(index))).toEqual([0, 10, 20, 30].map((time) => time + byMs));
});

test('ScanRing.TimesThatGoBack after a gap start again', () => {
  const ring = new ScanRing(1, 10);
  ring.push(block(50, 3), [0]);

  ring.push(block(0, 2, { segment: 1, isNewSegment: true }), [0]);

  expect(valuesOf(ring)).toEqual([0, 1]);
});

test('ScanRing.IndexAt finds the first scan that is not before a time', () => {
  const ring = new ScanRing(1, 10);
  ring.push(block(0, 8), [0]);

  expect([-5, 0, 31, 40, 70, 71].map((time) => ring.indexAt(time))).toEqual([0, 0, 4, 4, 7, 8]);
});

test('decimate.FewScans are all drawn, gaps as null', () => {
  const ring = new ScanRing(1, 10);
  ring.push(block(0, 2), [0]);
  ring.push(block(3, 1, { missingScans: 1 }), [0]);
  const line: Line = { x: [99], y: [99] };

  decimate(ring, 0, 0, 20, 100, line);

  expect(line.y).toEqual([0, 1, null, 3]);
  expect(line.x[0]).toBeCloseTo(-0.02, 9);
});

test('decimate.ManyScans keep every peak, in its order, at two points a pixel', () => {
  const values = Array.from({ length: 1000 }, (_, scan) => (scan === 403 ? 9 : scan === 407 ? -9 : 0));
  const ring = new ScanRing(1, 1000);
  ring.push(block(0, 1000, {}, values), [0]);
  const line: Line = { x: [], y: [] };

  decimate(ring, 0, 0, 10_000, 100, line);

  expect(line.y.filter((value) => value !== 0)).toEqual([9, -9]);
  expect(line.y.length).toBeLessThanOrEqual(200);
  expect(line.x).toEqual([...line.x].sort((a, b) => a - b));
});

test('decimate.GroupsStay where they are while the window moves', () => {
  const ring = new ScanRing(1, 2000);
  ring.push(block(0, 2000, {}, Array.from({ length: 2000 }, (_, scan) => Math.sin(scan))), [0]);
  const [before, after]: Line[] = [
    { x: [], y: [] },
    { x: [], y: [] },
  ];

  decimate(ring, 0, 0, 0, 100, before!);
  decimate(ring, 0, 70, 0, 100, after!);

  expect(after!.y.slice(-100)).toEqual(before!.y.slice(-100));
});
