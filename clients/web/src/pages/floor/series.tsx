// SPDX-License-Identifier: Apache-2.0
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';
import type uPlot from 'uplot';

import type { Link } from '../../link/types';
import type { Colours } from '../../parts/canvas';
import { colours, fontFamily } from '../../parts/canvas';
import { fixed } from '../../parts/numbers';
import type { Plot, PlotOptions } from '../../parts/plot';
import { axis, openPlot } from '../../parts/plot';
import type { Line, ScanRing } from '../../parts/scan_ring';
import { decimate } from '../../parts/scan_ring';
import { strings } from '../../strings';
import type { LiveFloor } from './live_floor';
import { ap, ml, windowS } from './live_floor';

const words = strings.floor.series;
// 20 s over about 800 pixels: drawn more often, the picture would move by less than two pixels.
const drawEveryMs = 50;
const describeEveryMs = 1000;
const spans = [10, 20, 50, 100, 200, 500] as const;

interface Curve {
  readonly channel: number;
  readonly line: Line;
  readonly plot: Plot;
  /** Range of the line in mm; low > high if it has no value. */
  low: number;
  high: number;
}

/** Draws markers as flags: a vertical line and the text. */
const drawFlags = (plot: uPlot, floor: LiveFloor, nowMs: number, present: Colours): void => {
  const { ctx, bbox } = plot;
  const scale = window.devicePixelRatio || 1;
  ctx.save();
  ctx.strokeStyle = present.ink;
  ctx.fillStyle = present.ink;
  ctx.lineWidth = scale;
  ctx.font = `${16 * scale}px ${fontFamily}`;
  ctx.textAlign = 'left';
  ctx.textBaseline = 'top';
  for (const { timeMs, text } of floor.markers) {
    const seconds = (timeMs - nowMs) / 1000;
    if (seconds < -windowS) continue;
    const x = plot.valToPos(seconds, 'x', true);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.fillText(`⚑ ${text}`.slice(0, 24), x + 3 * scale, bbox.top);
  }
  ctx.restore();
};

const drawName = (plot: uPlot, name: string, present: Colours): void => {
  const { ctx, bbox } = plot;
  const scale = window.devicePixelRatio || 1;
  ctx.save();
  ctx.font = `${16 * scale}px ${fontFamily}`;
  ctx.textAlign = 'left';
  ctx.textBaseline = 'bottom';
  ctx.lineJoin = 'round';
  ctx.lineWidth = 5 * scale;
  ctx.strokeStyle = present.paper; // a halo, so that the curve does not cross the letters
  ctx.strokeText(name, bbox.left + 6 * scale, bbox.top + bbox.height - 2 * scale);
  ctx.fillStyle = present.ink;
  ctx.fillText(name, bbox.left + 6 * scale, bbox.top + bbox.height - 2 * scale);
  ctx.restore();
};

const pointsPerStroke = 64;

/** Replaces uPlot's own path: without a graphics card one long stroke with round joins takes 2.5 times as long as many short ones. */
const drawLine = (plot: uPlot, colour: string): void => {
  const { ctx, bbox, data, scales } = plot;
  const [x, y] = [data[0], data[1]!];
  const perSecond = bbox.width / (scales.x!.max! - scales.x!.min!);
  const zero = bbox.left - scales.x!.min! * perSecond;
  const [high, perMm] = [scales.y!.max!, bbox.height / (scales.y!.max! - scales.y!.min!)];
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.strokeStyle = colour;
  ctx.lineWidth = 2 * (window.devicePixelRatio || 1);
  ctx.lineJoin = 'bevel';
  for (let from = 0; from + 1 < x.length; from += pointsPerStroke) {
    ctx.beginPath();
    let isDown = false;
    for (let index = from; index < Math.min(from + pointsPerStroke + 1, x.length); index += 1) {
      const value = y[index];
      const [px, py] = [zero + x[index]! * perSecond, bbox.top + (high - (value ?? 0)) * perMm];
      if (typeof value === 'number' && isDown) ctx.lineTo(px, py);
      else if (typeof value === 'number') ctx.moveTo(px, py);
      isDown = typeof value === 'number';
    }
    ctx.stroke();
  }
  ctx.restore();
};

/** Keeps uPlot from rounding the ranges. */
const exactly = (_plot: uPlot, min: number, max: number): [number, number] => [min, max];

