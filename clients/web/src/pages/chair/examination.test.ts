// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';

import { RigStatusSchema } from '../../generated/dts/v1/control_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { EventSchema, ReachStep, SessionState, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import type { LiveEvent } from '../../link/types';
import type { Examination } from './examination';
import { noExamination, seen, targetPercent, told } from './examination';

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
  return event({ case: 'trial', value: { sessionId: 's1', kind, trial: 1, attempt: 1, condition: '120', targetCm: 84, ...fields } }, scan, 1000);
};

const reach = (step: ReachStep, p1Scan: number, number = 1, segment = 0): LiveEvent =>
  event({ case: 'reach', value: { step, number, p1: { scan: BigInt(p1Scan), valueMm: 3.7 } } }, p1Scan + 100, 0, segment);

const after = (...events: readonly LiveEvent[]): Examination => events.reduce(told, noExamination);

const { READY, GO, MEASURE, DONE, REST, FINISHED, REDONE } = TrialEventKind;

describe('Examination', () => {
  it('AfterGo.CountsTimeFromThatScan', () => {
    const examination = after(trial(READY), trial(GO, { scan: 5000 }), trial(MEASURE, { scan: 5000 }));

    expect(examination.step).toBe('go');
    expect(examination.goAt).toEqual({ segment: 0, scan: 5000 });
    expect(examination.targetCm).toBe(84);
  });

  it('FinalReachAfterGo.SendsTheHandBack', () => {
    const examination = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.P1, 5200), reach(ReachStep.FINAL, 5200));

    expect(examination.step).toBe('back');
    expect(examination.reach?.step).toBe(ReachStep.FINAL);
  });

  it('GoToldAgain.KeepsWhatWasFoundSince', () => {
    const before = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.FINAL, 5200));

    expect(told(before, trial(GO, { scan: 5000 }))).toEqual(before);
  });

  it.each([
    ['BeganBeforeGo', reach(ReachStep.FINAL, 4990)],
    ['OfAnotherSegment', reach(ReachStep.FINAL, 5200, 1, 1)],
  ])('Reach%s.IsNoneOfTheTrials', (_, stray) => {
    const examination = after(trial(READY), trial(GO, { scan: 5000 }), stray);

    expect(examination.step).toBe('go');
    expect(examination.reach).toBeUndefined();
  });

  it('SecondReachOfATrial.DoesNotReplaceTheFirst', () => {
    const examination = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.FINAL, 5200, 7), reach(ReachStep.P1, 9000, 8));

    expect(examination.reach?.number).toBe(7);
  });

  it('NextTrial.LeavesTheVerdictInSightUntilGo', () => {
    const ready = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.FINAL, 5200), trial(DONE), trial(READY, { trial: 2 }));

    expect(ready.reach).toBeDefined();
    expect(told(ready, trial(GO, { trial: 2, scan: 9000 })).reach).toBeUndefined();
  });

  it('EndOfThePlan.LeavesTheLastTrialAndItsReachInSight', () => {
    const before = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.FINAL, 5200), trial(DONE));

    const examination = told(before, trial(FINISHED, { trial: 0, condition: '', targetCm: 0 }));

    expect(examination).toMatchObject({ step: 'finished', trial: 1, condition: '120', reach: before.reach, goAt: before.goAt });
  });

  it('CancelledReach.IsForgotten', () => {
    const examination = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.P1, 5200), reach(ReachStep.CANCELLED, 5200));

    expect(examination.reach).toBeUndefined();
    expect(examination.step).toBe('go');
  });

  it('WithoutSession.ShowsTheNewestReach', () => {
    const examination = after(reach(ReachStep.FINAL, 100, 1), reach(ReachStep.P1, 900, 2));

    expect(examination.step).toBe('free');
    expect(examination.reach?.number).toBe(2);
  });

  it('MovementOfAnotherReach.IsIgnored', () => {
    const movement = event({ case: 'movement', value: { number: 3, trunkClass: 2 } });

    const examination = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.FINAL, 5200, 4), movement);

    expect(examination.movement).toBeUndefined();
  });

  it('ResultWithoutReach.SaysSo', () => {
    const result = event({ case: 'trialResult', value: { sessionId: 's1', trial: 1, attempt: 1, expectedClass: 1 } });

    const examination = after(trial(READY), trial(GO, { scan: 5000 }), trial(DONE), result);

    expect(examination.isWithoutReach).toBe(true);
    expect(examination.expectedClass).toBe(1);
  });

  it('Rest.EndsAfterItsSecondsByTheEventsClock', () => {
    const examination = after(trial(READY), trial(GO), trial(DONE), trial(REST, { restS: 5 }));

    expect(examination.step).toBe('resting');
    expect(examination.restEndsMs).toBe(6000);
  });

  it.each([DONE, REDONE, FINISHED, REST])('TrialEvent%i.MakesTheListOfTrialsAskedForAnew', (kind) => {
    const before = after(trial(READY), trial(GO));

    expect(told(before, trial(kind)).changes).toBeGreaterThan(before.changes);
  });

  it('ArmLength.OfTheSessionTellsTargetsInPercent', () => {
    const examination = { ...noExamination, armLengthCm: 70 };

    expect(targetPercent(examination, 124)).toBeCloseTo((100 * 124) / 70);
    expect(targetPercent(examination, 0)).toBeUndefined();
    expect(targetPercent(noExamination, 124)).toBeUndefined();
  });
});

