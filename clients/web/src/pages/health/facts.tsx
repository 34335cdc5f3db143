// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

/** A name and what is known; `testId` is for what a test compares with the command line. */
export interface Fact {
  readonly name: string;
  readonly value: string;
  readonly testId?: string;
  /** Worth a look: bold, and with a sign. */
  readonly isDoubtful?: boolean;
}

export const Facts = ({ facts }: { facts: readonly Fact[] }): JSX.Element => (
  <dl class="health-facts">
    {facts.map(({ name, value, testId, isDoubtful = false }) => (
      <div key={name} class={isDoubtful ? 'health-doubt' : ''}>
        <dt>{name}</dt>
        <dd data-testid={testId}>
          {isDoubtful && <span aria-hidden="true">! </span>}
          {value}
        </dd>
      </div>
    ))}
  </dl>
);
