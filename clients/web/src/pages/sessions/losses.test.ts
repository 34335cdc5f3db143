// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { GapReason, LossCountSchema } from '../../generated/dts/v1/stream_pb';
import { lossLine, lossOfSession } from './losses';

const loss = (gaps: number, scans: number, reason = GapReason.OVERRUN) => create(LossCountSchema, { reason, gapsTotal: BigInt(gaps), lostScansTotal: BigInt(scans) });

test.each([
  ['AllParts and reasons add up', [{ losses: [loss(1, 560, GapReason.RING_FULL)] }, { losses: [loss(2, 39), loss(0, 1)] }], '600 scans lost in 3 gaps'],
  ['GapWithoutLostScans is shown', [{ losses: [loss(1, 0)] }], '0 scans lost in 1 gap'],
  ['NothingLost says nothing', [{ losses: [] }, { losses: [] }], ''],
  ['UnknownLosses are shown as unknown', [{ isLossUnknown: true }], 'losses unknown'],
  ['PartWhoseLossesAreUnknown is not called whole', [{ losses: [loss(1, 7)] }, { isLossUnknown: true }], 'at least 7 scans lost in 1 gap'],
])('lossOfSession.%s', (_, parts, expected) => {
  expect(lossOfSession(create(SessionRecordSchema, { parts }))).toBe(expected);
});

test('lossLine.EveryReason has its words, one of a later daemon is unknown', () => {
  const reasons = Object.values(GapReason).filter((reason): reason is GapReason => typeof reason === 'number');
  const lines = reasons.map((reason) => lossLine(loss(2, 1, reason)));

  for (const line of lines) expect(line).toMatch(/^2 gaps: \w.*, 1 scan lost$/);
  expect(new Set(lines).size).toBe(reasons.length);
  expect(lossLine(loss(1, 7, 99 as GapReason))).toBe('1 gap: unknown reason, 7 scans lost');
});
