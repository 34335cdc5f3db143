// SPDX-License-Identifier: Apache-2.0
// From channels of streams to the sensors of a rig, in words.
import type { SensorInfo } from '../../generated/dts/v1/control_pb';
import { strings } from '../../strings';
import type { ChannelSecond } from './second_statistics';

/** Words for bits of Quality; none: "good". */
export const qualityWords = (bits: number): string[] =>
  Object.entries(strings.health.quality)
    .filter(([bit]) => (bits & Number(bit)) !== 0)
    .map(([, word]) => word);

/**
 * Distance of plate and sensor: deflection is what the plate came down from its unloaded gap (daemon/pipeline, stage linearise). A tare moves
 * that zero by half a millimetre at most.
 */
export const gapMm = (sensor: SensorInfo, deflectionMm: number): number => sensor.unloadedGapMm - deflectionMm;

export interface WorkingRange {
  readonly lowMm: number;
  readonly highMm: number;
}

/** Of the sensors of that kind of rig, where the wire does not tell it: 7 to 12 mm for the floor's HOA1405. */
export const workingRange = (kind: string): WorkingRange | undefined => (kind === 'floor' ? { lowMm: 7, highMm: 12 } : undefined);

export interface SensorRow {
  readonly sensor: SensorInfo;
  readonly volts: ChannelSecond | undefined;
  readonly gapMm: number; // NaN: not known
  readonly quality: number;
}

/** Streams hold one column per sensor, in the rig's order. */
export const sensorRows = (
  sensors: readonly SensorInfo[],
  raw: readonly ChannelSecond[],
  deflection: readonly ChannelSecond[],
): SensorRow[] =>
  sensors.map((sensor, index) => ({
    sensor,
    volts: raw[index],
    gapMm: gapMm(sensor, deflection[index]?.mean ?? Number.NaN),
    quality: (raw[index]?.quality ?? 0) | (deflection[index]?.quality ?? 0),
  }));
