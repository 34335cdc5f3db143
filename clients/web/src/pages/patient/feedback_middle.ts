// SPDX-License-Identifier: Apache-2.0
import type { ScanRing } from '../../parts/scan_ring';
import type { LiveFloor } from '../floor/live_floor';
import { ap, ml } from '../floor/live_floor';

export interface Place {
  readonly mlMm: number;
  readonly apMm: number;
}

const meanOverMs = 1000;

/** Returns the mean place of the first whole second from `fromMs` on in which no scan is missing and a person is on the plate. Undefined before it is over. */
export const meanPlace = (ring: ScanRing, fromMs: number): Place | undefined => {
  let [mlSum, apSum, count, firstMs] = [0, 0, 0, NaN];
  for (let index = ring.indexAt(fromMs); index < ring.length; index += 1) {
    const [mlMm, apMm] = [ring.value(ml, index), ring.value(ap, index)];
    if (Number.isNaN(mlMm) || Number.isNaN(apMm)) {
      [mlSum, apSum, count, firstMs] = [0, 0, 0, NaN]; // a gap, or nobody
      continue;
    }
    if (count === 0) firstMs = ring.timeMs(index);
    else if (ring.timeMs(index) - firstMs >= meanOverMs) return { mlMm: mlSum / count, apMm: apSum / count };
    mlSum += mlMm;
    apSum += apMm;
    count += 1;
  }
  return undefined;
};

/**
 * The middle of the target in one attempt of a trial with feedback: the mean COP of the last second of settling. A person does not stand exactly in
 * the middle of the plate, and a target there would ask to lean. It never changes within the attempt, because a target that moves would ask to follow
 * it; so keep this object as long as the attempt, also while the screen shows no picture.
 */
export class FeedbackMiddle {
  #place: Place | undefined;
  #openedMs: number | undefined;
  readonly #floor: LiveFloor;
  readonly #sessionId: string;
  readonly #trial: number;
  readonly #attempt: number;

  constructor(floor: LiveFloor, sessionId: string, trial: number, attempt: number) {
    [this.#floor, this.#sessionId, this.#trial, this.#attempt] = [floor, sessionId, trial, attempt];
  }

  /** Ask only while the attempt is measured. A screen that was opened after the settling has not seen it: then the first second that it saw counts. */
  whileMeasured(): Place | undefined {
    const { ring, newestMs } = this.#floor;
    if (ring === undefined) return undefined;
    this.#openedMs ??= newestMs;
    const beganMs = this.#floor.measuredSinceMs(this.#sessionId, this.#trial, this.#attempt);
    return (this.#place ??= meanPlace(ring, beganMs === undefined ? this.#openedMs : beganMs - meanOverMs));
  }
}
