// SPDX-License-Identifier: Apache-2.0
// How old the newest scan of a block is when it arrives in this tab. Counts of milliseconds, so that it stays as small as it begins.
export const mostMs = 2000; // older ones are counted as this old

/** Upper ends of the histogram's bars in ms; the last one takes the rest. */
export const barEndsMs = [10, 20, 30, 40, 50, 75, 100, 150, 250, 500] as const;

export class LatencyCounts {
  private readonly counts = new Uint32Array(mostMs + 1);
  total = 0;

  /** An age below zero is the error of the clocks' offset. */
  add(ageMs: number): void {
    if (!Number.isFinite(ageMs)) return;
    this.counts[Math.min(mostMs, Math.max(0, Math.floor(ageMs)))]! += 1;
    this.total += 1;
  }

  /** Age that the share of 1 stays within, to the millisecond above; Infinity: beyond what is counted; NaN: nothing was. */
  quantileMs(share: number): number {
    let seen = 0;
    for (let ms = 0; ms <= mostMs; ms += 1) {
      seen += this.counts[ms]!;
      if (seen > 0 && seen >= share * this.total) return ms < mostMs ? ms + 1 : Number.POSITIVE_INFINITY;
    }
    return Number.NaN;
  }

  /** Shares of 1 of all blocks, by bar; one more than `barEndsMs`. */
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