const optionsOf = (present: Colours, label: string, isLast: boolean, colour: string, flags: (plot: uPlot) => void): PlotOptions => ({
  padding: [10, 12, isLast ? 0 : 6, 0],
  scales: { x: { time: false, range: exactly }, y: { range: exactly } },
  axes: [
    axis(present, { show: isLast, size: 28, values: (_plot, ticks) => ticks.map((tick) => `${fixed(tick, 0)} ${words.seconds}`) }),
    axis(present, { size: 52, space: 26, values: (_plot, ticks) => ticks.map((tick) => fixed(tick, 0)) }),
  ],
  series: [{}, { paths: () => null, points: { show: false } }],
  hooks: { draw: [(plot) => drawLine(plot, colour), (plot) => drawName(plot, label, present), flags] },
});

const spanOf = ({ low, high }: Curve): number => (high > low ? high - low : 0);

/** Updates all curves to the last 20 s at the same instant. Returns one range in mm for all, so that the eye can compare them. */
const updateCurves = (curves: readonly Curve[], ring: ScanRing, nowMs: number): number => {
  for (const curve of curves) {
    decimate(ring, curve.channel, nowMs - 1000 * windowS, nowMs, curve.plot.width(), curve.line);
    [curve.low, curve.high] = [Infinity, -Infinity];
    for (const value of curve.line.y) {
      if (value === null) continue;
      curve.low = Math.min(curve.low, value);
      curve.high = Math.max(curve.high, value);
    }
  }
  const widest = Math.max(...curves.map(spanOf));
  return spans.find((one) => one >= 1.1 * widest) ?? spans[spans.length - 1]!;
};

const drawCurve = ({ line, plot, low, high }: Curve, spanMm: number): void => {
  const step = spanMm / 10; // the middle moves in steps: a slow creep would look like sway
  const middle = high >= low ? Math.round((low + high) / 2 / step) * step : 0;
  plot.draw([line.x, line.y], [-windowS, 0], [middle - spanMm / 2, middle + spanMm / 2]);
};

export const Series = ({ link, floor }: { link: Link; floor: LiveFloor }): JSX.Element => {
  const apPlace = useRef<HTMLDivElement>(null);
  const mlPlace = useRef<HTMLDivElement>(null);
  const described = useSignal('');
  useEffect(() => {
    let [updatedMs, paintedMs, describedMs, spanMm] = [0, 0, 0, spans[0] as number];
    let undrawn: Curve[] = [];
    const flags = (plot: uPlot): void => drawFlags(plot, floor, updatedMs, colours().peek());
    const open = (place: HTMLElement, channel: number, label: string, isLast: boolean, colour: keyof Colours): Curve => ({
      channel,
      line: { x: [], y: [] },
      plot: openPlot(place, (present) => optionsOf(present, label, isLast, present[colour], flags)),
      low: Infinity,
      high: -Infinity,
    });
    const curves = [open(apPlace.current!, ap, words.ap, false, 'blue'), open(mlPlace.current!, ml, words.ml, true, 'vermillion')];
    const stop = link.onPaint((nowMs) => {
      if (undrawn.length === 0 && nowMs - updatedMs >= drawEveryMs && floor.ring !== undefined) {
        updatedMs = nowMs;
        spanMm = updateCurves(curves, floor.ring, nowMs);
        undrawn = [...curves];
      }
      // One curve per frame keeps frames short. If frames are rare, both in one: otherwise they would show different instants.
      const atOnce = nowMs - paintedMs > 2 * drawEveryMs ? undrawn.length : 1;
      for (const curve of undrawn.splice(0, atOnce)) drawCurve(curve, spanMm);
      paintedMs = nowMs;
      if (nowMs - describedMs < describeEveryMs || floor.ring === undefined) return;
      describedMs = nowMs;
      const [apMm, mlMm] = curves.map(({ low, high }) => fixed(high - low, 1));
      described.value = words.described(apMm!, mlMm!);
    });
    return () => {
      stop();
      for (const curve of curves) curve.plot.release();
    };
  }, [link, floor]);
  return (
    <div class="series" role="img" aria-label={described.value || words.label} data-testid="series">
      <div class="series-plot" ref={apPlace} />
      <div class="series-plot series-last" ref={mlPlace} />
    </div>
  );
};
