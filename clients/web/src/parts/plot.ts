// SPDX-License-Identifier: Apache-2.0
// uPlot in the colours of the theme, as large as its container. It draws when a page calls draw(), never by a timer.
import { effect } from '@preact/signals';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';

import type { Colours } from './canvas';
import { colours, fontFamily } from './canvas';

export interface Plot {
  /** Draws points within the given ranges; null in the data breaks a line. */
  draw(data: uPlot.AlignedData, x: readonly [number, number], y: readonly [number, number]): void;
  /** Returns the width of the drawing in CSS pixels, for decimation. */
  width(): number;
  release(): void;
}

/** Returns an axis with labels of 16 px. */
export const axis = (present: Colours, more: uPlot.Axis = {}): uPlot.Axis => ({
  stroke: present.quiet,
  font: `16px ${fontFamily}`,
  labelFont: `16px ${fontFamily}`,
  grid: { stroke: present.grid, width: 1 },
  ticks: { stroke: present.grid, width: 1 },
  ...more,
});

export type PlotOptions = Omit<uPlot.Options, 'width' | 'height'>;

/** Opens a plot in `place`. `optionsIn` returns the options for given colours; it is called again when the theme changes. */
export const openPlot = (place: HTMLElement, optionsIn: (present: Colours) => PlotOptions): Plot => {
  let plot: uPlot | undefined;
  const size = (): { width: number; height: number } => ({ width: Math.max(50, place.clientWidth), height: Math.max(40, place.clientHeight) });
  const stopColours = effect(() => {
    const options = optionsIn(colours().value);
    const data = plot?.data ?? (options.series.map(() => []) as unknown as uPlot.AlignedData);
    plot?.destroy();
    plot = new uPlot({ legend: { show: false }, cursor: { show: false }, ...options, ...size() }, data, place);
  });
  const observer = new ResizeObserver(() => plot?.setSize(size()));
  observer.observe(place);
  return {
    draw: (data, x, y) => {
      plot?.batch(() => {
        plot?.setData(data, false);
        plot?.setScale('x', { min: x[0], max: x[1] });
        plot?.setScale('y', { min: y[0], max: y[1] });
      });
    },
    width: () => (plot?.bbox.width ?? 0) / (window.devicePixelRatio || 1),
    release: () => {
      observer.disconnect();
      stopColours();
      plot?.destroy();
    },
  };
};
