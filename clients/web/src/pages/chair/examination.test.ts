// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { RigStatusSchema } from '../../generated/dts/v1/control_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { EventSchema, ReachStep, SessionState, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import type { LiveEvent } from '../../link/types';
import type { Examination } from './examination';
import { afterEvent, afterStatus, noExamination, targetPercent } from './examination';

type Body = NonNullable<MessageInitShape<typeof EventSchema>['body']>;

const event = (body: Body, scan = 0, timeMs = 0, segment = 0): LiveEvent => ({
  topic: 'chair/trial',
  rig: 'chair',
  kind: 'trial',
  timeMs,
  event: create(EventSchema, { segment, scan: BigInt(scan), body }),
});

const trial = (kind: TrialEventKind, more: { scan?: number; trial?: number; condition?: string; targetCm?: number; restS?: number } = {}): LiveEvent => {
  const { scan = 0, ...fields } = more;
  return event({ case: 'trial', value: { sessionId: 's1', step: kind, trial: 1, attempt: 1, condition: '120', targetCm: 84, ...fields } }, scan, 1000);
};

const reach = (step: ReachStep, p1Scan: number, number = 1, segment = 0): LiveEvent =>
  event({ case: 'reach', value: { step, number, p1: { scan: BigInt(p1Scan), valueMm: 3.7 } } }, p1Scan + 100, 0, segment);

const after = (...events: readonly LiveEvent[]): Examination => events.reduce(afterEvent, noExamination);

const { READY, GO, MEASURE, DONE, REST, FINISHED, REDONE } = TrialEventKind;
const { P1, FINAL, CANCELLED } = ReachStep;
const going = [trial(READY), trial(GO, { scan: 5000 })];
const reached = [...going, reach(FINAL, 5200)];
const movement = (number: number): LiveEvent => event({ case: 'movement', value: { number, trunkClass: 2 } });
const result = (attempt: number, hasGap = false): LiveEvent =>
  event({ case: 'trialResult', value: { sessionId: 's1', trial: 1, attempt, expectedClass: 1, hasGap } });

test.each<[string, readonly LiveEvent[], object]>([
  ['AfterGo counts time from that scan', [...going, trial(MEASURE, { scan: 5000 })], { step: 'go', goAt: { segment: 0, scan: 5000 }, targetCm: 84 }],
  ['FinalReachAfterGo sends the hand back', [...going, reach(P1, 5200), reach(FINAL, 5200)], { step: 'back', reach: { step: FINAL } }],
  ['MeasureWithTheHandOnItsWayBack leaves it there', [...reached, trial(MEASURE)], { step: 'back' }],
  ['ReachAtGo is the trial\'s', [...going, reach(P1, 5000)], { step: 'go', reach: { number: 1 } }],
  ['ReachThatBeganBeforeGo does not belong to the trial', [...going, reach(FINAL, 4990)], { step: 'go', reach: undefined }],
  ['ReachOfAnotherSegment does not belong to the trial', [...going, reach(FINAL, 5200, 1, 1)], { step: 'go', reach: undefined }],
  ['ReachAfterTheTrial does not belong to it', [...going, trial(DONE), reach(P1, 5200)], { step: 'waiting', reach: undefined }],
  ['SecondReach does not replace a final one', [...going, reach(FINAL, 5200, 7), reach(P1, 9000, 8)], { reach: { number: 7 } }],
  ['SecondReach replaces one that is under way', [...going, reach(P1, 5200, 7), movement(7), reach(P1, 9000, 8)], { reach: { number: 8 }, movement: undefined }],
  ['EndOfThePlan leaves the last trial and its reach in sight', [...reached, trial(DONE), trial(FINISHED, { trial: 0, condition: '', targetCm: 0 })],
    { step: 'finished', trial: 1, condition: '120', reach: { number: 1 }, goAt: { scan: 5000 } }],
  ['DoneAfterTheEnd leaves it ended', [...reached, trial(FINISHED, { trial: 0 }), trial(DONE)], { step: 'finished' }],
  ['CancelledReach is forgotten', [...going, reach(P1, 5200), movement(1), reach(CANCELLED, 5200)], { step: 'go', reach: undefined, movement: undefined }],
  ['CancelledReachOfAnotherNumber is not this one', [...going, reach(P1, 5200), reach(CANCELLED, 5200, 2)], { reach: { step: P1 } }],
  ['WithoutSession shows the newest reach', [reach(FINAL, 100, 1), reach(P1, 900, 2)], { step: 'free', reach: { number: 2 } }],
  ['MovementOfTheReach is shown', [...reached, movement(1)], { movement: { trunkClass: 2 } }],
  ['MovementOfAnotherReach is ignored', [...reached, movement(3)], { movement: undefined }],
  ['ResultWithoutReach says so', [...reached, trial(DONE), result(1)], { isWithoutReach: true, expectedClass: 1, reach: undefined }],
  ['ResultWithAGap says so', [...reached, trial(DONE), result(1, true)], { isWithoutReach: true, hasGap: true }],
  ['ResultOfAnotherAttempt changes nothing shown', [...reached, trial(DONE), result(2)], { isWithoutReach: false, expectedClass: -1, reach: { number: 1 } }],
  ['Rest ends after its seconds by the clock of its event', [...going, trial(DONE), trial(REST, { restS: 5 })], { step: 'resting', restEndsMs: 6000 }],
])('Examination.%s', (_, events, expected) => {
  expect(after(...events)).toMatchObject(expected);
});

test('Examination.RepeatedGo keeps what was found since', () => {
  expect(afterEvent(after(...reached), trial(GO, { scan: 5000 }))).toEqual(after(...reached));
});

