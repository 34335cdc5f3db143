// SPDX-License-Identifier: Apache-2.0
import type { TrialRecord } from '../generated/dts/v1/sessions_pb';

// After a rejection the plan continues, so a rejected trial is not repeated either.
const ended = new Set(['done', 'rejected']);

/**
 * Returns the number of the trial that is next before any trial of this part of a session has begun: the daemon reports none then, and a resumed
 * session continues where its earlier parts ended. `records`: the trials of the session so far, of each trial the newest attempt last. Returns
 * nothing if all trials have ended, or if the records have not arrived.
 */
export const nextTrial = (of: number, records: readonly TrialRecord[] | undefined): number | undefined => {
  if (records === undefined) return undefined;
  const outcomes = new Map(records.map(({ trial, outcome }) => [trial, outcome])); // the newest attempt counts
  return Array.from({ length: of }, (_, index) => index + 1).find((trial) => !ended.has(outcomes.get(trial) ?? ''));
};
