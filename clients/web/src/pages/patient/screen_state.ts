// SPDX-License-Identifier: Apache-2.0
// What the patient screen shows. Pure functions of what is known, so that a screen that is opened in a trial shows the same as one that was open before.
import type { SessionInfo, StatusSnapshot, RigStatus } from '../../generated/dts/v1/control_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { isActive } from '../../parts/active';
import type { Step } from '../chair/examination';

/**
 * 'wait': before the first trial. 'middle': the person stands too near an edge. 'settle' and 'measure' are of the floor, 'go' and 'back' of the
 * chair. 'rest': between trials, whether a rest or the therapist decides when the next one begins.
 */
export type ScreenState = 'noData' | 'idle' | 'wait' | 'nobody' | 'middle' | 'ready' | 'settle' | 'measure' | 'go' | 'back' | 'rest' | 'done';

export interface Standing {
  readonly isOld: boolean; // no data for two seconds
  readonly session: SessionInfo | undefined;
  readonly isSomebody: boolean; // on the plate
  readonly isOffCentre: boolean;
}

export const standingState = ({ isOld, session, isSomebody, isOffCentre }: Standing): ScreenState => {
  if (isOld) return 'noData';
  if (!isActive(session)) return 'idle';
  const { trial } = session;
  const onPlate = (state: ScreenState): ScreenState => (isSomebody ? state : 'nobody');
  // Nobody should move the feet once it is measured: the trial would not be valid.
  const inMiddle = (state: ScreenState): ScreenState => onPlate(isOffCentre ? 'middle' : state);
  switch (trial?.phase) {
    case undefined: // a session without trials
      return onPlate('measure');
    case TrialPhase.READY:
      return inMiddle('ready');
    case TrialPhase.SETTLING:
      return inMiddle('settle');
    case TrialPhase.MEASURING:
      return onPlate('measure');
    case TrialPhase.RESTING:
      return 'rest';
    case TrialPhase.FINISHED:
      return 'done';
    default:
      return trial?.trial === 0 ? inMiddle('wait') : 'rest';
  }
};

export interface Sitting {
  readonly isOld: boolean;
  readonly isRunning: boolean; // a session
  readonly isSomebody: boolean; // on the chair
  readonly step: Step;
  readonly trial: number; // 0: before the first
}

export const sittingState = ({ isOld, isRunning, isSomebody, step, trial }: Sitting): ScreenState => {
  if (isOld) return 'noData';
  if (!isRunning) return 'idle';
  const onChair = (state: ScreenState): ScreenState => (isSomebody ? state : 'nobody');
  switch (step) {
    case 'free':
      return onChair('wait');
    case 'waiting':
      return trial === 0 ? onChair('wait') : 'rest';
    case 'ready':
      return onChair('ready');
    case 'resting':
      return 'rest';
    case 'finished':
      return 'done';
    default:
      return step;
  }
};

/** Returns the rig of the patient screen: the named one, else the one with trials or a session, else the first. A companion has no trials. */
export const patientRig = (status: StatusSnapshot | undefined, name: string | undefined): RigStatus | undefined => {
  const rigs = status?.rigs.filter(({ rig }) => rig?.kind === 'floor' || rig?.kind === 'chair') ?? [];
  if (name !== undefined) return rigs.find(({ rig }) => rig!.name === name);
  const active = rigs.filter(({ session }) => isActive(session));
  return active.find(({ session }) => session!.trial !== undefined) ?? active[0] ?? rigs[0];
};
