// SPDX-License-Identifier: Apache-2.0
// Chooses the state shown at the top of the page, with what to do.
import { SessionState, Quality } from '../../generated/dts/v1/stream_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { Outcome } from '../../parts/outcomes';
import { strings } from '../../strings';

export type GuidanceState = keyof typeof strings.floor.guidance | 'first' | Outcome;

export interface Situation {
  readonly isOld: boolean; // no data for two seconds
  readonly quality: number; // of the COP, bits of Quality
  readonly distanceMm: number; // of the COP from the plate's centre; NaN without a COP
  readonly plateMm: number; // shorter side of the plate
  readonly session: SessionState;
  readonly phase: TrialPhase;
  readonly outcome: Outcome | undefined; // of the newest attempt that ended; undefined: none has ended
}

const ofPhase = (phase: TrialPhase, outcome: Outcome | undefined): GuidanceState | undefined => {
  switch (phase) {
    case TrialPhase.WAITING:
      return outcome ?? 'first';
    case TrialPhase.READY:
      return 'ready';
    case TrialPhase.SETTLING:
      return 'settling';
    case TrialPhase.MEASURING:
      return 'measuring';
    case TrialPhase.RESTING:
      return outcome === undefined || outcome === 'done' ? 'resting' : outcome;
    case TrialPhase.FINISHED:
      return outcome === undefined || outcome === 'done' ? 'finished' : outcome;
    default:
      return undefined;
  }
};

const ofSession = (situation: Situation): GuidanceState | undefined => {
  switch (situation.session) {
    case SessionState.STARTING:
      return 'starting';
    case SessionState.SETTLING:
      return 'settling';
    case SessionState.RUNNING:
      return ofPhase(situation.phase, situation.outcome) ?? 'recording';
    case SessionState.STOPPING:
      return 'stopping';
    case SessionState.FAILED:
      return 'failed';
    default:
      return undefined;
  }
};

/** Returns whether a person must stand still on the plate in this state. */
const needsPerson = (state: GuidanceState | undefined): boolean =>
  state === 'ready' || state === 'settling' || state === 'measuring' || state === 'recording' || state === 'starting';

export const guidanceOf = (situation: Situation): GuidanceState => {
  if (situation.isOld) return 'noData';
  const state = ofSession(situation);
  if (state !== undefined && !needsPerson(state)) return state;
  // Also with a person on the plate: nothing should be measured before a tare.
  if (state === undefined && (situation.quality & Quality.UNTARED) !== 0) return 'untared';
  if ((situation.quality & Quality.NO_CONTACT) !== 0 || Number.isNaN(situation.distanceMm)) return 'nobody';
  // Beyond a third of the way to the edge the estimate is worse (README, Accuracy), and a foot may hang over the edge.
  if (situation.distanceMm > situation.plateMm / 6) return 'offCentre';
  return state ?? 'standing';
};

/** Returns whether a state says how a trial ended. */
export const isEnded = (state: GuidanceState): state is Outcome => Object.hasOwn(strings.common.outcomes, state);
