// SPDX-License-Identifier: Apache-2.0
// The decisions of the rig's steadiness model that a session has.
import type { SessionRecord, TrialRecord } from '../../generated/dts/v1/sessions_pb';
import type { SteadinessDecision } from '../../generated/dts/v1/stream_pb';
import { decisionLimits } from '../floor/decision_tile';

/** Returns the decision about a trial; nothing for a trial that was redone, rejected or aborted. */
export const keptDecision = (trial: TrialRecord): SteadinessDecision | undefined => (trial.outcome === 'done' ? trial.sway?.decision : undefined);

/** Returns what must stand below the decisions of a session, each sentence once; empty without a decision. */
export const decisionLimitsOf = (session: SessionRecord): readonly string[] => {
  const decisions = session.trials.map(keptDecision).filter((decision) => decision !== undefined);
  const lines = decisions.flatMap((decision) => decisionLimits(decision));
  return [...new Set(lines)];
};
