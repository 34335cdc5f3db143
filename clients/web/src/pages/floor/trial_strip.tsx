// SPDX-License-Identifier: Apache-2.0
// The trials of the running session in one line: how each ended, which one runs, which are still planned.
import type { JSX } from 'preact';

import type { TrialRecord, TrialStatus } from '../../generated/dts/v1/sessions_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { whole } from '../../parts/numbers';
import type { Outcome } from '../../parts/outcomes';
import { outcomeOf, outcomeShape } from '../../parts/outcomes';
import { strings } from '../../strings';

const words = strings.floor.strip;
const mostShown = 12;

export interface StripTrial {
  readonly trial: number;
  readonly state: Outcome | 'now' | 'planned';
}

const during = new Set([TrialPhase.READY, TrialPhase.SETTLING, TrialPhase.MEASURING]);

/** Returns the trials of the plan, of a long one those around the present trial. The newest attempt counts. */
export const stripOf = ({ trial: present, of, phase }: TrialStatus, records: readonly TrialRecord[]): StripTrial[] => {
  const ended = new Map<number, Outcome>();
  for (const record of records) ended.set(record.trial, outcomeOf(record)); // in the order in which they ended
  const from = Math.max(1, Math.min(present - mostShown / 2, of - mostShown + 1));
  return Array.from({ length: Math.min(of, mostShown) }, (_, index) => {
    const trial = from + index;
    return { trial, state: trial === present && during.has(phase) ? 'now' : (ended.get(trial) ?? 'planned') };
  });
};

export const TrialStrip = ({ trial, records }: { trial: TrialStatus; records: readonly TrialRecord[] }): JSX.Element => (
  <ol class="trial-strip" aria-label={words.label} data-testid="trial-strip">
    {stripOf(trial, records).map(({ trial: number, state }) => {
      const word = state === 'now' ? words.now : state === 'planned' ? words.planned : strings.common.outcomes[state];
      return (
        <li key={number} class={`trial-chip trial-chip-${state}`} data-trial={number} data-outcome={state} title={words.trial(whole(number), word)}>
          <span class="visually-hidden">{words.trial(whole(number), word)}</span>
          <span aria-hidden="true">
            {whole(number)}
            {state !== 'now' && state !== 'planned' && ` ${outcomeShape(state)}`}
          </span>
        </li>
      );
    })}
  </ol>
);
