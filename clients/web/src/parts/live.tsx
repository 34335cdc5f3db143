// SPDX-License-Identifier: Apache-2.0
// Wraps every live picture: a frozen picture must never look alive.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';
import { useEffect } from 'preact/hooks';

import type { Link } from '../link/types';
import { strings } from '../strings';
import { asSentence } from './names';
import { clockTime, fixed, whole } from './numbers';

/** Old data must be reported within 2 s. With four checks a second the report comes after at most 1.75 s; the rest is spare for a busy computer. */
export const oldAfterMs = 1500;
const ageShownFromMs = 250;
const clinicAgeShownFromMs = 0; // between a clinic and the centre, no delay is the usual one

/**
 * Reports whether a rig's data are old, until the returned function is called. Uses the clock and not onPaint: on a busy computer the browser may
 * paint no frame for seconds, and then the picture is frozen.
 */
export const watchOld = (link: Pick<Link, 'lastBlockAt' | 'onTick'>, rig: string, report: (isOld: boolean) => void): (() => void) => {
  const openedMs = performance.now(); // a page that was just opened gets the same time for its first data
  return link.onTick((nowMs) => report(nowMs - Math.max(link.lastBlockAt(rig)?.atMs ?? 0, openedMs) > oldAfterMs));
};

/** Returns whether a rig's data are old: true within two seconds after the last data. */
export const useIsOld = (link: Link, rig: string): ReadonlySignal<boolean> => {
  const isOld = useSignal(false);
  useEffect(() => watchOld(link, rig, (is) => (isOld.value = is)), [link, rig]);
  return isOld;
};

const reasonOf = (link: Link, rig: string): string => {
  const { noGatewayHint, noDaemonHint } = strings.common.link;
  if (link.state.value === 'no-gateway' || link.state.value === 'connecting') return noGatewayHint;
  if (link.state.value === 'no-daemon') return noDaemonHint;
  const status = link.status.value?.rigs.find((one) => one.rig?.name === rig);
  return asSentence(status?.deviceMessage ?? '') || strings.common.data.reasonRig;
};

const ageText = (ageMs: number): string =>
  ageMs < 1000 ? strings.common.data.age(whole(ageMs)) : strings.common.data.ageInSeconds(fixed(ageMs / 1000, 1));

const useAge = (link: Link, rig: string): ReadonlySignal<number> => {
  const ageMs = useSignal(0);
  useEffect(() => {
    let newestMs = NaN;
    const stopBlocks = link.onBlock(`${rig}/`, (block) => (newestMs = newestMs > block.newestMs ? newestMs : block.newestMs));
    const stopTicks = link.onTick((nowMs) => {
      const shownFromMs = link.me.value.isFleet ? clinicAgeShownFromMs : ageShownFromMs;
      ageMs.value = nowMs - newestMs > shownFromMs ? nowMs - newestMs : 0;
    });
    return () => {
      stopBlocks();
      stopTicks();
    };
  }, [link, rig]);
  return ageMs;
};

/** Dims its children and shows "No data since" when the rig's data are old; shows the age of data that are late, and of a clinic's data always. */
export const Live = ({ link, rig, children }: { link: Link; rig: string; children: ComponentChildren }): JSX.Element => {
  const isOld = useIsOld(link, rig).value;
  const ageMs = useAge(link, rig).value;
  const last = link.lastBlockAt(rig);
  const { noDataYet, noDataSince } = strings.common.data;
  return (
    <div class={`live${isOld ? ' live-old' : ''}`}>
      <div class="live-picture">{children}</div>
      <div role="status" aria-live="polite">
        {isOld && (
          <div class="live-band" data-testid="no-data">
            <strong>{last === undefined ? noDataYet : noDataSince(clockTime(last.dateMs))}</strong>
            {reasonOf(link, rig)}
          </div>
        )}
      </div>
      {!isOld && ageMs > 0 && (
        <div class="live-age" data-testid="data-age">
          {ageText(ageMs)}
        </div>
      )}
    </div>
  );
};
