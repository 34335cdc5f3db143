// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';

import { StatusSnapshotSchema } from '../../generated/dts/v1/control_pb';
import { TrialOutcome } from '../../generated/dts/v1/sessions_pb';
import { Quality, SessionState, SwaySchema, SwayWindow, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import { fakeLink } from '../../testing';
import { strings } from '../../strings';
import { areaOf } from './ellipse';
import { LiveFloor, windowName } from './live_floor';

const channels = ['ml_mm', 'ap_mm', 'load_n'].map((name) => ({ name }));

const sessionId = 'P017';
const hostNs = (timeMs: number): bigint => BigInt(timeMs) * 1_000_000n;

const openFloor = (state = SessionState.RUNNING) => {
  const fake = fakeLink([{ rig: { name: 'chair' }, session: { state: SessionState.IDLE } }, { rig: { name: 'floor' }, session: { sessionId, state } }]);
  const floor = new LiveFloor(fake.link, 'floor');
  const stand = (quality = 0, values = [0, 0, 0], timeMs = 0): void =>
    fake.block('floor/cop', values.map((value) => [value]), { format: { channels }, firstScan: timeMs / 10, timeMs, newestMs: timeMs, quality: Uint8Array.of(quality, 0, 0) });
  const sway = (trial: number, isPreliminary = false, value = 5): void =>
    fake.event('floor/sway', { body: { case: 'sway', value: { sessionId, trial, attempt: 1, isPreliminary, measures: [{ symbol: 'MVELO', value }, { symbol: 'RANGE_AP', value: NaN }] } } });
  const trial = (kind: TrialEventKind, timeMs = 0, number = 0): void =>
    fake.event('floor/trial', { hostTimeNs: hostNs(timeMs), body: { case: 'trial', value: { sessionId, step: kind, trial: number, attempt: 1 } } }, timeMs);
  const session = (next: SessionState): void => fake.event('floor/session', { body: { case: 'session', value: { state: next } } });
  /** The status of a session after a trial; 0: before the first. */
  const status = (timeMs: number, id: string, number: number, next = SessionState.RUNNING, lastOutcome = TrialOutcome.DONE): void => {
    const attempt = number === 0 ? 0 : 1;
    const trial = { trial: number, attempt, lastTrial: number, lastAttempt: attempt, lastOutcome };
    const rigs = [{ rig: { name: 'floor' }, session: { sessionId: id, state: next, trial } }];
    fake.link.status.value = create(StatusSnapshotSchema, { hostTimeNs: hostNs(timeMs), rigs });
  };
  return { fake, floor, stand, sway, trial, session, status };
};

beforeEach(() => void vi.useFakeTimers({ now: 7000 }));
afterEach(() => void vi.useRealTimers());

test.each<[string, SessionState, number | undefined]>([
  ['NextPersonAfterTheSession sees no result of the person before', SessionState.IDLE, undefined],
  ['SubjectBackOnThePlate within the session keeps the result', SessionState.RUNNING, 4],
])('LiveFloor.%s', (_, state, expected) => {
  const { floor, stand, sway } = openFloor(state);
  stand();
  sway(4);
  stand(Quality.NO_CONTACT);
  const whileEmpty = floor.sway.value?.sway.trial;

  stand();

  expect(whileEmpty).toBe(4);
  expect(floor.sway.value?.sway.trial).toBe(expected);
});

test('LiveFloor.Values are those of the newest scan, updated four times a second', () => {
  const { fake, floor, stand } = openFloor();
  const shown = [];

  fake.paint(1000);
  for (const nowMs of [1000, 1249, 1250]) {
    stand(0, [nowMs, 2, 980.665], nowMs);
    fake.paint(nowMs);
    shown.push(floor.now.value.mlMm);
  }
  fake.block('floor/deflection', [[1, 5], [2, 6]], { quality: Uint8Array.of(0, 16) });

  expect(shown).toEqual([1000, 1000, 1250]);
  expect(floor.now.value).toMatchObject({ apMm: 2, loadKg: expect.closeTo(100, 4), quality: 0 });
  expect([floor.deflectionMm, floor.sensorQuality]).toEqual([[5, 6], [0, 16]]);
  floor.close();
  expect(fake.topics()).toEqual([]);
});

test('LiveFloor.Ellipse has the area of the tile and the scans of its window; without a value there is none', () => {
  const { fake, floor, stand, trial } = openFloor();
  for (let timeMs = 0; timeMs <= 20_300; timeMs += 10) stand(0, [timeMs < 20_000 ? 500 : 9 + ((timeMs / 10) % 2), (timeMs / 10) % 3, 0], timeMs);
  const measures = [{ symbol: 'PEA95_F', value: 123 }];
  const result = { sessionId, trial: 1, attempt: 1 };
  const running = { isPreliminary: true, durationS: 0.25, window: SwayWindow.LATEST, windowS: 30, measures };

  fake.event('floor/sway', { body: { case: 'sway', value: running } }, 20_300);
  const latest = floor.ellipse.value!;
  trial(TrialEventKind.MEASURE, 20_100, 1);
  trial(TrialEventKind.DONE, 20_200, 1);
  fake.event('floor/sway', { body: { case: 'sway', value: { ...result, measures } } }, 20_300);
  const ofTrial = floor.ellipse.value!;
  fake.event('floor/sway', { body: { case: 'sway', value: { ...result, measures: [] } } }, 20_300);

  expect([latest.samples, ofTrial.samples]).toEqual([25, 10]);
  expect([areaOf(latest), areaOf(ofTrial)]).toEqual([expect.closeTo(123, 6), expect.closeTo(123, 6)]);
  expect(latest.centreX).toBeCloseTo(9.5, 1); // nothing of what was before
  expect(floor.ellipse.value).toBeUndefined();
});

const recalled = (trial: number) => create(SwaySchema, { sessionId, trial, attempt: 1, measures: [{ symbol: 'PEA95_F', value: 123 }] });

test('LiveFloor.ResultFromTheCatalogue is not shown when the next trial has begun', () => {
  const { floor, trial } = openFloor();

  trial(TrialEventKind.READY, 0, 1);
  floor.recall(recalled(1));
  const shown = floor.sway.value?.sway.trial;
  trial(TrialEventKind.READY, 0, 2);
  floor.recall(recalled(1));

  expect([shown, floor.sway.value]).toEqual([1, undefined]);
});

// A status may be a second older than the event that arrived before it.
test.each<[string, number, number | undefined]>([
  ['that was measured while the tab was hidden is shown', 2001, 2],
  ['is not shown when the status may be older than the last event', 2000, undefined],
])('LiveFloor.ResultFromTheCatalogue %s', (_, statusMs, expected) => {
  const { floor, trial, status } = openFloor();
  trial(TrialEventKind.DONE, 1000, 1);
  status(statusMs, sessionId, 2);

  floor.recall(recalled(2));

  expect(floor.sway.value?.sway.trial).toBe(expected);
});

test('LiveFloor.ResultFromTheCatalogue that came too early is shown when the status allows it', () => {
  const { floor, trial, status } = openFloor();
  trial(TrialEventKind.DONE, 1000, 2);
  trial(TrialEventKind.REJECTED, 1500, 2);

  floor.recall(recalled(2)); // this tab missed the Undo
  const before = floor.sway.value;
  status(4000, sessionId, 2);

  expect(before).toBeUndefined();
  expect(floor.sway.value?.sway.trial).toBe(2);
});

test('LiveFloor.After a boot of the other computer its status is believed, although its clock begins again', () => {
  const { fake, floor, trial, session } = openFloor();
  trial(TrialEventKind.DONE, 900_000, 4);
  session(SessionState.STARTING);

  const rigs = [{ rig: { name: 'floor' }, session: { sessionId, state: SessionState.RUNNING, trial: { trial: 1, attempt: 1, lastOutcome: TrialOutcome.DONE } } }];
  fake.link.status.value = create(StatusSnapshotSchema, { instanceId: 2n, hostTimeNs: hostNs(60_000), rigs });
  floor.recall(recalled(1));

  expect(floor.sway.value?.sway.trial).toBe(1);
});

// requirement: UI-16
test('LiveFloor.ResultFromTheCatalogue of a rejected trial is shown only after Undo', () => {
  const { floor, sway, trial } = openFloor();
  trial(TrialEventKind.DONE, 0, 4);
  sway(4);

  trial(TrialEventKind.REJECTED, 0, 4);
  floor.recall(recalled(4)); // the page's copy of the record may be older than the rejection
  const rejected = floor.sway.value;
  trial(TrialEventKind.UNDONE, 0, 4);
  floor.recall(recalled(4));

  expect(rejected).toBeUndefined();
  expect(floor.sway.value?.sway.trial).toBe(4);
});

test.each<[string, readonly [TrialEventKind, number, number][], boolean]>([
  ['has the scans of its trial', [[TrialEventKind.MEASURE, 100, 2], [TrialEventKind.DONE, 200, 2]], true],
  ['of which this tab missed the begin has none', [[TrialEventKind.MEASURE, 100, 1], [TrialEventKind.DONE, 200, 2]], false],
  ['of which this tab missed the end has none', [[TrialEventKind.MEASURE, 100, 2]], false],
])('LiveFloor.Ellipse of a trial %s', (_, steps, hasEllipse) => {
  const { fake, floor, stand, trial } = openFloor();
  for (let timeMs = 0; timeMs <= 300; timeMs += 10) stand(0, [(timeMs / 10) % 2, (timeMs / 10) % 3, 0], timeMs);
  for (const [kind, timeMs, number] of steps) trial(kind, timeMs, number);

  fake.event('floor/sway', { body: { case: 'sway', value: recalled(2) } }, 300);
  const live = floor.ellipse.value?.samples;
  trial(TrialEventKind.DONE, 200, 2);
  floor.recall(recalled(2));

  expect(live).toBe(hasEllipse ? 10 : undefined);
  expect(floor.ellipse.value !== undefined).toBe(steps[0]![2] === 2);
});

test.each<[MessageInitShape<typeof SwaySchema>, string]>([
  [{ isPreliminary: true, window: SwayWindow.LATEST, durationS: 30, windowS: 30 }, 'last 30 s'],
  [{ isPreliminary: true, window: SwayWindow.LATEST, durationS: 0.5, windowS: 30 }, 'last 1 s'],
  [{ isPreliminary: true, trial: 2, window: SwayWindow.TRIAL }, 'trial 2 so far'],
  [{ trial: 2 }, 'trial 2'],
])('windowName.%j is %j', (sway, expected) => {
  expect(windowName(create(SwaySchema, sway), strings.floor.windows)).toBe(expected);
});

test.each<[string, (open: ReturnType<typeof openFloor>) => void, boolean]>([
  ['running values', ({ sway }) => sway(0, true), true],
  ['the end of its trial', ({ trial }) => trial(TrialEventKind.DONE), true],
  ['running values of the next trial', ({ sway }) => sway(5, true), false],
  ['the next trial', ({ trial }) => trial(TrialEventKind.READY), false],
  ['its start', ({ trial }) => trial(TrialEventKind.GO), false],
  ['its rejection', ({ trial }) => trial(TrialEventKind.REJECTED), false],
  ['its redo', ({ trial }) => trial(TrialEventKind.REDONE), false],
  ['its abort', ({ trial }) => trial(TrialEventKind.ABORTED), false],
  ['a rejection that only the status reports', ({ status }) => status(5000, sessionId, 4, SessionState.RUNNING, TrialOutcome.REJECTED), false],
  ['the next session', ({ session }) => session(SessionState.STARTING), false],
  ['the end of the session', ({ session }) => session(SessionState.IDLE), true],
  ['the end of the session that only the status reports', ({ status }) => status(5000, sessionId, 4, SessionState.IDLE), true],
  ['the next session that only the status reports', ({ status }) => status(5000, 'P018', 0), false],
  ['a next session that is over already', ({ status }) => status(5000, 'P018', 4, SessionState.IDLE), false],
])('LiveFloor.Result of a trial after %s', (_, next, isKept) => {
  const open = openFloor();
  open.trial(TrialEventKind.MEASURE, 50);
  open.sway(4);

  next(open);

  expect(open.floor.sway.value?.sway.trial === 4).toBe(isKept);
});

test('LiveFloor.Running values become sparks of one trial, a minute at most', () => {
  const { floor, sway } = openFloor();
  sway(1, true, 3);
  for (let i = 0; i < 121; i += 1) sway(2, true, i);

  expect([...floor.sway.value!.values]).toEqual([['MVELO', 120]]);
  expect([floor.sparks.get('MVELO')!.length, floor.sparks.get('MVELO')![0], floor.sparks.get('RANGE_AP')![0]]).toEqual([120, 1, NaN]);
});

test('LiveFloor.Gap is reported with its length, markers are bounded', () => {
  const { fake, floor, stand } = openFloor();
  const gap = (): void => fake.event('floor/gap', { body: { case: 'gap', value: { missingScans: 50n } } });

  gap(); // before any block its length is unknown
  const unknown = floor.absence.value;
  stand();
  gap();
  for (let i = 0; i < 51; i += 1) fake.event('floor/marker', { body: { case: 'marker', value: { text: `${i}` } } }, i);

  expect([unknown, floor.absence.value]).toEqual([undefined, { back: { atMs: performance.now(), dateMs: 7000 }, seconds: 0.5 }]);
  expect([floor.markers.length, floor.markers[0]]).toEqual([50, { timeMs: 1, text: '1' }]);
});
