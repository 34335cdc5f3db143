// SPDX-License-Identifier: Apache-2.0
// A ring that fills while a trial runs: grey while settling, coloured while measuring.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { SessionInfo } from '../../generated/dts/v1/control_pb';
import { SessionState } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { whole } from '../../parts/numbers';
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

/** Durations of the phases of a session's trials. The status does not have them: they are learned from phases whose beginning this tab saw. */
export interface PhaseLengths {
  readonly sessionId: string;
  /** From the last status. */
  readonly elapsedS: number;
  readonly phase: TrialPhase;
  readonly attempt: string;
  readonly settleS: number | undefined;
  readonly measureS: number | undefined;
}

// A status arrives every second. If the previous one is older than this, the phase may have begun long before it was seen.
const seenBeginningS = 1.5;

export const learnLengths = (known: PhaseLengths | undefined, session: SessionInfo): PhaseLengths => {
  const { sessionId, elapsedS = 0, trial } = session;
  const phase = trial?.phase ?? TrialPhase.UNSPECIFIED;
  const remainingS = trial?.remainingS ?? 0;
  const attempt = `${trial?.trial ?? 0}.${trial?.attempt ?? 0}`;
  const before = known?.sessionId === sessionId ? known : undefined;
  const isNew = before !== undefined && (before.phase !== phase || before.attempt !== attempt);
  const hasBegun = isNew && elapsedS - before.elapsedS < seenBeginningS;
  const longest = (length: number | undefined): number => Math.max(length ?? 0, remainingS);
  let { settleS, measureS } = before ?? { settleS: undefined, measureS: undefined };
  if (hasBegun && phase === TrialPhase.SETTLING) settleS = longest(settleS);
  if (hasBegun && phase === TrialPhase.MEASURING) {
    measureS = longest(measureS);
    if (before.phase !== TrialPhase.SETTLING) settleS ??= 0; // the settling was too short to be seen
  }
  return { sessionId, elapsedS, phase, attempt, settleS, measureS };
};

const ofRecording = ({ settleS = 0, durationS = 0, elapsedS = 0 }: SessionInfo, sinceS: number): Progress => {
  const doneS = elapsedS + sinceS;
  if (durationS <= 0) return { seconds: Math.floor(doneS), words: strings.floor.elapsed, shares: undefined };
  const leftS = Math.max(0, durationS - doneS);
  const totalS = settleS + durationS;
  return { seconds: Math.ceil(leftS), words: strings.floor.left, shares: { settle: settleS / totalS, done: 1 - leftS / totalS } };
};

/** Returns the progress of a session, `sinceS` after its status. Nothing if no time runs, or its length is unknown. */
export const progressOf = (session: SessionInfo, { settleS, measureS }: PhaseLengths, sinceS: number): Progress | undefined => {
  const { trial, state } = session;
  const remainingS = trial?.remainingS ?? 0;
  if (trial === undefined) return state === SessionState.RUNNING ? ofRecording(session, sinceS) : undefined;
  const isSettling = trial.phase === TrialPhase.SETTLING;
  if ((!isSettling && trial.phase !== TrialPhase.MEASURING) || remainingS <= 0) return undefined;
  const leftS = Math.max(0, remainingS - sinceS);
  const [seconds, words] = [Math.ceil(leftS), isSettling ? strings.floor.settleLeft : strings.floor.left];
  if (settleS === undefined || measureS === undefined) return { seconds, words, shares: undefined };
  const totalS = settleS + measureS;
  const done = 1 - (isSettling ? leftS + measureS : leftS) / totalS;
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

const useSinceS = (link: Link): ReadonlySignal<number> => {
  const sinceS = useSignal(0);
  useEffect(() => {
    let atMs = performance.now();
    const stopStatus = link.status.subscribe(() => {
      atMs = performance.now();
      sinceS.value = 0;
    });
    let updatedMs = 0;
    const stopPaint = link.onPaint((nowMs) => {
      if (nowMs - updatedMs < 200) return;
      updatedMs = nowMs;
      // Without a new status the ring stops, like the data.
      sinceS.value = Math.min(2, Math.max(0, (nowMs - atMs) / 1000));
    });
    return () => {
      stopStatus();
      stopPaint();
    };
  }, [link]);
  return sinceS;
};

export const Countdown = ({ link, session }: { link: Link; session: SessionInfo }): JSX.Element | null => {
  const sinceS = useSinceS(link);
  const lengths = useRef<PhaseLengths>();
  lengths.current = learnLengths(lengths.current, session);
  const progress = progressOf(session, lengths.current, sinceS.value);
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
