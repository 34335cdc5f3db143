// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import { strings } from '../../strings';

const shapes: Readonly<Record<string, string>> = {
  running: '▶',
  complete: '●',
  incomplete: '◐',
  interrupted: '▲',
  recovered: '↻',
  aborted: '✕',
};

/** A shape and a word; the colour is a third. */
export const StateMark = ({ state }: { state: string }): JSX.Element => (
  <span class={`state state-${state}`} data-testid="session-state">
    <span aria-hidden="true">{shapes[state] ?? '?'}</span> {strings.sessions.states[state] ?? state}
  </span>
);
