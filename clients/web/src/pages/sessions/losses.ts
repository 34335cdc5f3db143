// SPDX-License-Identifier: Apache-2.0
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import type { LossCount } from '../../generated/dts/v1/stream_pb';
import { whole } from '../../parts/numbers';
import { strings } from '../../strings';

const { lostScans, inGaps, gaps } = strings.sessions.parts;

/** What all parts lost between their first scan and their last: "10600 scans lost in 3 gaps". Empty when there is no gap. */
export const lossOfSession = (session: SessionRecord): string => {
  const losses = session.parts.flatMap((part) => part.losses);
  const scans = losses.reduce((sum, loss) => sum + loss.lostScansTotal, 0n);
  const count = losses.reduce((sum, loss) => sum + loss.gapsTotal, 0n);
  return scans === 0n && count === 0n ? '' : inGaps(lostScans(whole(scans)), whole(count));
};

/** Of one part and reason: "2 gaps: unplugged, 40 scans lost". */
export const lossLine = (loss: LossCount): string => {
  const { gapReasons } = strings.health;
  return `${gaps(whole(loss.gapsTotal), gapReasons[loss.reason] ?? gapReasons[0] ?? '')}, ${lostScans(whole(loss.lostScansTotal))}`;
};
