// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionInfoSchema } from '../../generated/dts/v1/control_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { Quality, SessionState } from '../../generated/dts/v1/stream_pb';
import type { Block } from '../../link/types';
import { isActive } from '../../parts/active';
import { ScanRing } from '../../parts/scan_ring';
import { strings } from '../../strings';
import { progressOf } from './countdown';
import type { Ellipse } from './ellipse';
import { areaOf, ellipseOf } from './ellipse';
import type { Situation } from './guidance';
import { guidanceOf } from './guidance';
import type { View } from './view';
import { nextView } from './view';

const ringOf = (points: readonly (readonly [number, number])[]): ScanRing => {
  const ring = new ScanRing(2, points.length);
  const columns = [0, 1].map((axis) => Float32Array.from(points, (point) => point[axis]!));
  ring.push({ scanCount: points.length, rateHz: 100, timeMs: 0, newestMs: 10 * (points.length - 1), columns, missingScans: 0 } as unknown as Block, [0, 1]);
  return ring;
};

test('ellipseOf.KnownPoints has the area that PEA95_F has', () => {
  // Variances by hand: 16 points at +-3 on the line 30 deg up, 16 at +-1 across it.
  const [cosine, sine] = [Math.cos(Math.PI / 6), Math.sin(Math.PI / 6)];
  const points = Array.from({ length: 32 }, (_, index) => {
    const [along, across] = index % 2 === 0 ? [index % 4 === 0 ? 3 : -3, 0] : [0, index % 4 === 1 ? 1 : -1];
    return [5 + along * cosine - across * sine, -2 + along * sine + across * cosine] as const;
  });
  const [varianceLong, varianceShort] = [(16 * 9) / 31, 16 / 31];
  const factor = ((32 * 32 - 1) / 32) * (0.05 ** (-2 / 30) - 1);

  const ellipse = ellipseOf(ringOf(points), 0, 1, 0, Infinity)!;

  expect(areaOf(ellipse)).toBeCloseTo(Math.PI * factor * Math.sqrt(varianceLong * varianceShort), 4);
  expect([ellipse.centreX, ellipse.centreY]).toEqual([expect.closeTo(5, 5), expect.closeTo(-2, 5)]);
  expect(ellipse.angleRad).toBeCloseTo(Math.PI / 6, 5);
  expect(ellipse.long / ellipse.short).toBeCloseTo(3, 5);
});

test('ellipseOf.MissingScans are left out; too few scans give no ellipse', () => {
  const points = Array.from({ length: 12 }, (_, index) => (index < 3 ? ([NaN, NaN] as const) : ([index, index % 2] as const)));

  expect(ellipseOf(ringOf(points), 0, 1, 0, Infinity)).toBeUndefined();
  expect(ellipseOf(ringOf([...points, [4, 4]]), 0, 1, 0, Infinity)?.samples).toBe(10);
});

const whole: View = { x: 0, y: 0, spanMm: 464 };
const ellipse = (centreX: number, long: number): Ellipse => ({ centreX, centreY: 0, long, short: long / 2, angleRad: 0, samples: 2000 });

test('nextView.EmptyPlate shows the whole plate', () => {
  expect(nextView({ x: 3, y: 3, spanMm: 40 }, undefined, whole)).toBe(whole);
});

test('nextView.QuietStanding is zoomed in on and stays while the ellipse breathes', () => {
  const near = nextView(whole, ellipse(10, 12), whole);

  const later = [10, 11, 12.5].map((long) => nextView(near, ellipse(11, long), whole));

  expect(near.spanMm).toBe(40);
  expect(later).toEqual([near, near, near]);
  expect(later.every((view) => view === near)).toBe(true);
});

test('nextView.SmallEllipse is zoomed in on wherever it is on the plate', () => {
  const far = nextView(whole, ellipse(60, 70), whole); // the person stepped on

  expect(nextView(far, ellipse(60, 6), whole).spanMm).toBe(20);
});

test('nextView.EllipseThatLeaves is followed, one that grows too large shows the plate', () => {
  const near = nextView(whole, ellipse(0, 12), whole);

  expect(nextView(near, ellipse(30, 12), whole).x).toBeCloseTo(30, 0);
  expect(nextView(near, ellipse(0, 40), whole).spanMm).toBe(160);
  expect(nextView(near, ellipse(0, 200), whole)).toBe(whole);
});

