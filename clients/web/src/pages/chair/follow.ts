// SPDX-License-Identifier: Apache-2.0
// Keeps everything that the page of the chair shows up to date.
import type { ReadonlySignal } from '@preact/signals';
import { useComputed, useSignal, useSignalEffect } from '@preact/signals';
import { useEffect, useMemo } from 'preact/hooks';

import type { TrialRecord } from '../../generated/dts/v1/sessions_pb';
import { TrialEventKind } from '../../generated/dts/v1/stream_pb';
import type { Link, LiveEvent } from '../../link/types';
import type { Examination } from './examination';
import { afterEvent, afterStatus, noExamination } from './examination';
import { Ghosts } from './ghosts';
import { TransientRing } from './transient_ring';

const ringScans = 32_768; // 22 s at 1500 Hz: the longest trial and the rest before it

export interface Followed {
  readonly ring: TransientRing;
  readonly ghosts: Ghosts;
  readonly examination: ReadonlySignal<Examination>;
  /** Trials of the shown session, from the catalogue. */
  readonly trials: ReadonlySignal<readonly TrialRecord[]>;
  /** Whole seconds of rest left. */
  readonly restS: ReadonlySignal<number>;
}

/** Keeps the line of a done trial behind the next trials; drops that of a redone or rejected one. */
const keepLines = (ghosts: Ghosts, ring: TransientRing, before: Examination, { event }: LiveEvent): void => {
  if (event.body.case !== 'trial') return;
  const { step, sessionId, trial, condition } = event.body.value;
  ghosts.begin(sessionId);
  if (step === TrialEventKind.DONE && before.goAt !== undefined && before.trial === trial) ghosts.keep(trial, condition, before.goAt, ring);
  if (step === TrialEventKind.REDONE || step === TrialEventKind.REJECTED) ghosts.drop(trial);
};

const none: readonly TrialRecord[] = [];

/** Loads the trials from the catalogue after each change: the tab itself may have missed earlier ones. */
const useTrials = (link: Link, examination: ReadonlySignal<Examination>): ReadonlySignal<readonly TrialRecord[]> => {
  const answered = useSignal<{ readonly sessionId: string; readonly trials: readonly TrialRecord[] }>({ sessionId: '', trials: [] });
  const sessionId = useComputed(() => examination.value.sessionId);
  const changes = useComputed(() => examination.value.changes);
  useSignalEffect(() => {
    const asked = sessionId.value;
    if (asked === '' || changes.value < 0 || link.state.value !== 'up') return undefined;
    let isWanted = true;
    const request = { sessionId: asked };
    link.send({ case: 'showSession', value: request }).then(
      (answer) => {
        if (isWanted && answer.case === 'sessionRecord') answered.value = { sessionId: asked, trials: answer.value.trials };
      },
      () => undefined, // asked again after the next trial; the status line shows a lost connection
    );
    return () => {
      isWanted = false;
    };
  });
  // Until the catalogue answers, a new session shows no trials: those of the session before are not its own.
  return useComputed(() => (answered.value.sessionId === sessionId.value ? answered.value.trials : none));
};

export const useFollowed = (link: Link, rig: string): Followed => {
  const ring = useMemo(() => new TransientRing(ringScans), [rig]);
  const ghosts = useMemo(() => new Ghosts(), [rig]);
  const examination = useSignal(noExamination);
  const restS = useSignal(0);
  useEffect(() => {
    const topic = `${rig}/transient`;
    const stops = [
      link.subscribe([topic, ...['trial', 'reach', 'class', 'session', 'marker', 'gap', 'device'].map((name) => `${rig}/${name}`)]),
      link.onBlock(topic, (block) => ring.push(block)),
      link.onEvent(`${rig}/`, (event) => {
        keepLines(ghosts, ring, examination.peek(), event);
        examination.value = afterEvent(examination.peek(), event);
      }),
      link.onPaint((nowMs) => {
        const endsMs = examination.peek().restEndsMs;
        restS.value = endsMs === undefined ? 0 : Math.max(0, Math.ceil((endsMs - nowMs) / 1000));
      }),
    ];
    return () => stops.forEach((stop) => stop());
  }, [link, rig]);
  useSignalEffect(() => {
    const status = link.status.value;
    const own = status?.rigs.find((one) => one.rig?.name === rig);
    examination.value = afterStatus(examination.peek(), own, status?.hostTimeNs ?? 0n);
  });
  return { ring, ghosts, examination, trials: useTrials(link, examination), restS };
};
