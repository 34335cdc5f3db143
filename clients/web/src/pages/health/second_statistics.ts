// SPDX-License-Identifier: Apache-2.0
// Mean and noise of every channel of a stream, second by second. Only sums are stored.
import type { Block } from '../../link/types';

export interface ChannelSecond {
  readonly mean: number; // NaN without a value in that second
  readonly noiseRms: number; // about the mean
  readonly quality: number; // bits of Quality, or-ed
}

interface Sums {
  origin: number; // subtracted from every value: otherwise squares of volts would hide noise of millivolts
  sum: number;
  squares: number;
  count: number;
  quality: number;
}

const empty = (): Sums => ({ origin: 0, sum: 0, squares: 0, count: 0, quality: 0 });

const secondOf = ({ origin, sum, squares, count, quality }: Sums): ChannelSecond => {
  const offset = sum / count; // 0 / 0 is NaN
  return { mean: origin + offset, noiseRms: Math.sqrt(Math.max(0, squares / count - offset * offset)), quality };
};

export class SecondStatistics {
  private sums: Sums[] = [];
  private scans = 0;
  /** Statistics of the last whole second. */
  channels: readonly ChannelSecond[] = [];

  push(block: Block): void {
    if (block.isNewSegment || this.sums.length !== block.columns.length) this.begin(block.columns.length);
    block.columns.forEach((column, channel) => this.add(this.sums[channel]!, column, block.quality[channel] ?? 0));
    this.scans += block.scanCount;
    if (this.scans < block.rateHz) return;
    this.channels = this.sums.map(secondOf);
    this.begin(block.columns.length);
  }

  private begin(channels: number): void {
    this.scans = 0;
    if (this.sums.length !== channels) this.sums = Array.from({ length: channels }, empty);
    for (const sums of this.sums) Object.assign(sums, empty());
  }

  private add(sums: Sums, column: Float32Array, quality: number): void {
    sums.quality |= quality;
    for (let scan = 0; scan < column.length; scan += 1) {
      const value = column[scan]!;
      if (!Number.isFinite(value)) continue;
      if (sums.count === 0) sums.origin = value;
      const apart = value - sums.origin;
      sums.sum += apart;
      sums.squares += apart * apart;
      sums.count += 1;
    }
  }
}