const calm: Situation = { isOld: false, quality: 0, distanceMm: 5, plateMm: 430, session: SessionState.IDLE, phase: TrialPhase.UNSPECIFIED, outcome: undefined };
const running = { ...calm, session: SessionState.RUNNING };

test.each<[string, Situation]>([
  ['noData', { ...running, isOld: true }],
  ['standing', calm],
  ['nobody', { ...calm, quality: Quality.NO_CONTACT }],
  ['untared', { ...calm, quality: Quality.NO_CONTACT | Quality.UNTARED }],
  ['untared', { ...calm, quality: Quality.UNTARED }],
  ['offCentre', { ...calm, distanceMm: 90 }],
  ['recording', running],
  ['first', { ...running, phase: TrialPhase.WAITING }],
  ['settling', { ...running, phase: TrialPhase.SETTLING }],
  ['measuring', { ...running, phase: TrialPhase.MEASURING, outcome: 'done' }],
  ['nobody', { ...running, phase: TrialPhase.MEASURING, quality: Quality.NO_CONTACT }],
  ['done', { ...running, phase: TrialPhase.WAITING, outcome: 'done', quality: Quality.NO_CONTACT }],
  ['rejected', { ...running, phase: TrialPhase.WAITING, outcome: 'rejected' }],
  ['steppedOff', { ...running, phase: TrialPhase.WAITING, outcome: 'steppedOff' }],
  ['resting', { ...running, phase: TrialPhase.RESTING, outcome: 'done' }],
  ['rejected', { ...running, phase: TrialPhase.RESTING, outcome: 'rejected' }],
  ['finished', { ...running, phase: TrialPhase.FINISHED, outcome: 'done' }],
  ['feetMoved', { ...running, phase: TrialPhase.FINISHED, outcome: 'feetMoved' }],
  ['failed', { ...calm, session: SessionState.FAILED }],
])('guidanceOf.%s', (state, situation) => {
  expect(guidanceOf(situation)).toBe(state);
});

test.each([
  [SessionState.RUNNING, true],
  [SessionState.STOPPING, true],
  [SessionState.IDLE, false],
  [SessionState.FAILED, false], // another can be started
])('isActive.State %i: %s', (state, expected) => {
  expect(isActive(create(SessionInfoSchema, { sessionId: 's', state }))).toBe(expected);
});

const inTrial = (phase: TrialPhase, remainingS: number, durationS?: number) =>
  create(SessionInfoSchema, {
    sessionId: 's',
    state: SessionState.RUNNING,
    trial: { phase, remainingS, trial: 1, attempt: 1, settleS: 5, ...(durationS === undefined ? {} : { durationS }) },
  });
const { SETTLING, MEASURING, WAITING } = TrialPhase;

test('progressOf.TabOpenedInATrial shows the whole ring from the status alone: settling first, then the measurement', () => {
  const [first, second] = [progressOf(inTrial(SETTLING, 5, 30), 1)!, progressOf(inTrial(MEASURING, 30, 30), 10)!];

  expect(first).toMatchObject({ seconds: 4, shares: { settle: expect.closeTo(5 / 35, 9), done: expect.closeTo(1 / 35, 9) } });
  expect(second).toMatchObject({ seconds: 20, shares: { settle: expect.closeTo(5 / 35, 9), done: expect.closeTo(15 / 35, 9) } });
});

test('progressOf.WaitingTrial or one without an end has no time; a free recording counts up, one with an end down', () => {
  const free = create(SessionInfoSchema, { sessionId: 's', state: SessionState.RUNNING, elapsedS: 12.4 });
  const ending = create(SessionInfoSchema, { sessionId: 's', state: SessionState.RUNNING, elapsedS: 9, settleS: 10, durationS: 30 });

  expect([inTrial(WAITING, 0), inTrial(MEASURING, 0)].map((session) => progressOf(session, 0))).toEqual([undefined, undefined]);
  expect(progressOf(inTrial(SETTLING, 3), 0)).toEqual({ seconds: 3, words: strings.floor.settleLeft, shares: undefined });
  expect(progressOf(free, 0.7)).toEqual({ seconds: 13, words: strings.floor.elapsed, shares: undefined });
  expect(progressOf(ending, 1)).toMatchObject({ seconds: 20, shares: { settle: 0.25, done: 0.5 } });
});
