// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { ClassReason, TrunkMovementSchema } from '../../generated/dts/v1/stream_pb';
import { strings } from '../../strings';
import { helpedWords } from './reach_picture';
import { dotPlace } from './target_picture';

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
