// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import { fixed, measured } from '../../parts/numbers';
import { qualityWords } from '../../parts/quality';
import { strings } from '../../strings';
import type { SensorRow, WorkingRange } from './sensors';

const barMm = 14; // a little more than the distance to any unloaded plate

/** The distance as a mark on a ruler that shows the working range. */
const DistanceBar = ({ mm, range }: { mm: number; range: WorkingRange | undefined }): JSX.Element => (
  <svg class="gap-bar" viewBox={`0 0 ${barMm * 10} 20`} preserveAspectRatio="none" aria-hidden="true">
    <rect class="gap-bar-all" x="0" y="7" width={barMm * 10} height="6" />
    {range !== undefined && <rect class="gap-bar-range" x={range.lowMm * 10} y="4" width={(range.highMm - range.lowMm) * 10} height="12" />}
    {Number.isFinite(mm) && <rect class="gap-bar-mark" x={Math.min(barMm, Math.max(0, mm)) * 10 - 1.5} y="0" width="3" height="20" />}
  </svg>
);

export const QualityText = ({ bits }: { bits: number }): JSX.Element => {
  const words = qualityWords(bits);
  return words.length === 0 ? (
    <span class="health-good">
      <span aria-hidden="true">✓</span> {strings.health.good}
    </span>
  ) : (
    <span class="health-doubt">
      <span aria-hidden="true">!</span> {words.join(', ')}
    </span>
  );
};

const { heads } = strings.health.sensors;

const Row = ({ row, range, rig }: { row: SensorRow; range: WorkingRange | undefined; rig: string }): JSX.Element => {
  const { sensor, volts } = row;
  const place = strings.health.sensors.place(fixed(sensor.xMm, 0), fixed(sensor.yMm, 0));
  return (
    <tr data-testid={`sensor-${rig}-${sensor.label}`}>
      <th scope="row" title={`${sensor.channel}, ${sensor.curve}`}>
        {sensor.label}
      </th>
      <td data-label={heads.place}>{place}</td>
      <td data-label={heads.volts} class="number" data-testid={`volts-${rig}-${sensor.label}`}>
        {fixed(volts?.mean, 3)}
      </td>
      <td data-label={heads.noise} class="number">
        {measured(volts === undefined ? undefined : 1000 * volts.noiseRms)}
      </td>
      <td data-label={heads.distance} class="number" data-testid={`gap-${rig}-${sensor.label}`}>
        {fixed(row.distanceMm, 2)}
      </td>
      <td data-label={heads.bar}>
        <DistanceBar mm={row.distanceMm} range={range} />
      </td>
      <td data-label={heads.quality}>
        {row.volts === undefined ? strings.common.undefinedValue : <QualityText bits={row.quality} />}
      </td>
    </tr>
  );
};

export const SensorTable = ({ rows, range, rig }: { rows: readonly SensorRow[]; range: WorkingRange | undefined; rig: string }): JSX.Element => {
  const { rangeOf } = strings.health.sensors;
  return (
    <table class="health-sensors stack" data-testid={`sensors-${rig}`}>
      <thead>
        <tr>
          <th>{heads.sensor}</th>
          <th>{heads.place}</th>
          <th class="number">{heads.volts}</th>
          <th class="number">{heads.noise}</th>
          <th class="number">{heads.distance}</th>
          <th>{range === undefined ? heads.bar : rangeOf(fixed(range.lowMm, 0), fixed(range.highMm, 0))}</th>
          <th>{heads.quality}</th>
        </tr>
      </thead>
      <tbody>
        {rows.map((row) => (
          <Row key={row.sensor.label} row={row} range={range} rig={rig} />
        ))}
      </tbody>
    </table>
  );
};
