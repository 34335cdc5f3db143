// SPDX-License-Identifier: Apache-2.0
// The record of the running session, and from it results that this tab missed, because it was loaded later or was hidden.
import type { ReadonlySignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';

import type { SessionInfo } from '../../generated/dts/v1/control_pb';
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { Sway } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { isActive } from '../../parts/active';
import type { Asked } from '../sessions/asking';
import { useAsked } from '../sessions/asking';
import { askSession } from '../sessions/session_detail';
import type { Attempt } from './attempt';
import { isSameAttempt } from './attempt';
import type { LiveFloor } from './live_floor';

const afterTrial = new Set([TrialPhase.WAITING, TrialPhase.RESTING, TrialPhase.FINISHED]);

/** Returns the attempt whose result should be shown between trials and is not. None after the session: the next person may be another one. */
export const missingResult = (session: SessionInfo | undefined, shown: Sway | undefined): Attempt | undefined => {
  if (!isActive(session) || session.trial === undefined || session.trial.trial === 0 || !afterTrial.has(session.trial.phase)) return undefined;
  const { sessionId } = session;
  const { trial, attempt } = session.trial;
  const present = { sessionId, trial, attempt };
  return isSameAttempt(shown, present) && shown?.isPreliminary === false ? undefined : present;
};

/** Returns the result of an attempt, or nothing if it has none or the trial was rejected. */
export const resultOf = (record: SessionRecord, { trial, attempt }: Attempt): Sway | undefined =>
  record.trials.filter((one) => one.trial === trial && one.attempt === attempt && one.outcome === 'done').at(-1)?.sway;

/** Changes whenever the session's record may have changed; empty without a session. */
const recordKey = (link: Link, session: SessionInfo | undefined, shown: Sway | undefined): string => {
  if (link.state.value !== 'up' || !isActive(session) || session.trial === undefined) return '';
  const { trial, attempt, phase, lastOutcome, lastFault, lastTrial, lastAttempt } = session.trial;
  const result = shown === undefined || shown.isPreliminary ? '' : `${shown.trial}.${shown.attempt}`;
  return [session.sessionId, trial, attempt, afterTrial.has(phase), lastOutcome, lastFault, lastTrial, lastAttempt, result].join(' ');
};

export const useRecord = (link: Link, floor: LiveFloor, session: SessionInfo | undefined): ReadonlySignal<Asked<SessionRecord>> => {
  const shown = floor.sway.value?.sway;
  const asked = useAsked(recordKey(link, session, shown), () => askSession(link, session?.sessionId ?? ''));
  const record = asked.value.answer;
  const missing = missingResult(session, shown);
  useEffect(() => {
    const sway = record === undefined || missing === undefined || record.sessionId !== missing.sessionId ? undefined : resultOf(record, missing);
    if (sway !== undefined) floor.recall(sway);
  }, [record, missing?.sessionId, missing?.trial, missing?.attempt]);
  return asked;
};
