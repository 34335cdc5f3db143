// SPDX-License-Identifier: Apache-2.0
// Ages of the newest scan of a block when it arrives in this tab. Counts per millisecond, so that memory does not grow.
export const mostMs = 2000; // older scans count as this old

/** Upper ends of the bars in ms; one more bar has the rest. */
export const barEndsMs = [10, 20, 30, 40, 50, 75, 100, 150, 250, 500] as const;

export class LatencyCounts {
  private readonly counts = new Uint32Array(mostMs + 1);
  total = 0;

  /** Adds an age. One below zero comes from the error of the clock offset and counts as 0. */
  add(ageMs: number): void {
    if (!Number.isFinite(ageMs)) return;
    this.counts[Math.min(mostMs, Math.max(0, Math.floor(ageMs)))]! += 1;
    this.total += 1;
  }

  /** Returns the age in whole ms that a share of 1 stays within; Infinity beyond `mostMs`; NaN without ages. */
  quantileMs(share: number): number {
    let seen = 0;
    for (let ms = 0; ms <= mostMs; ms += 1) {
      seen += this.counts[ms]!;
      if (seen > 0 && seen >= share * this.total) return ms < mostMs ? ms + 1 : Number.POSITIVE_INFINITY;
    }
    return Number.NaN;
  }

  /** Returns the share of 1 of all blocks for each bar; one more than `barEndsMs`. */
  bars(): number[] {
    const bars = new Array<number>(barEndsMs.length + 1).fill(0);
    let bar = 0;
    for (let ms = 0; ms <= mostMs; ms += 1) {
      while (bar < barEndsMs.length && ms >= barEndsMs[bar]!) bar += 1;
      bars[bar]! += this.counts[ms]!;
    }
    return bars.map((count) => (this.total > 0 ? count / this.total : 0));
  }
}
