// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { ClassReason, TrunkMovementSchema } from '../../generated/dts/v1/stream_pb';
import type { Block } from '../../link/types';
import { ScanRing } from '../../parts/scan_ring';
import { strings } from '../../strings';
import { helpedWords } from './reach_picture';
import { dotPlace, meanPlace } from './target_picture';

const ringOf = (ml: readonly number[], ap: readonly number[]): ScanRing => {
  const ring = new ScanRing(2, 1000);
  ring.push({ segment: 0, firstScan: 0, rateHz: 100, scanCount: ml.length, timeMs: 0, newestMs: (ml.length - 1) * 10, isNewSegment: false,
    columns: [Float32Array.from(ml), Float32Array.from(ap)] } as unknown as Block, [0, 1]);
  return ring;
};
const same = (value: number, count: number): number[] => new Array<number>(count).fill(value);

test('meanPlace.Is of the last 3 s', () => {
  expect(meanPlace(ringOf([...same(100, 400), ...same(4, 301)], [...same(0, 400), ...same(-20, 301)]))).toEqual({ mlMm: 4, apMm: -20 });
});

test('meanPlace.Begins where the person stepped on, and needs 1 s', () => {
  const steppedOn = (scans: number) => meanPlace(ringOf([...same(50, 100), NaN, ...same(2, scans)], [...same(0, 100), NaN, ...same(1, scans)]));

  expect(steppedOn(100)).toBeUndefined();
  expect(steppedOn(101)).toEqual({ mlMm: 2, apMm: 1 });
  expect(meanPlace(new ScanRing(2, 10))).toBeUndefined();
});

test('dotPlace.Has one scale in both directions, and stays on the edge beyond it', () => {
  const middle = { mlMm: 5, apMm: -10 };

  expect(dotPlace({ mlMm: 20, apMm: -25 }, middle)).toEqual({ x: 0.5, y: -0.5, isBeyond: false });
  const beyond = dotPlace({ mlMm: 5, apMm: 90 }, middle);
  expect(beyond).toMatchObject({ x: 0, isBeyond: true });
  expect(beyond.y).toBeLessThan(1);
});

test.each<[string, number, number, string]>([
  ['None', 0, 0, strings.patient.helped.none],
  ['Minor', 1, 0, strings.patient.helped.minor],
  ['MinorOrNone', 1, ClassReason.MINOR, strings.patient.helped.noneOrMinor],
  ['Moderate', 2, ClassReason.CALIBRATED, strings.patient.helped.moderate],
  ['Maximum', 3, 0, strings.patient.helped.maximum],
  ['Uncertain is a result', -1, ClassReason.BAD_REACH, strings.patient.helped.uncertain],
])('helpedWords.%s', (_, trunkClass, reasons, expected) => {
  expect(helpedWords(create(TrunkMovementSchema, { trunkClass, reasons }))).toBe(expected);
});
