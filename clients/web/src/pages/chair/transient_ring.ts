// SPDX-License-Identifier: Apache-2.0
// The last seconds of the seat's transient, by scan of one segment. Memory is bounded; nothing is allocated while it runs.
import type { Block } from '../../link/types';

/** Lowest and highest value of each pixel column, NaN without a value. A line through them shows every peak at any zoom. */
export interface Envelope {
  readonly low: Float32Array;
  readonly high: Float32Array;
}

export const newEnvelope = (columns: number): Envelope => ({ low: new Float32Array(columns), high: new Float32Array(columns) });

export class TransientRing {
  private readonly values: Float32Array;
  private first = 0; // the oldest scan that may be stored
  private end = 0; // one beyond the newest scan
  segment = -1;
  rateHz = 0;

  constructor(private readonly capacity: number) {
    this.values = new Float32Array(capacity).fill(Number.NaN);
  }

  /** One beyond the newest scan. */
  get endScan(): number {
    return this.end;
  }

  get newest(): number {
    return this.end > this.first ? (this.values[(this.end - 1) % this.capacity] ?? Number.NaN) : Number.NaN;
  }

  /** Appends a block. Scans missing before it become NaN and are drawn as gaps. */
  push(block: Block): void {
    const column = block.columns[0];
    if (column === undefined) return;
    if (block.segment !== this.segment || block.isNewSegment || block.firstScan < this.end || block.firstScan - this.end > this.capacity) {
      this.segment = block.segment;
      this.first = block.firstScan;
      this.end = block.firstScan;
    }
    this.rateHz = block.rateHz;
    for (; this.end < block.firstScan; this.end += 1) this.values[this.end % this.capacity] = Number.NaN;
    for (let i = 0; i < block.scanCount; i += 1) this.values[(this.end + i) % this.capacity] = column[i] ?? Number.NaN;
    this.end += block.scanCount;
    this.first = Math.max(this.first, this.end - this.capacity);
  }

  at(scan: number): number {
    return scan >= this.first && scan < this.end ? (this.values[scan % this.capacity] ?? Number.NaN) : Number.NaN;
  }

  /** Fills `out` for `columns` equal parts of [fromScan, toScan). Parts without a stored scan become NaN. */
  decimate(fromScan: number, toScan: number, columns: number, out: Envelope): void {
    const scansPerColumn = (toScan - fromScan) / columns;
    for (let column = 0; column < columns; column += 1) {
      const begin = Math.floor(fromScan + column * scansPerColumn);
      const from = Math.max(this.first, begin);
      // At least one scan; otherwise a view finer than the data would have gaps.
      const to = Math.min(this.end, Math.max(begin + 1, Math.floor(fromScan + (column + 1) * scansPerColumn)));
      let low = Number.NaN;
      let high = Number.NaN;
      for (let scan = from; scan < to; scan += 1) {
        const value = this.values[scan % this.capacity]!;
        if (!(value >= low)) low = value === value ? value : low;
        if (!(value <= high)) high = value === value ? value : high;
      }
      out.low[column] = low;
      out.high[column] = high;
    }
  }

  /** Returns `count` means over `scansEach` scans each, from `fromScan`. */
  means(fromScan: number, scansEach: number, count: number): Float32Array {
    const out = new Float32Array(count);
    for (let i = 0; i < count; i += 1) {
      let sum = 0;
      for (let scan = fromScan + i * scansEach; scan < fromScan + (i + 1) * scansEach; scan += 1) sum += this.at(scan);
      out[i] = sum / scansEach; // NaN if scans are missing: a gap in the line
    }
    return out;
  }
}
