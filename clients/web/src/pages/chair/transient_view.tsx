// SPDX-License-Identifier: Apache-2.0
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import type { Reach } from '../../generated/dts/v1/stream_pb';
import { ReachStep } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { colours, openSurface } from '../../parts/canvas';
import { fixed } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Examination } from './examination';
import type { Ghosts } from './ghosts';
import { TransientPicture } from './transient_picture';
import type { TransientRing } from './transient_ring';

const describedEveryMs = 1000;

const pointsInWords = (reach: Reach | undefined): string => {
  const { point, noPoints } = strings.chair.picture;
  if (reach === undefined) return noPoints;
  const isFinal = reach.step === ReachStep.FINAL;
  const points = [reach.p1, reach.p2, reach.p3].map((found, index) => ({ name: `P${index + 1}`, mm: found?.valueMm ?? Number.NaN }));
  const found = points.filter(({ mm }) => Number.isFinite(mm));
  return found.map(({ name, mm }) => point(name, fixed(mm, 2), isFinal)).join('; ');
};

/** Outside <Live>, so that old data do not dim it. */
export const Legend = (): JSX.Element => {
  const { legend } = strings.chair.picture;
  return (
    <ul class="chair-legend">
      <li class="chair-key-line">{legend.line}</li>
      <li class="chair-key-ghost">{legend.ghost}</li>
      <li class="chair-key-dip">{legend.dip}</li>
      <li class="chair-key-points">{legend.points}</li>
      <li class="chair-key-provisional">{legend.provisional}</li>
      <li class="chair-key-final">{legend.final}</li>
    </ul>
  );
};

interface TransientViewProps {
  link: Link;
  ring: TransientRing;
  ghosts: Ghosts;
  examination: ReadonlySignal<Examination>;
  isOld: boolean;
}

export const TransientView = ({ link, ring, ghosts, examination, isOld }: TransientViewProps): JSX.Element => {
  const back = useRef<HTMLCanvasElement>(null);
  const front = useRef<HTMLCanvasElement>(null);
  const description = useSignal('');
  useEffect(() => {
    if (back.current === null || front.current === null) return undefined;
    const repaint = (): void => picture?.paint(examination.peek(), colours().peek());
    let picture: TransientPicture | undefined;
    const below = openSurface(back.current, () => picture?.forget());
    const above = openSurface(front.current, () => repaint());
    picture = new TransientPicture(below, above, ring, ghosts);
    let describedMs = 0;
    const stop = link.onPaint((nowMs) => {
      repaint();
      if (nowMs - describedMs < describedEveryMs) return;
      describedMs = nowMs;
      description.value = strings.chair.picture.description(fixed(ring.newest, 2), pointsInWords(examination.peek().reach));
    });
    return () => {
      stop();
      below.release();
      above.release();
    };
  }, [link, ring, ghosts, examination]);
  const label = isOld ? strings.common.data.noData : description.value || strings.chair.picture.transient;
  return (
    <div class="chair-canvases" role="img" aria-label={label} data-testid="transient-picture">
      <canvas ref={back} aria-hidden="true" />
      <canvas ref={front} aria-hidden="true" />
    </div>
  );
};
