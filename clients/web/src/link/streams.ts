// SPDX-License-Identifier: Apache-2.0
// From a StreamBlock off the wire to a Block that pages may trust.
import type { StatusSnapshot } from '../generated/dts/v1/control_pb';
import type { Rate, StreamBlock, StreamFormat } from '../generated/dts/v1/stream_pb';
import type { HostClock } from './clock';
import type { Block } from './types';

// As libdts has them: what is beyond cannot have been meant.
const mostScans = 65536;
const mostChannels = 256;
const largestRateTerm = 1_000_000_000_000n;

interface Place {
  readonly instance: bigint;
  readonly segment: number;
  readonly nextScan: bigint | undefined; // undefined: what came since is not known
}

/** "floor/cop" in two; nothing, if it is no topic. */
export const splitTopic = (topic: string): { rig: string; name: string } | undefined => {
  const slash = topic.indexOf('/');
  if (slash <= 0 || slash === topic.length - 1 || topic.indexOf('/', slash + 1) >= 0) return undefined;
  return { rig: topic.slice(0, slash), name: topic.slice(slash + 1) };
};

const isProper = (rate: Rate | undefined): rate is Rate =>
  rate !== undefined &&
  rate.numerator > 0n &&
  rate.numerator <= largestRateTerm &&
  rate.denominator > 0n &&
  rate.denominator <= largestRateTerm;

/** Every count agrees with what is there: the peer is not believed, even our own one. */
export const isWellFormed = (block: StreamBlock): boolean =>
  block.instanceId !== 0n &&
  isProper(block.rate) &&
  block.scanCount > 0 &&
  block.scanCount <= mostScans &&
  block.channelCount > 0 &&
  block.channelCount <= mostChannels &&
  block.values.length === block.scanCount * block.channelCount &&
  block.quality.length === block.channelCount;

const columnsOf = (block: StreamBlock): Float32Array[] => {
  const columns: Float32Array[] = [];
  for (let channel = 0; channel < block.channelCount; channel += 1) {
    const column = new Float32Array(block.scanCount);
    const first = channel * block.scanCount;
    for (let scan = 0; scan < block.scanCount; scan += 1) column[scan] = block.values[first + scan]!;
    columns.push(column);
  }
  return columns;
};

/** Checks blocks, gives them times and formats, and knows per stream what is missing. */
export class Streams {
  readonly #clock: HostClock;
  #formats = new Map<string, StreamFormat>();
  #places = new Map<string, Place>();

  constructor(clock: HostClock) {
    this.#clock = clock;
  }

  /** Formats come with the status; a block of a stream that it does not name is refused. */
  learn(status: StatusSnapshot): void {
    this.#formats = new Map();
    for (const rig of status.rigs) {
      for (const format of rig.rig?.streams ?? []) this.#formats.set(`${rig.rig?.name}/${format.name}`, format);
    }
  }

  /**
   * What comes next counts as the first after a subscription: nothing is missing before it. Where it belongs is remembered, or curves would be
   * joined across a restart of the daemon.
   */
  forget(): void {
    for (const [topic, place] of this.#places) this.#places.set(topic, { ...place, nextScan: undefined });
  }

  /** Nothing: malformed, of an unknown stream, or a repetition. */
  take(topic: string, block: StreamBlock): Block | undefined {
    const parts = splitTopic(topic);
    const format = this.#formats.get(topic);
    if (parts === undefined || format === undefined || !this.#clock.isKnown) return undefined;
    if (!isWellFormed(block) || format.channels.length !== block.channelCount) return undefined;
    const before = this.#places.get(topic);
    const isSameSegment = before !== undefined && before.instance === block.instanceId && before.segment === block.segment;
    const dueScan = isSameSegment ? before.nextScan : 0n;
    if (isSameSegment && dueScan !== undefined && block.firstScan < dueScan) return undefined;
    this.#places.set(topic, {
      instance: block.instanceId,
      segment: block.segment,
      nextScan: block.firstScan + BigInt(block.scanCount),
    });
    const rateHz = Number(block.rate!.numerator) / Number(block.rate!.denominator);
    const timeMs = this.#clock.toBrowserMs(block.hostTimeNs);
    return {
      topic,
      rig: parts.rig,
      stream: parts.name,
      format,
      segment: block.segment,
      firstScan: Number(block.firstScan),
      scanCount: block.scanCount,
      rateHz,
      timeMs,
      newestMs: timeMs + (1000 * (block.scanCount - 1)) / rateHz,
      columns: columnsOf(block),
      quality: block.quality,
      // How long the segment before became is not known here: of a new one, what is missing is at least its own beginning.
      missingScans: before?.nextScan === undefined || dueScan === undefined ? 0 : Number(block.firstScan - dueScan),
      isNewSegment: before !== undefined && !isSameSegment,
    };
  }
}
