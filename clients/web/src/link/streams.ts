// SPDX-License-Identifier: Apache-2.0
// From a received StreamBlock to a checked Block for pages.
import type { StatusSnapshot } from '../generated/dts/v1/control_pb';
import type { Rate, StreamBlock, StreamFormat } from '../generated/dts/v1/stream_pb';
import type { HostClock } from './clock';
import type { Block } from './types';

// The limits of libdts; larger values are errors.
const mostScans = 65536;
const mostChannels = 256;
const largestRateTerm = 1_000_000_000_000n;

interface Place {
  readonly instance: bigint;
  readonly segment: number;
  readonly nextScan: bigint | undefined; // undefined after a pause of the subscription
}

/** Splits "floor/cop" into rig and name. Returns nothing if it is not a topic. */
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

/** Checks that all counts match the data: even our own gateway is not trusted. */
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

/** Checks blocks, adds times and formats, and counts missing scans per stream. */
export class Streams {
  readonly #clock: HostClock;
  #formats = new Map<string, StreamFormat>();
  #places = new Map<string, Place>();

  constructor(clock: HostClock) {
    this.#clock = clock;
  }

  /** Takes the formats of all streams from a status. Blocks of other streams are rejected. */
  learn(status: StatusSnapshot): void {
    this.#formats = new Map();
    for (const rig of status.rigs) {
      for (const format of rig.rig?.streams ?? []) this.#formats.set(`${rig.rig?.name}/${format.name}`, format);
    }
  }

  /**
   * Treats the next block as the first after a subscription, with no missing scans before it. Instance and segment are kept: otherwise curves would be
   * joined across a restart of the daemon.
   */
  forget(): void {
    for (const [topic, place] of this.#places) this.#places.set(topic, { ...place, nextScan: undefined });
  }

  /** Returns the checked block, or nothing if it is malformed, repeated or of an unknown stream. */
  check(topic: string, block: StreamBlock): Block | undefined {
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
      // The length of the previous segment is unknown here; at least the beginning of the new one is missing.
      missingScans: before?.nextScan === undefined || dueScan === undefined ? 0 : Number(block.firstScan - dueScan),
      isNewSegment: before !== undefined && !isSameSegment,
    };
  }
}
