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

/**
 * Returns the rigs that the patient screen may show: the one that its address names, else those with trials, else those that lead a session, else the
 * first. `shown`: the rig with a session that it showed last. It stays while it leads one: nobody must follow the task of another person.
 */
export const patientRigs = (status: StatusSnapshot | undefined, named: string | undefined, shown?: string): readonly RigStatus[] => {
  const rigs = status?.rigs.filter(({ rig }) => rig?.kind === 'floor' || rig?.kind === 'chair') ?? [];
  if (named !== undefined) return rigs.filter(({ rig }) => rig!.name === named);
  const leading = rigs.filter(({ rig, session }) => isActive(session) && (session!.rigs.length === 0 || session!.rigs[0] === rig!.name));
  const stays = leading.filter(({ rig }) => rig!.name === shown);
  if (stays.length > 0) return stays;
  const withTrials = leading.filter(({ session }) => session!.trial !== undefined);
  return withTrials.length > 0 ? withTrials : leading.length > 0 ? leading : rigs.slice(0, 1);
};
