// SPDX-License-Identifier: Apache-2.0
// Where an examination of the reaching task stands, folded from the rig's events (at once) and its status (once a second): pure functions over
// one value, so that what the therapist is told can be tested without a screen.
import { SessionState, ReachStep, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import type { Reach, TrialChange, TrialResult, TrunkMovement } from '../../generated/dts/v1/stream_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { TrialStatus } from '../../generated/dts/v1/sessions_pb';
import type { RigStatus, SessionInfo } from '../../generated/dts/v1/control_pb';
import type { LiveEvent } from '../../link/types';

/** What the subject is to do, or waits for. `back`: the reach is final, the hand goes back; `free`: no examination, reaches are shown as they come. */
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
  readonly targetCm: number; // 0: none
  readonly nextCondition: string;
  readonly nextTargetCm: number;
  /** Of the subject, by the session's fields; undefined until the status told them. */
  readonly armLengthCm: number | undefined;
  readonly goAt: At | undefined;
  readonly restEndsMs: number | undefined;
  /** Of the trial shown, or without an examination the newest one. */
  readonly reach: Reach | undefined;
  readonly movement: TrunkMovement | undefined;
  readonly expectedClass: number; // -1: not known
  /** Its result came and had no reach. */
  readonly isWithoutReach: boolean;
  /** Counts what changes the record of the session: whoever lists its trials asks again. */
  readonly changes: number;
  /** When the last event of a trial happened, by the host's clock. */
  readonly toldNs: bigint;
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
  changes: 0,
  toldNs: 0n,
};

/** The target's distance in percent of the arm length. */
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

/** What came of the trial before stays to be read until now. */
const newReach = { reach: undefined, movement: undefined, expectedClass: -1, isWithoutReach: false } as const;

const afterTrialChange = (examination: Examination, change: TrialChange, event: LiveEvent): Examination => {
  const known = inSession(examination, change.sessionId);
  // A tab opened in the middle of a trial is told its last event only, which names the trial as well.
  // The end of the plan names none.
  const isSame = change.trial === 0 || (known.trial === change.trial && known.attempt === change.attempt);
  const named = isSame ? known : newTrial(known, change);
  const recorded = { ...named, changes: named.changes + 1 };
  switch (change.step) {
    case TrialEventKind.READY:
      return newTrial(known, change);
    case TrialEventKind.GO: {
      const goAt = { segment: event.event.segment, scan: Number(event.event.scan) };
      // The latest event comes again when the tab subscribes anew: what was found since is not lost.
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
    case TrialEventKind.REDONE:
    case TrialEventKind.REJECTED:
    case TrialEventKind.ABORTED:
      return { ...recorded, step: named.step === 'finished' ? 'finished' : 'waiting' };
    default:
      return examination;
  }
};

/** A reach that began before "Go" is none of the trial's. */
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
  // The first reach after "Go" is the answer to it; what follows (the hand going back, a fidget) is the trial result's to judge.
  if (isReplaced && examination.step !== 'free' && examination.reach?.step === ReachStep.FINAL) return examination;
  const step = examination.step === 'go' && reach.step === ReachStep.FINAL ? 'back' : examination.step;
  return { ...examination, step, reach, movement: isReplaced ? undefined : examination.movement };
};

const afterResult = (examination: Examination, result: TrialResult): Examination => {
  const known = inSession(examination, result.sessionId);
  const changed = { ...known, changes: known.changes + 1 };
  if (known.trial !== result.trial || known.attempt !== result.attempt) return changed;
  const { reach, movement, expectedClass = -1 } = result;
  return { ...changed, reach, movement, expectedClass, isWithoutReach: reach === undefined };
};

const notBefore = (examination: Examination, ns: bigint): Examination =>
  examination.toldNs >= ns ? examination : { ...examination, toldNs: ns };

/** What an event of the rig makes of it. */
export const told = (examination: Examination, event: LiveEvent): Examination => {
  const { body, segment, hostTimeNs } = event.event;
  switch (body.case) {
    case 'trial':
      return notBefore(afterTrialChange(examination, body.value, event), hostTimeNs ?? 0n);
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

// A status may have been made just before an event that came before it. One this much younger than the last event knows of it: what it says
// then and nobody told is an event that got lost.
const statusLagNs = 1_000_000_000n;

const afterSession = (examination: Examination, session: SessionInfo | undefined, isYoung: boolean): Examination => {
  const isAnother = session !== undefined && session.sessionId !== '' && session.sessionId !== examination.sessionId;
  if (examination.step === 'free' || (isAnother && !isYoung)) return examination;
  // The trials stay listed until the next examination.
  return { ...examination, step: 'free', goAt: undefined, restEndsMs: undefined, changes: examination.changes + 1 };
};

/** As the status has it: for a tab that came late, or was too slow for an event. */
const caughtUp = (examination: Examination, status: TrialStatus): Examination => {
  const { step, trial, attempt } = examination;
  const isSame = trial === status.trial && attempt === status.attempt;
  const told = stepOf[status.phase] ?? step;
  // A status does not know that the reach is final.
  if (isSame && (told === step || (told === 'go' && step === 'back'))) return examination;
  const caught = { ...examination, step: told, restEndsMs: undefined, changes: examination.changes + 1 };
  if (isSame) return { ...caught, ...(told === 'go' ? newReach : {}) };
  const { condition } = status;
  const isStillRead = told === 'ready'; // what came of the trial before
  return { ...caught, ...(isStillRead ? {} : newReach), trial: status.trial, attempt: status.attempt, condition, targetCm: 0, goAt: undefined };
};

/** What the status, made at `madeNs` of the host's clock, adds: counts and the next target, what no event told, and the end of the session. */
export const seen = (examination: Examination, status: RigStatus | undefined, madeNs: bigint): Examination => {
  const session = status?.session;
  const isYoung = madeNs - examination.toldNs > statusLagNs;
  if (session === undefined || !isRunning(status)) return afterSession(examination, session, isYoung);
  const known = inSession(examination, session.sessionId);
  const { trial } = session;
  if (trial === undefined) return known;
  const told = stepOf[trial.phase] ?? known.step;
  // The end of a rest that waits for a command has no event of its own.
  const waits = (known.step === 'resting' || known.step === 'waiting') && !isDuringTrial(told);
  const isCatchingUp = known.step === 'free' || madeNs - known.toldNs > statusLagNs;
  return {
    ...(isCatchingUp ? caughtUp(known, trial) : waits ? { ...known, step: told } : known),
    of: trial.of,
    nextCondition: trial.nextCondition,
    nextTargetCm: trial.nextTargetCm ?? 0,
    armLengthCm: Number(session.fields['arm_length_cm']) || undefined,
  };
};
