// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { GapReason, LossCountSchema } from '../../generated/dts/v1/stream_pb';
import { lossLine, lossOfSession } from './losses';

const session = (...parts: { reason: GapReason; gapsTotal: bigint; lostScansTotal: bigint }[][]) =>
  create(SessionRecordSchema, { parts: parts.map((losses) => ({ losses })) });

describe('Losses', () => {
  it('OfASession.AreThoseOfAllPartsAndReasons', () => {
    const parts = [
      [{ reason: GapReason.RING_FULL, gapsTotal: 1n, lostScansTotal: 560n }],
      [{ reason: GapReason.SILENCE, gapsTotal: 2n, lostScansTotal: 40n }],
    ];
    expect(lossOfSession(session(...parts))).toBe('600 scans lost in 3 gaps');
  });

  it('GapWithoutLostScans.IsShown', () => {
    expect(lossOfSession(session([{ reason: GapReason.OVERRUN, gapsTotal: 1n, lostScansTotal: 0n }]))).toBe('0 scans lost in 1 gap');
  });

  it('NothingLost.SaysNothing', () => {
    expect(lossOfSession(session([], []))).toBe('');
  });

  it('PartWhoseLossesAreUnknown.IsNotCalledWhole', () => {
    const lost = { reason: GapReason.OVERRUN, gapsTotal: 1n, lostScansTotal: 7n };
    expect(lossOfSession(create(SessionRecordSchema, { parts: [{ isLossUnknown: true }] }))).toBe('losses not known');
    expect(lossOfSession(create(SessionRecordSchema, { parts: [{ losses: [lost] }, { isLossUnknown: true }] }))).toBe('at least 7 scans lost in 1 gap');
  });

  it('EveryReason.HasItsWords', () => {
    const reasons = Object.values(GapReason).filter((reason): reason is GapReason => typeof reason === 'number');
    const lines = reasons.map((reason) => lossLine(create(LossCountSchema, { reason, gapsTotal: 2n, lostScansTotal: 1n })));
    for (const line of lines) expect(line).toMatch(/^2 gaps: \w.*, 1 scan lost$/);
    expect(new Set(lines).size).toBe(reasons.length);
  });

  it('ReasonOfALaterDaemon.IsUnknown', () => {
    expect(lossLine(create(LossCountSchema, { reason: 99 as GapReason, gapsTotal: 1n, lostScansTotal: 7n }))).toBe('1 gap: reason unknown, 7 scans lost');
  });
});
