// SPDX-License-Identifier: Apache-2.0
// What the page measures while it is open: sensors, ages, gaps.
import type { ReadonlySignal } from '@preact/signals';
import { useComputed, useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';

import type { RigStatus } from '../../generated/dts/v1/control_pb';
import type { Gap } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { LatencyCounts } from './latency';
import type { ChannelSecond } from './second_statistics';
import { SecondStatistics } from './second_statistics';

const updateEveryMs = 1000;
const mostGaps = 20;

export interface SeenGap {
  readonly atMs: number; // Date.now()
  readonly gap: Gap;
}

export interface Seconds {
  readonly raw: readonly ChannelSecond[];
  readonly deflection: readonly ChannelSecond[];
}

export interface Ages {
  readonly blocks: number;
  readonly medianMs: number;
  readonly p95Ms: number;
  readonly bars: readonly number[];
}

export interface Watched {
  readonly seconds: ReadonlySignal<Seconds>;
  readonly gaps: ReadonlySignal<readonly SeenGap[]>; // newest first
}

const noSeconds: Seconds = { raw: [], deflection: [] };

/** Returns sensor statistics and gaps of one rig. */
export const useWatched = (link: Link, rig: string): Watched => {
  const seconds = useSignal(noSeconds);
  const gaps = useSignal<readonly SeenGap[]>([]);
  useEffect(() => {
    const raw = new SecondStatistics();
    const deflection = new SecondStatistics();
    let updatedMs = 0;
    const stops = [
      link.subscribe([`${rig}/raw`, `${rig}/deflection`, `${rig}/gap`]),
      link.onBlock(`${rig}/raw`, (block) => raw.push(block)),
      link.onBlock(`${rig}/deflection`, (block) => deflection.push(block)),
      link.onEvent(`${rig}/gap`, ({ event }) => {
        if (event.body.case === 'gap') gaps.value = [{ atMs: Date.now(), gap: event.body.value }, ...gaps.peek()].slice(0, mostGaps);
      }),
      link.onPaint((nowMs) => {
        if (nowMs - updatedMs < updateEveryMs) return;
        updatedMs = nowMs;
        seconds.value = { raw: raw.channels, deflection: deflection.channels };
      }),
    ];
    return () => stops.forEach((stop) => stop());
  }, [link, rig]);
  return { seconds, gaps };
};

/** Returns the stream that the live page of this rig draws: its age is what a therapist sees. */
const liveStream = (rig: RigStatus): string | undefined =>
  ['cop', 'transient'].find((stream) => rig.rig?.published.includes(stream)) ?? rig.rig?.published[0];

/** Returns the ages of all rigs' live streams since the page was opened. */
export const useAges = (link: Link): ReadonlySignal<Ages> => {
  const ages = useSignal<Ages>({ blocks: 0, medianMs: Number.NaN, p95Ms: Number.NaN, bars: [] });
  const topics = useComputed(() =>
    (link.status.value?.rigs ?? []).flatMap((rig) => {
      const stream = liveStream(rig);
      return rig.rig === undefined || stream === undefined ? [] : [`${rig.rig.name}/${stream}`];
    }).join(' '),
  ).value;
  useEffect(() => {
    const counts = new LatencyCounts();
    let updatedMs = 0;
    const names = topics.split(' ').filter((topic) => topic !== '');
    const stops = [
      link.subscribe(names),
      ...names.map((topic) => link.onBlock(topic, (block) => counts.add(performance.now() - block.newestMs))),
      link.onPaint((nowMs) => {
        if (nowMs - updatedMs < updateEveryMs) return;
        updatedMs = nowMs;
        ages.value = { blocks: counts.total, medianMs: counts.quantileMs(0.5), p95Ms: counts.quantileMs(0.95), bars: counts.bars() };
      }),
    ];
    return () => stops.forEach((stop) => stop());
  }, [link, topics]);
  return ages;
};
