// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { strings } from '../../strings';
import { lossOfSession } from './losses';

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

/** "10560 scans lost in 2 gaps": a session may be complete, and have gaps. Nothing when it has none. */
export const LostScans = ({ session }: { session: SessionRecord }): JSX.Element | undefined => {
  const text = lossOfSession(session);
  if (text === '') return undefined;
  return (
    <div class="sessions-note" data-testid="lost-scans">
      {text}
    </div>
  );
};
