// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { whole } from '../../parts/numbers';
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

export interface Usefulness {
  readonly valid: number;
  readonly planned: number;
  readonly kind: 'all' | 'some' | 'none';
}

/** Returns how many of the planned trials are valid, or nothing without planned trials and during a session: then trials are still to come. */
export const usefulnessOf = (session: SessionRecord): Usefulness | undefined => {
  const planned = session.plannedTrials ?? 0;
  if (planned === 0 || session.state === 'running') return undefined;
  const valid = session.parts.reduce((sum, part) => sum + (part.validTrials ?? 0), 0);
  return { valid, planned, kind: valid === 0 ? 'none' : valid < planned ? 'some' : 'all' };
};

/**
 * The state of the recording and, as a second thing, how many trials are valid: a complete recording may be useless. Shape and word say it; the colour
 * is only in addition, and is green only if all trials are valid.
 */
export const StateMark = ({ session }: { session: SessionRecord }): JSX.Element => {
  const { state } = session;
  const { states, validTrials } = strings.sessions;
  const useful = usefulnessOf(session);
  const isWhole = useful === undefined || useful.kind === 'all';
  return (
    <>
      <span class={`state state-${state}${isWhole ? '' : ' state-not-whole'}`} data-testid="session-state">
        <span aria-hidden="true">{shapes[state] ?? '?'}</span> {states[state] ?? state}
      </span>
      {useful !== undefined && (
        <div class={`state-trials state-trials-${useful.kind}`} data-testid="valid-trials">
          {useful.kind !== 'all' && <span aria-hidden="true">{useful.kind === 'none' ? '✕ ' : '◐ '}</span>}
          {validTrials(whole(useful.valid), whole(useful.planned))}
        </div>
      )}
    </>
  );
};

/** "10,560 scans lost in 2 gaps": a complete session may have gaps. Nothing if it has none. */
export const LostScans = ({ session }: { session: SessionRecord }): JSX.Element | undefined => {
  const text = lossOfSession(session);
  if (text === '') return undefined;
  return (
    <div class="sessions-note" data-testid="lost-scans">
      {text}
    </div>
  );
};
