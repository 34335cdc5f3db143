// SPDX-License-Identifier: Apache-2.0
import type { Block } from '../link/types';

/**
 * The newest scans of one stream with their times. Memory is bounded and allocated once. One NaN marks missing scans, so that a line breaks there.
 */
export class ScanRing {
  readonly capacity: number;
  readonly #times: Float64Array;
  readonly #columns: readonly Float32Array[];
  #next = 0;
  #length = 0;
  #total = 0;
  #newestMs = NaN;
  #segment = NaN;
  #nextScan = NaN;

  constructor(channels: number, capacity: number) {
    this.capacity = capacity;
    this.#times = new Float64Array(capacity);
    this.#columns = Array.from({ length: channels }, () => new Float32Array(capacity));
  }

  get length(): number {
    return this.#length;
  }

  /** Number of scans that were pushed before the one at index 0. */
  get firstNumber(): number {
    return this.#total - this.#length;
  }

  /** NaN if the ring is empty. */
  get newestMs(): number {
    return this.#newestMs;
  }

  clear(): void {
    this.#length = 0;
    this.#newestMs = NaN;
  }

  /** Appends a block; column i of the ring is channel `channels[i]` of the block. */
  push(block: Block, channels: readonly number[]): void {
    const periodMs = 1000 / block.rateHz;
    const dueMs = this.#newestMs + periodMs;
    if (!block.isNewSegment && block.segment === this.#segment && block.firstScan === this.#nextScan) {
      // The block follows the previous one. If its time does not, the clock offset has been measured better since: shift the stored times.
      if (Math.abs(block.timeMs - dueMs) > periodMs / 2) this.#shiftTimes(block.timeMs - dueMs);
    } else if (block.timeMs > this.#newestMs) {
      this.#append(dueMs, undefined, channels, 0);
    } else {
      this.clear(); // times went back: old and new scans cannot share one time axis
    }
    for (let scan = 0; scan < block.scanCount; scan += 1) this.#append(block.timeMs + scan * periodMs, block, channels, scan);
    this.#newestMs = block.newestMs;
    this.#segment = block.segment;
    this.#nextScan = block.firstScan + block.scanCount;
  }

  /** Returns the time of a scan; index 0 is the oldest. */
  timeMs(index: number): number {
    return this.#times[this.#slot(index)]!;
  }

  value(channel: number, index: number): number {
    return this.#columns[channel]![this.#slot(index)]!;
  }

  /** Returns the first index whose time is not before `timeMs`, or `length` if there is none. */
  indexAt(timeMs: number): number {
    let [low, high] = [0, this.#length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.timeMs(middle) < timeMs) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  #shiftTimes(byMs: number): void {
    for (let slot = 0; slot < this.capacity; slot += 1) this.#times[slot]! += byMs;
  }

  #slot(index: number): number {
    return (this.#next - this.#length + index + this.capacity) % this.capacity;
  }

  #append(timeMs: number, block: Block | undefined, channels: readonly number[], scan: number): void {
    this.#times[this.#next] = timeMs;
    for (let column = 0; column < this.#columns.length; column += 1) {
      this.#columns[column]![this.#next] = block?.columns[channels[column]!]?.[scan] ?? NaN;
    }
    this.#next = (this.#next + 1) % this.capacity;
    this.#length = Math.min(this.#length + 1, this.capacity);
    this.#total += 1;
  }
}

/** The points of one channel for a plot: x and y of equal length; null breaks the line. */
export interface Line {
  readonly x: number[];
  readonly y: (number | null)[];
}

/**
 * Fills `line` with the points of a channel from `fromMs` on. With more than four points per pixel, keeps only the lowest and highest of each pixel,
 * in their order, so that no peak is lost. x is in seconds relative to `nowMs`. Allocates only if `line` has never been this long.
 */
export const decimate = (ring: ScanRing, channel: number, fromMs: number, nowMs: number, pixels: number, line: Line): void => {
  line.x.length = 0;
  line.y.length = 0;
  const put = (index: number): void => {
    const value = ring.value(channel, index);
    line.x.push((ring.timeMs(index) - nowMs) / 1000);
    line.y.push(Number.isNaN(value) ? null : value);
  };
  const first = ring.indexAt(fromMs);
  const perPixel = Math.ceil((ring.length - first) / Math.max(1, pixels));
  if (perPixel <= 4) {
    for (let index = first; index < ring.length; index += 1) put(index);
    return;
  }
  // Groups begin at multiples of their size, counted from the first scan ever; otherwise peaks would jump between groups as the picture moves.
  let end = first + perPixel - (ring.firstNumber + first) % perPixel;
  for (let start = first; start < ring.length; start = end, end += perPixel) putGroup(ring, channel, start, Math.min(end, ring.length), put);
};

const putGroup = (ring: ScanRing, channel: number, start: number, end: number, put: (index: number) => void): void => {
  let [least, greatest, gap] = [-1, -1, -1];
  for (let index = start; index < end; index += 1) {
    const value = ring.value(channel, index);
    if (Number.isNaN(value)) gap = index;
    else {
      if (least < 0 || value < ring.value(channel, least)) least = index;
      if (greatest < 0 || value > ring.value(channel, greatest)) greatest = index;
    }
  }
  if (least >= 0) put(Math.min(least, greatest));
  if (gap >= 0) put(gap);
  if (greatest !== least) put(Math.max(least, greatest));
};
