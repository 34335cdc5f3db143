// SPDX-License-Identifier: Apache-2.0
// Lines over days or weeks. Each line has a colour and a pattern of dashes, so that the colour is only in addition.
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';
import type uPlot from 'uplot';

import type { Colours } from '../../parts/canvas';
import type { PlotOptions } from '../../parts/plot';
import { axis, openPlot } from '../../parts/plot';
import { day, measured } from '../../parts/numbers';

export interface PlotLine {
  readonly name: string;
  /** One value for each time; null: none. */
  readonly values: readonly (number | null)[];
}

const styles: readonly (readonly [keyof Colours, readonly number[]])[] = [
  ['blue', []],
  ['vermillion', [8, 4]],
  ['green', [2, 3]],
  ['orange', [12, 4, 2, 4]],
  ['sky', [16, 4]],
  ['grey', [4, 4]],
  ['ink', [2, 6]],
  ['quiet', [10, 3, 3, 3]],
];
export const mostLines = styles.length;

const optionsOf = (present: Colours, lines: number, unit: string): PlotOptions => ({
  padding: [10, 44, 0, 0],
  scales: { x: { time: true }, y: { auto: false } },
  axes: [
    axis(present, { space: 90, values: (_plot, ticks) => ticks.map((seconds) => day(BigInt(Math.round(seconds)) * 1_000_000_000n)) }),
    axis(present, { size: 70, label: unit, stroke: present.quiet, values: (_plot, ticks) => ticks.map((tick) => measured(tick)) }),
  ],
  series: [{}, ...styles.slice(0, lines).map(([colour, dash]) => ({ stroke: present[colour], width: 2, dash: [...dash], spanGaps: true, points: { show: false } }))],
});

/** A range that shows all values, and zero if it is near. */
export const rangeOf = (values: readonly (number | null)[]): readonly [number, number] => {
  const known = values.filter((value) => value !== null);
  if (known.length === 0) return [0, 1];
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const margin = high > low ? (high - low) / 20 : Math.abs(high) / 20 || 1;
  return [low >= 0 && low < (high - low) * 2 ? 0 : low - margin, high + margin];
};

/** `timesMs`: UTC, rising. */
export const LinePlot = (props: { timesMs: readonly number[]; lines: readonly PlotLine[]; unit: string; label: string; testId: string }): JSX.Element => {
  const place = useRef<HTMLDivElement>(null);
  const { timesMs, lines, unit } = props;
  useEffect(() => {
    const plot = openPlot(place.current!, (present) => optionsOf(present, lines.length, unit));
    const seconds = timesMs.map((ms) => ms / 1000);
    const margin = 43_200; // one point is no line: half a day on both sides
    plot.draw(
      [seconds, ...lines.map(({ values }) => [...values])] as unknown as uPlot.AlignedData,
      [(seconds[0] ?? 0) - margin, (seconds.at(-1) ?? 0) + margin],
      rangeOf(lines.flatMap(({ values }) => values)),
    );
    return () => plot.release();
  }, [timesMs, lines, unit]);
  return (
    <>
      <div class="fleet-plot" ref={place} role="img" aria-label={props.label} data-testid={props.testId} />
      {lines.length > 1 && (
        <ul class="fleet-legend">
          {lines.map(({ name }, index) => {
            const [colour, dash] = styles[index]!;
            return (
              <li key={name}>
                <svg width="40" height="12" aria-hidden="true">
                  <line class={`fleet-${colour}`} x1="0" y1="6" x2="40" y2="6" stroke-dasharray={dash.join(' ')} />
                </svg>
                {name}
              </li>
            );
          })}
        </ul>
      )}
    </>
  );
};
