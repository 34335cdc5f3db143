// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

/** A name and its value. Tests compare the value with dtsctl by `testId`. */
export interface Fact {
  readonly name: string;
  readonly value: string;
  readonly testId?: string;
  /** Shown in bold with a sign, because it needs attention. */
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
