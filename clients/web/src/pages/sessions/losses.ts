// SPDX-License-Identifier: Apache-2.0
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import type { LossCount } from '../../generated/dts/v1/stream_pb';
import { whole } from '../../parts/numbers';
import { strings } from '../../strings';

const { lostScans, inGaps, gaps, lossesUnknown, atLeast } = strings.sessions.parts;

/**
 * Returns the losses of all parts, each between its first and last scan: "10,600 scans lost in 3 gaps". Returns "losses unknown" if they are unknown
 * for a part, and "" if there is no gap.
 */
export const lossOfSession = (session: SessionRecord): string => {
  const losses = session.parts.flatMap((part) => part.losses);
  const scans = losses.reduce((sum, loss) => sum + loss.lostScansTotal, 0n);
  const count = losses.reduce((sum, loss) => sum + loss.gapsTotal, 0n);
  const isUnknown = session.parts.some((part) => part.isLossUnknown);
  if (scans === 0n && count === 0n) return isUnknown ? lossesUnknown : '';
  const text = inGaps(lostScans(whole(scans)), whole(count));
  return isUnknown ? atLeast(text) : text;
};

/** Returns the losses of one part for one reason: "2 gaps: device unplugged, 40 scans lost". */
export const lossLine = (loss: LossCount): string => {
  const { gapReasons } = strings.health;
  return `${gaps(whole(loss.gapsTotal), gapReasons[loss.reason] ?? gapReasons[0] ?? '')}, ${lostScans(whole(loss.lostScansTotal))}`;
};
