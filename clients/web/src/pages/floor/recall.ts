// SPDX-License-Identifier: Apache-2.0
// Results that this tab missed, because it was loaded later or was hidden. The catalogue has them.
import type { SessionInfo } from '../../generated/dts/v1/control_pb';
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { Sway } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { useAsked } from '../sessions/asking';
import { askSession } from '../sessions/session_detail';
import type { LiveFloor } from './live_floor';
import { isActive } from './session_controls';

/** One attempt at a trial of a session. */
export interface Attempt {
  readonly sessionId: string;
  readonly trial: number;
  readonly attempt: number;
}

const afterTrial = new Set([TrialPhase.WAITING, TrialPhase.RESTING, TrialPhase.FINISHED]);

/** Returns the attempt whose result should be shown between trials and is not. None after the session: the next person may be another one. */
export const missingResult = (session: SessionInfo | undefined, shown: Sway | undefined): Attempt | undefined => {
  if (!isActive(session) || session.trial === undefined || session.trial.trial === 0 || !afterTrial.has(session.trial.phase)) return undefined;
  const { sessionId } = session;
  const { trial, attempt } = session.trial;
  const isOfTrial = shown?.sessionId === sessionId && shown.trial === trial && shown.attempt === attempt;
  return isOfTrial && !shown.isPreliminary ? undefined : { sessionId, trial, attempt };
};

/** Returns the result of an attempt, or nothing if it has none or the trial was rejected. */
export const resultOf = (record: SessionRecord, { trial, attempt }: Attempt): Sway | undefined =>
  record.trials.filter((one) => one.trial === trial && one.attempt === attempt && one.outcome === 'done').at(-1)?.sway;

export const useRecalled = (link: Link, floor: LiveFloor, session: SessionInfo | undefined): void => {
  const missing = link.state.value === 'up' ? missingResult(session, floor.sway.value?.sway) : undefined;
  const key = missing === undefined ? '' : `${missing.sessionId} ${missing.trial} ${missing.attempt}`;
  useAsked(key, async (signal) => {
    if (missing === undefined) return;
    const sway = resultOf(await askSession(link, missing.sessionId), missing);
    if (sway !== undefined && !signal.aborted) floor.recall(sway);
  });
};