const status = (state: SessionState, phase: TrialPhase, sessionId = 's1', trial = 2) =>
  create(RigStatusSchema, { session: { sessionId, state, trial: { phase, trial, attempt: 1, condition: '120', of: 9, nextCondition: '150', nextTargetCm: 105 } } });
const { RUNNING, IDLE } = SessionState;
const atOnce = 0n;
const later = 1_500_000_000n; // a second and more after all events

describe('ExaminationStatus', () => {
  it('OfATabThatCameLate.TellsTheStep', () => {
    const examination = seen(noExamination, status(RUNNING, TrialPhase.RESTING), atOnce);

    expect(examination).toMatchObject({ sessionId: 's1', step: 'resting', trial: 2, of: 9, nextCondition: '150' });
  });

  it('DuringATrial.DoesNotTakeBackWhatEventsToldMeanwhile', () => {
    const examination = seen(after(trial(READY), trial(GO)), status(RUNNING, TrialPhase.READY, 's1', 1), atOnce);

    expect(examination.step).toBe('go');
    expect(examination.of).toBe(9);
  });

  it.each([
    [TrialPhase.WAITING, 'waiting'],
    [TrialPhase.RESTING, 'resting'],
    [TrialPhase.FINISHED, 'finished'],
  ])('Phase%iOfALaterStatus.EndsATrialWhoseEndGotLost', (phase, step) => {
    const before = after(trial(READY), trial(GO), reach(ReachStep.FINAL, 5200));

    const [early, late] = [atOnce, later].map((madeNs) => seen(before, status(RUNNING, phase, 's1', 1), madeNs));

    expect(early!.step).toBe('back');
    expect(late).toMatchObject({ step, trial: 1, reach: before.reach });
    expect(late!.changes).toBeGreaterThan(before.changes);
  });

  it('LaterStatusOfTheNextTrial.ForgetsWhatWasFoundInTheLostOne', () => {
    const before = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.FINAL, 5200));

    const examination = seen(before, status(RUNNING, TrialPhase.MEASURING), later);

    expect(examination).toMatchObject({ step: 'go', trial: 2, goAt: undefined, reach: undefined });
  });

  it('LaterStatusOfTheSameTrial.LeavesTheHandOnItsWayBack', () => {
    const before = after(trial(READY), trial(GO, { scan: 5000 }), reach(ReachStep.FINAL, 5200));

    const examination = seen(before, status(RUNNING, TrialPhase.MEASURING, 's1', 1), later);

    expect(examination).toMatchObject({ step: 'back', changes: before.changes, goAt: before.goAt });
  });

  it('AfterARestThatWaitsForACommand.Waits', () => {
    const examination = seen(after(trial(READY), trial(GO), trial(REST)), status(RUNNING, TrialPhase.WAITING, 's1', 1), atOnce);

    expect(examination.step).toBe('waiting');
  });

  it('SessionOver.LeavesTheTrialsListed', () => {
    const examination = seen(after(trial(READY), trial(GO)), status(IDLE, TrialPhase.FINISHED), atOnce);

    expect(examination.step).toBe('free');
    expect(examination.sessionId).toBe('s1');
  });

  it('NewSessionWithoutTrials.LeavesNothingOfTheOneBefore', () => {
    const before = after(trial(READY), trial(GO), reach(ReachStep.FINAL, 5200));
    const withoutTrials = create(RigStatusSchema, { session: { sessionId: 's2', state: RUNNING } });

    const examination = seen(before, withoutTrials, atOnce);

    expect(examination).toEqual({ ...noExamination, sessionId: 's2', changes: before.changes + 1 });
    expect(seen(examination, withoutTrials, later)).toBe(examination);
  });

  it('OfTheSessionBefore.ChangesNothingUntilItIsLater', () => {
    const before = after(trial(READY));
    const idle = status(IDLE, TrialPhase.FINISHED, 's0');

    expect(seen(before, idle, atOnce)).toBe(before);
    expect(seen(before, idle, later).step).toBe('free');
  });
});
