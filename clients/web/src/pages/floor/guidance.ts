// SPDX-License-Identifier: Apache-2.0
// Chooses the state shown at the top of the page, with what to do.
import { SessionState, Quality } from '../../generated/dts/v1/stream_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { strings } from '../../strings';

export type GuidanceState = keyof typeof strings.floor.guidance | 'first';

export interface Situation {
  readonly isOld: boolean; // no data for two seconds
  readonly quality: number; // of the COP, bits of Quality
  readonly distanceMm: number; // of the COP from the plate's centre; NaN without a COP
  readonly plateMm: number; // shorter side of the plate
  readonly session: SessionState;
  readonly phase: TrialPhase;
  readonly trial: number; // running, or done last; 0: none yet
}

const ofPhase = (phase: TrialPhase, trial: number): GuidanceState | undefined => {
  switch (phase) {
    case TrialPhase.WAITING:
      return trial === 0 ? 'first' : 'done';
    case TrialPhase.READY:
      return 'ready';
    case TrialPhase.SETTLING:
      return 'settling';
    case TrialPhase.MEASURING:
      return 'measuring';
    case TrialPhase.RESTING:
      return 'resting';
    case TrialPhase.FINISHED:
      return 'finished';
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
      return ofPhase(situation.phase, situation.trial) ?? 'recording';
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
