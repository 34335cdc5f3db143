// SPDX-License-Identifier: Apache-2.0
// How a trial ended: one word and one shape for each way, the same in banner, trial list and status line.
import type { JSX } from 'preact';

import type { TrialRecord, TrialStatus } from '../generated/dts/v1/sessions_pb';
import { TrialFault, TrialOutcome } from '../generated/dts/v1/sessions_pb';
import { strings } from '../strings';

export type Outcome = keyof typeof strings.common.outcomes;

const faults: Readonly<Record<number, Outcome>> = {
  [TrialFault.STEPPED_OFF]: 'steppedOff',
  [TrialFault.FEET_MOVED]: 'feetMoved',
  [TrialFault.NO_REACH]: 'noReach',
  [TrialFault.NO_VALUES]: 'noValues',
};
const ends: Readonly<Record<number, Outcome>> = {
  [TrialOutcome.REDONE]: 'redone',
  [TrialOutcome.REJECTED]: 'rejected',
  [TrialOutcome.ABORTED]: 'aborted',
};
const voids: Readonly<Record<string, Outcome>> = { redone: 'redone', rejected: 'rejected', aborted: 'aborted' };

/** Returns how the newest attempt of a session ended, or nothing if none has ended. */
export const lastOutcome = ({ lastOutcome: end, lastFault }: TrialStatus): Outcome | undefined =>
  end === TrialOutcome.DONE ? (faults[lastFault] ?? 'done') : ends[end];

/** Returns how an attempt ended. A trial that a person has corrected to "done" is done, whatever the analysis found. */
export const outcomeOf = ({ outcome, fault, recordedOutcome }: TrialRecord): Outcome =>
  voids[outcome] ?? (recordedOutcome === '' ? (faults[fault] ?? 'done') : 'done');

const shapes: Readonly<Record<Outcome, string>> = {
  done: '✓',
  rejected: '✕',
  redone: '↻',
  aborted: '■',
  steppedOff: '!',
  feetMoved: '!',
  noReach: '!',
  noValues: '!',
};

export const outcomeShape = (outcome: Outcome): string => shapes[outcome];

/** "✕ rejected". */
export const OutcomeMark = ({ outcome }: { outcome: Outcome }): JSX.Element => (
  <span class={`outcome outcome-${outcome}`} data-outcome={outcome}>
    <span aria-hidden="true">{shapes[outcome]}</span> {strings.common.outcomes[outcome]}
  </span>
);
