// SPDX-License-Identifier: Apache-2.0
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';

import type { Link } from '../link/types';

const mostS = 2; // without a new status, what counts down stops like the data

/** Returns the time since the last status arrived in s, updated about 5 times a second. */
export const useSinceS = (link: Link): ReadonlySignal<number> => {
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
      sinceS.value = Math.min(mostS, Math.max(0, (nowMs - atMs) / 1000));
    });
    return () => {
      stopStatus();
      stopPaint();
    };
  }, [link]);
  return sinceS;
};