test('Examination.UndoneRedo continues the attempt; the next status says what it does now', () => {
  const again = after(...reached, trial(REDONE), event({ case: 'trial', value: { sessionId: 's1', step: READY, trial: 1, attempt: 2, condition: '120' } }));

  const undone = afterEvent(again, trial(TrialEventKind.UNDONE));

  expect(undone).toMatchObject({ step: 'back', trial: 1, attempt: 1, goAt: { scan: 5000 }, reach: { number: 1 } });
  expect(undone.changes).toBeGreaterThan(again.changes);
  expect(afterStatus(undone, status(RUNNING, WAITING, 's1', 1), later)).toMatchObject({ step: 'waiting', trial: 1, attempt: 1 });
});

test('Examination.NextTrial leaves the result in sight until go', () => {
  const ready = { ...after(...reached, trial(DONE), trial(READY, { trial: 2 })), expectedClass: 2 };

  expect(ready.reach).toBeDefined();
  expect(afterEvent(ready, trial(GO, { trial: 2, scan: 9000 }))).toMatchObject({ reach: undefined, movement: undefined, expectedClass: -1, isWithoutReach: false });
});

test.each([DONE, REDONE, FINISHED, REST])('Examination.TrialEvent %i reloads the list of trials', (kind) => {
  const before = after(...going);

  expect(afterEvent(before, trial(kind)).changes).toBeGreaterThan(before.changes);
});

test('targetPercent.Is of the arm, if that is known', () => {
  const examination = { ...noExamination, armLengthCm: 70 };

  expect([targetPercent(examination, 124), targetPercent(examination, 0), targetPercent(noExamination, 124)]).toEqual([(100 * 124) / 70, undefined, undefined]);
});

const status = (state: SessionState, phase: TrialPhase, sessionId = 's1', trial = 2) =>
  create(RigStatusSchema, { session: { sessionId, state, trial: { phase, trial, attempt: 1, condition: '120', targetCm: 82, of: 9, nextCondition: '150', nextTargetCm: 105 } } });
const { RUNNING, IDLE } = SessionState;
const { WAITING, RESTING, MEASURING } = TrialPhase;
const atOnce = 0n;
const later = 1_500_000_000n; // more than a second after all events

test.each<[string, readonly LiveEvent[], ReturnType<typeof status>, bigint, object]>([
  ['OfATabThatCameLate reports the step', [], status(RUNNING, RESTING), atOnce, { sessionId: 's1', step: 'resting', trial: 2, of: 9, nextCondition: '150', nextTargetCm: 105 }],
  ['OfATabOpenedInATrial has its target', [], status(RUNNING, MEASURING), atOnce, { step: 'go', trial: 2, condition: '120', targetCm: 82 }],
  ['DuringATrial does not undo later events', going, status(RUNNING, TrialPhase.READY, 's1', 1), atOnce, { step: 'go', of: 9 }],
  ['ASecondAfterTheEvents is not later yet', reached, status(RUNNING, WAITING, 's1', 1), 1_000_000_000n, { step: 'back' }],
  ['OfTheNextTrial forgets what was found in the lost one', reached, status(RUNNING, MEASURING), later, { step: 'go', trial: 2, goAt: undefined, reach: undefined }],
  ['OfTheNextTrial that waits leaves it to be read', reached, status(RUNNING, TrialPhase.READY), later, { step: 'ready', trial: 2, goAt: undefined, reach: { number: 1 } }],
  ['OfTheSameTrial leaves the hand on its way back', reached, status(RUNNING, MEASURING, 's1', 1), later, { step: 'back', changes: after(...reached).changes, goAt: { scan: 5000 } }],
  ['AfterARestThatWaitsForACommand waits', [...going, trial(REST)], status(RUNNING, WAITING, 's1', 1), atOnce, { step: 'waiting' }],
  ['OfASessionThatIsOver leaves the trials listed', going, status(IDLE, TrialPhase.FINISHED), atOnce, { step: 'free', sessionId: 's1', goAt: undefined }],
])('afterStatus.Status %s', (_, events, said, madeNs, expected) => {
  expect(afterStatus(after(...events), said, madeNs)).toMatchObject(expected);
});

test.each([
  [WAITING, 'waiting'],
  [RESTING, 'resting'],
  [TrialPhase.FINISHED, 'finished'],
])('afterStatus.Phase %i of a later status ends a trial whose end got lost', (phase, step) => {
  const before = after(...reached);

  const [early, late] = [atOnce, later].map((madeNs) => afterStatus(before, status(RUNNING, phase, 's1', 1), madeNs));

  expect(early!.step).toBe('back');
  expect(late).toMatchObject({ step, trial: 1, reach: before.reach });
  expect(late!.changes).toBeGreaterThan(before.changes);
});

test('afterStatus.NewSessionWithoutTrials leaves nothing of the one before', () => {
  const before = after(...reached);
  const withoutTrials = create(RigStatusSchema, { session: { sessionId: 's2', state: RUNNING } });

  const examination = afterStatus(before, withoutTrials, atOnce);

  expect(examination).toEqual({ ...noExamination, sessionId: 's2', changes: before.changes + 1 });
  expect(afterStatus(examination, withoutTrials, later)).toBe(examination);
});

test('afterStatus.StatusOfTheSessionBefore changes nothing until it is later', () => {
  const before = after(trial(READY));
  const idle = status(IDLE, TrialPhase.FINISHED, 's0');

  expect(afterStatus(before, idle, atOnce)).toBe(before);
  expect(afterStatus(before, idle, later).step).toBe('free');
});
