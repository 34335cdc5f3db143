// SPDX-License-Identifier: Apache-2.0
// The state of a session of the reaching task, computed from the rig's events (immediate) and its status (once a second). Pure functions over one
// value, so that tests need no screen.
import { SessionState, ReachStep, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import type { Reach, TrialChange, TrialResult, TrunkMovement } from '../../generated/dts/v1/stream_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { TrialStatus } from '../../generated/dts/v1/sessions_pb';
import type { RigStatus, SessionInfo } from '../../generated/dts/v1/control_pb';
import type { LiveEvent } from '../../link/types';
import { includesEvent } from '../../parts/later_status';

/** What the subject should do now. `back`: the reach is final, the hand returns. `free`: no trials, reaches are shown as they are found. */
export type Step = 'free' | 'waiting' | 'ready' | 'go' | 'back' | 'resting' | 'finished';

/** A scan of the rig. */
export interface At {
  readonly segment: number;
  readonly scan: number;
}

export interface Examination {
  readonly sessionId: string;
  readonly step: Step;
  readonly trial: number;
  readonly attempt: number;
  readonly of: number;
  readonly condition: string;
  readonly targetCm: number; // 0 without a target
  readonly nextCondition: string;
  readonly nextTargetCm: number;
  /** Of the subject, from the session's fields; undefined until a status arrived. */
  readonly armLengthCm: number | undefined;
  readonly goAt: At | undefined;
  readonly restEndsMs: number | undefined;
  /** The reach of the shown trial; without trials, the newest reach. */
  readonly reach: Reach | undefined;
  readonly movement: TrunkMovement | undefined;
  readonly expectedClass: number; // -1 if unknown
  /** The trial's result arrived and has no reach. */
  readonly isWithoutReach: boolean;
  /** The trial's result arrived, and scans of the trial are missing. */
  readonly hasGap: boolean;
  /** Counts changes of the session's record; the list of trials is loaded again after each. */
  readonly changes: number;
  /** Host time of the last event of a trial. */
  readonly lastEventNs: bigint;
  /** The state before the last redo or reject, for as long as that may be undone. */
  readonly beforeVoid: Examination | undefined;
}

export const noExamination: Examination = {
  sessionId: '',
  step: 'free',
  trial: 0,
  attempt: 0,
  of: 0,
  condition: '',
  targetCm: 0,
  nextCondition: '',
  nextTargetCm: 0,
  armLengthCm: undefined,
  goAt: undefined,
  restEndsMs: undefined,
  reach: undefined,
  movement: undefined,
  expectedClass: -1,
  isWithoutReach: false,
  hasGap: false,
  changes: 0,
  lastEventNs: 0n,
  beforeVoid: undefined,
};

/** Returns the target's distance in percent of the arm length, or nothing if one of them is unknown. */
export const targetPercent = (examination: Examination, targetCm: number): number | undefined =>
  examination.armLengthCm !== undefined && targetCm > 0 ? (100 * targetCm) / examination.armLengthCm : undefined;

const inSession = (examination: Examination, sessionId: string): Examination =>
  examination.sessionId === sessionId ? examination : { ...noExamination, sessionId, changes: examination.changes + 1 };

const newTrial = (examination: Examination, change: TrialChange): Examination => ({
  ...examination,
  step: 'ready',
  trial: change.trial,
  attempt: change.attempt,
  condition: change.condition,
  targetCm: change.targetCm ?? 0,
  goAt: undefined,
  restEndsMs: undefined,
});

/** Clears the result of the trial before; it stays on the screen until the next Go. */
const newReach = { reach: undefined, movement: undefined, expectedClass: -1, isWithoutReach: false, hasGap: false } as const;

const afterTrialChange = (examination: Examination, change: TrialChange, event: LiveEvent): Examination => {
  const known = inSession(examination, change.sessionId);
  // A tab opened during a trial receives only its last event, which also names the trial. The end of the plan (FINISHED) names none.
  const isSame = change.trial === 0 || (known.trial === change.trial && known.attempt === change.attempt);
  const named = isSame ? known : newTrial(known, change);
  const recorded = { ...named, changes: named.changes + 1 };
  switch (change.step) {
    case TrialEventKind.READY:
      return newTrial(known, change);
    case TrialEventKind.GO: {
      const goAt = { segment: event.event.segment, scan: Number(event.event.scan) };
      // A new subscription repeats the latest event: keep what was found since.
      const isRepeated = isSame && known.goAt?.segment === goAt.segment && known.goAt.scan === goAt.scan;
      return isRepeated ? known : { ...named, ...newReach, step: 'go', goAt };
    }
    case TrialEventKind.MEASURE:
      return { ...named, step: named.step === 'back' ? 'back' : 'go' };
    case TrialEventKind.REST:
      return { ...recorded, step: 'resting', restEndsMs: event.timeMs + 1000 * (change.restS ?? 0) };
    case TrialEventKind.FINISHED:
      return { ...recorded, step: 'finished', restEndsMs: undefined };
    case TrialEventKind.DONE:
    case TrialEventKind.ABORTED:
      return { ...recorded, step: named.step === 'finished' ? 'finished' : 'waiting' };
    case TrialEventKind.REDONE:
    case TrialEventKind.REJECTED:
      return { ...recorded, step: named.step === 'finished' ? 'finished' : 'waiting', beforeVoid: { ...named, beforeVoid: undefined } };
    case TrialEventKind.UNDONE:
      return { ...(known.beforeVoid ?? newTrial(known, change)), changes: known.changes + 1 };
    default:
      return examination;
  }
};

/** Returns whether a reach belongs to the trial: it must not begin before Go. */
const isOfTrial = (examination: Examination, reach: Reach, segment: number): boolean => {
  if (examination.step === 'free') return true;
  if (examination.goAt === undefined || reach.p1 === undefined) return false;
  return segment === examination.goAt.segment && Number(reach.p1.scan) >= examination.goAt.scan;
};

const afterReach = (examination: Examination, reach: Reach, segment: number): Examination => {
  if (reach.step === ReachStep.CANCELLED) {
    return examination.reach?.number === reach.number ? { ...examination, reach: undefined, movement: undefined } : examination;
  }
  if (!isOfTrial(examination, reach, segment)) return examination;
  const isWatched = examination.step === 'free' || examination.step === 'go' || examination.step === 'back';
  if (!isWatched) return examination;
  const isReplaced = examination.reach !== undefined && examination.reach.number !== reach.number;
  // The first reach after Go is the trial's. Later ones (the hand returning, small movements) are left to the trial's result.
  if (isReplaced && examination.step !== 'free' && examination.reach?.step === ReachStep.FINAL) return examination;
  const step = examination.step === 'go' && reach.step === ReachStep.FINAL ? 'back' : examination.step;
  return { ...examination, step, reach, movement: isReplaced ? undefined : examination.movement };
};

const afterResult = (examination: Examination, result: TrialResult): Examination => {
  const known = inSession(examination, result.sessionId);
  const changed = { ...known, changes: known.changes + 1 };
  if (known.trial !== result.trial || known.attempt !== result.attempt) return changed;
  const { reach, movement, expectedClass = -1, hasGap } = result;
  return { ...changed, reach, movement, expectedClass, isWithoutReach: reach === undefined, hasGap };
};

const notBefore = (examination: Examination, ns: bigint): Examination =>
  examination.lastEventNs >= ns ? examination : { ...examination, lastEventNs: ns };

/** Returns the state after an event of the rig. */
export const afterEvent = (examination: Examination, event: LiveEvent): Examination => {
  const { body, segment, hostTimeNs } = event.event;
  switch (body.case) {
    case 'trial': {
      const changed = afterTrialChange(examination, body.value, event);
      // After an undo the next status, whatever its time, says what the attempt does now.
      return body.value.step === TrialEventKind.UNDONE ? { ...changed, lastEventNs: 0n } : notBefore(changed, hostTimeNs ?? 0n);
    }
    case 'reach':
      return afterReach(examination, body.value, segment);
    case 'movement':
      return examination.reach?.number === body.value.number ? { ...examination, movement: body.value } : examination;
    case 'trialResult':
      return afterResult(examination, body.value);
    default:
      return examination;
  }
};

export const isRunning = (status: RigStatus | undefined): boolean => {
  const state = status?.session?.state;
  return state === SessionState.STARTING || state === SessionState.SETTLING || state === SessionState.RUNNING;
};

const stepOf: Partial<Record<TrialPhase, Step>> = {
  [TrialPhase.WAITING]: 'waiting',
  [TrialPhase.READY]: 'ready',
  [TrialPhase.SETTLING]: 'go',
  [TrialPhase.MEASURING]: 'go',
  [TrialPhase.RESTING]: 'resting',
  [TrialPhase.FINISHED]: 'finished',
};

const isDuringTrial = (step: Step): boolean => step === 'ready' || step === 'go' || step === 'back';

const afterSession = (examination: Examination, session: SessionInfo | undefined, isLater: boolean): Examination => {
  const isAnother = session !== undefined && session.sessionId !== '' && session.sessionId !== examination.sessionId;
  if (examination.step === 'free' || (isAnother && !isLater)) return examination;
  // The trials stay listed until the next session.
  return { ...examination, step: 'free', goAt: undefined, restEndsMs: undefined, changes: examination.changes + 1 };
};

/** Takes the state from the status, for a tab that was opened late or was too slow for an event. */
const caughtUp = (examination: Examination, status: TrialStatus): Examination => {
  const { step, trial, attempt } = examination;
  const isSame = trial === status.trial && attempt === status.attempt;
  const reported = stepOf[status.phase] ?? step;
  // A status does not say that the reach is final.
  if (isSame && (reported === step || (reported === 'go' && step === 'back'))) return examination;
  const caught = { ...examination, step: reported, restEndsMs: undefined, changes: examination.changes + 1 };
  if (isSame) return { ...caught, ...(reported === 'go' ? newReach : {}) };
  const { condition, targetCm = 0 } = status;
  const isResultShown = reported === 'ready'; // the result of the trial before
  return { ...caught, ...(isResultShown ? {} : newReach), trial: status.trial, attempt: status.attempt, condition, targetCm, goAt: undefined };
};

/** Returns the state after a status of host time `madeNs`: number of trials, next target, the end of the session, and what a lost event would have said. */
export const afterStatus = (examination: Examination, status: RigStatus | undefined, madeNs: bigint): Examination => {
  const session = status?.session;
  const isLater = includesEvent(madeNs, examination.lastEventNs);
  if (session === undefined || !isRunning(status)) return afterSession(examination, session, isLater);
  const known = inSession(examination, session.sessionId);
  const { trial } = session;
  if (trial === undefined) return known;
  const reported = stepOf[trial.phase] ?? known.step;
  // The end of a rest that waits for a command has no event.
  const waits = (known.step === 'resting' || known.step === 'waiting') && !isDuringTrial(reported);
  const isCatchingUp = known.step === 'free' || includesEvent(madeNs, known.lastEventNs);
  return {
    ...(isCatchingUp ? caughtUp(known, trial) : waits ? { ...known, step: reported } : known),
    of: trial.of,
    nextCondition: trial.nextCondition,
    nextTargetCm: trial.nextTargetCm ?? 0,
    armLengthCm: Number(session.fields['arm_length_cm']) || undefined,
  };
};
