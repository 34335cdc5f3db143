// SPDX-License-Identifier: Apache-2.0
// A ring that fills while a trial runs: grey while settling, coloured while measuring.
import type { JSX } from 'preact';

import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { SessionInfo } from '../../generated/dts/v1/control_pb';
import { SessionState } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { whole } from '../../parts/numbers';
import { useSinceS } from '../../parts/since';
import { strings } from '../../strings';

/** Parts of the ring, as shares of 1. */
export interface Shares {
  readonly settle: number;
  readonly done: number;
}

export interface Progress {
  readonly seconds: number;
  readonly words: string;
  /** Undefined if the duration is unknown, or there is none (manual stop). */
  readonly shares: Shares | undefined;
}

const ofRecording = ({ settleS = 0, durationS = 0, elapsedS = 0 }: SessionInfo, sinceS: number): Progress => {
  const doneS = elapsedS + sinceS;
  if (durationS <= 0) return { seconds: Math.floor(doneS), words: strings.floor.elapsed, shares: undefined };
  const leftS = Math.max(0, durationS - doneS);
  const totalS = settleS + durationS;
  return { seconds: Math.ceil(leftS), words: strings.floor.left, shares: { settle: settleS / totalS, done: 1 - leftS / totalS } };
};

/** Returns the progress of a session, `sinceS` after its status. Nothing if no time runs, or its length is unknown. */
export const progressOf = (session: SessionInfo, sinceS: number): Progress | undefined => {
  const { trial, state } = session;
  if (trial === undefined) return state === SessionState.RUNNING ? ofRecording(session, sinceS) : undefined;
  const { settleS, durationS, remainingS = 0 } = trial;
  const isSettling = trial.phase === TrialPhase.SETTLING;
  if ((!isSettling && trial.phase !== TrialPhase.MEASURING) || remainingS <= 0) return undefined;
  const leftS = Math.max(0, remainingS - sinceS);
  const [seconds, words] = [Math.ceil(leftS), isSettling ? strings.floor.settleLeft : strings.floor.left];
  if (durationS === undefined) return { seconds, words, shares: undefined };
  const totalS = settleS + durationS;
  const done = 1 - (isSettling ? leftS + durationS : leftS) / totalS;
  return { seconds, words, shares: { settle: settleS / totalS, done: Math.max(0, done) } };
};

const radius = 52;
const around = 2 * Math.PI * radius;

const arc = (name: string, from: number, to: number): JSX.Element => (
  <circle
    class={`ring-part ${name}`}
    cx="64"
    cy="64"
    r={radius}
    stroke-dasharray={`${Math.max(0, to - from) * around} ${around}`}
    stroke-dashoffset={-from * around}
    transform="rotate(-90 64 64)"
  />
);

export const Countdown = ({ link, session }: { link: Link; session: SessionInfo }): JSX.Element | null => {
  const progress = progressOf(session, useSinceS(link).value);
  if (progress === undefined) return null;
  const { seconds, words, shares } = progress;
  return (
    <div class="ring" data-testid="countdown" role="timer" aria-label={`${whole(seconds)} ${words}`}>
      <svg viewBox="0 0 128 128" aria-hidden="true">
        <circle class="ring-part ring-empty" cx="64" cy="64" r={radius} />
        {shares !== undefined && arc('ring-settle-all', 0, shares.settle)}
        {shares !== undefined && arc('ring-settle', 0, Math.min(shares.settle, shares.done))}
        {shares !== undefined && arc('ring-measure', shares.settle, shares.done)}
      </svg>
      <div class="ring-text">
        <span class="ring-seconds">{whole(seconds)}</span>
        <span class="ring-words">{words}</span>
      </div>
    </div>
  );
};
