// SPDX-License-Identifier: Apache-2.0
// From channels of streams to the sensors of a rig.
import type { SensorInfo } from '../../generated/dts/v1/control_pb';
import type { ChannelSecond } from './second_statistics';

/**
 * Returns the distance between plate and sensor. The deflection counts from the unloaded position (daemon/pipeline, stage linearise); a tare moves
 * that zero by 0.5 mm at most.
 */
export const distanceMm = (sensor: SensorInfo, deflectionMm: number): number => sensor.unloadedGapMm - deflectionMm;

export interface WorkingRange {
  readonly lowMm: number;
  readonly highMm: number;
}

/** Returns the working range by kind of rig, because the status does not have it: 7 to 12 mm for the floor's HOA1405. */
export const workingRange = (kind: string): WorkingRange | undefined => (kind === 'floor' ? { lowMm: 7, highMm: 12 } : undefined);

export interface SensorRow {
  readonly sensor: SensorInfo;
  readonly volts: ChannelSecond | undefined;
  readonly distanceMm: number; // NaN if unknown
  readonly quality: number;
}

/** Joins sensors and statistics: streams have one column per sensor, in the rig's order. */
export const sensorRows = (
  sensors: readonly SensorInfo[],
  raw: readonly ChannelSecond[],
  deflection: readonly ChannelSecond[],
): SensorRow[] =>
  sensors.map((sensor, index) => ({
    sensor,
    volts: raw[index],
    distanceMm: distanceMm(sensor, deflection[index]?.mean ?? Number.NaN),
    quality: (raw[index]?.quality ?? 0) | (deflection[index]?.quality ?? 0),
  }));
