// SPDX-License-Identifier: Apache-2.0
// The transient of the seat with P1, P2, P3, the rest before it, the dip and the earlier reaches to the same target. Two canvases: the lower one
// changes per trial, the upper one per frame.
import type { Reach, ReachPoint } from '../../generated/dts/v1/stream_pb';
import { ReachStep } from '../../generated/dts/v1/stream_pb';
import type { Colours, Surface } from '../../parts/canvas';
import { fontFamily } from '../../parts/canvas';
import { fixed } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Examination } from './examination';
import type { Ghosts } from './ghosts';
import { ghostTimeS } from './ghosts';
import type { Envelope, TransientRing } from './transient_ring';
import { newEnvelope } from './transient_ring';
import type { Range, TimeWindow } from './transient_scale';
import { fitRange, gridStep, timeWindow } from './transient_scale';

const margin = { left: 64, right: 16, top: 12, bottom: 48 };
const font = `16px ${fontFamily}`;
const bandSigmas = 2;
const leastBandMm = 0.05;

/** Level and spread of the rest before Go. */
interface Rest {
  readonly mean: number;
  readonly half: number;
}

export const restBefore = (ring: TransientRing, goScan: number): Rest | undefined => {
  const count = Math.round(ring.rateHz / 2);
  let sum = 0;
  let squares = 0;
  for (let scan = goScan - count; scan < goScan; scan += 1) {
    const value = ring.at(scan);
    sum += value;
    squares += value * value;
  }
  const mean = sum / count;
  if (!Number.isFinite(mean)) return undefined;
  const sigma = Math.sqrt(Math.max(0, squares / count - mean * mean));
  return { mean, half: Math.max(bandSigmas * sigma, leastBandMm) };
};

/** Moves a running picture by whole pixels; otherwise its peaks would jump between pixels. */
const inSteps = (window: TimeWindow, rateHz: number, columns: number): TimeWindow => {
  const scansPerPixel = ((window.toS - window.fromS) * rateHz) / columns;
  if (window.isTrial || !(scansPerPixel > 0)) return window;
  return { ...window, zeroScan: Math.floor(window.zeroScan / scansPerPixel) * scansPerPixel };
};

export class TransientPicture {
  private range: Range = { low: 0, high: 2 };
  private envelope: Envelope = newEnvelope(0);
  private window: TimeWindow = { zeroScan: 0, fromS: -10, toS: 0, isTrial: false };
  private drawnBack = '';
  private restOf = '';
  private rest: Rest | undefined;

  constructor(
    private readonly back: Surface,
    private readonly front: Surface,
    private readonly ring: TransientRing,
    private readonly ghosts: Ghosts,
  ) {}

  paint(examination: Examination, colours: Colours): void {
    const columns = Math.max(0, Math.floor(this.width()));
    if (columns === 0 || this.height() <= 0) return;
    if (this.envelope.low.length !== columns) this.envelope = newEnvelope(columns);
    this.window = inSteps(timeWindow(examination, this.ring), this.ring.rateHz, columns);
    this.ring.decimate(this.scanAt(this.window.fromS), this.scanAt(this.window.toS), columns, this.envelope);
    this.fit(examination);
    this.paintBack(examination, colours);
    const { context, width, height } = this.front;
    context.clearRect(0, 0, width, height);
    context.font = font;
    this.paintRest(examination, colours);
    if (examination.reach !== undefined) this.paintDip(examination.reach, colours);
    this.paintLine(colours);
    if (examination.reach !== undefined) this.paintPoints(examination.reach, colours);
  }

  /** Makes the next paint redraw the lower canvas, which is empty after its size changed. */
  forget(): void {
    this.drawnBack = '';
  }

  private width(): number {
    return this.front.width - margin.left - margin.right;
  }
  private height(): number {
    return this.front.height - margin.top - margin.bottom;
  }
  private scanAt(seconds: number): number {
    return this.window.zeroScan + seconds * this.ring.rateHz;
  }
  private x(seconds: number): number {
    return margin.left + ((seconds - this.window.fromS) / (this.window.toS - this.window.fromS)) * this.width();
  }
  private xOfScan(scan: number): number {
    return this.x((scan - this.window.zeroScan) / this.ring.rateHz);
  }
  private y(mm: number): number {
    return margin.top + ((this.range.high - mm) / (this.range.high - this.range.low)) * this.height();
  }
  private isInView(x: number): boolean {
    return x >= margin.left && x <= margin.left + this.width();
  }

  private fit(examination: Examination): void {
    let low = Number.POSITIVE_INFINITY;
    let high = Number.NEGATIVE_INFINITY;
    const include = (from: Float32Array, to: Float32Array): void => {
      for (let i = 0; i < from.length; i += 1) {
        if (from[i]! < low) low = from[i]!;
        if (to[i]! > high) high = to[i]!;
      }
    };
    include(this.envelope.low, this.envelope.high);
    if (this.window.isTrial) for (const ghost of this.ghosts.of(examination.condition)) include(ghost.values, ghost.values);
    this.range = fitRange(this.range, low, high);
  }

  private paintBack(examination: Examination, colours: Colours): void {
    const { context, width, height } = this.back;
    const { fromS, toS, isTrial } = this.window;
    const key = [width, height, this.range.low, this.range.high, fromS, toS, isTrial, examination.condition, this.ghosts.version, colours.paper].join();
    if (key === this.drawnBack) return;
    this.drawnBack = key;
    context.clearRect(0, 0, width, height);
    context.font = font;
    this.paintGrid(context, colours);
    if (!isTrial) return;
    context.lineWidth = 1.5;
    context.strokeStyle = colours.grey;
    for (const ghost of this.ghosts.of(examination.condition)) this.strokeGhost(context, ghost.values);
  }

  private paintGrid(context: CanvasRenderingContext2D, colours: Colours): void {
    const { fromS, toS, isTrial } = this.window;
    const bottom = margin.top + this.height();
    context.lineWidth = 1;
    context.fillStyle = colours.quiet;
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    const stepMm = gridStep(this.range.high - this.range.low, 5);
    for (let mm = Math.ceil(this.range.low / stepMm) * stepMm; mm <= this.range.high + 1e-9; mm += stepMm) {
      this.line(context, margin.left, this.y(mm), margin.left + this.width(), this.y(mm), colours.grid);
      context.fillText(fixed(mm, stepMm < 1 ? 1 : 0), margin.left - 8, this.y(mm));
    }
    context.textAlign = 'center';
    context.textBaseline = 'top';
    for (let s = Math.ceil(fromS); s <= toS; s += toS - fromS > 9 ? 2 : 1) {
      this.line(context, this.x(s), margin.top, this.x(s), bottom, s === 0 ? colours.quiet : colours.grid);
      context.fillText(fixed(s, 0), this.x(s), bottom + 4);
    }
    context.textAlign = 'right';
    context.fillText(isTrial ? strings.chair.picture.afterGo : strings.chair.picture.ago, margin.left + this.width(), bottom + 26);
    context.textAlign = 'left';
    context.fillText(strings.chair.picture.transient, margin.left, bottom + 26);
  }

  private line(context: CanvasRenderingContext2D, x1: number, y1: number, x2: number, y2: number, colour: string): void {
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(x1, y1);
    context.lineTo(x2, y2);
    context.stroke();
  }

  private strokeGhost(context: CanvasRenderingContext2D, values: Float32Array): void {
    context.beginPath();
    let isDown = false;
    for (let i = 0; i < values.length; i += 1) {
      const x = this.x(ghostTimeS(i));
      const isShown = Number.isFinite(values[i]) && this.isInView(x);
      if (isShown && isDown) context.lineTo(x, this.y(values[i]!));
      else if (isShown) context.moveTo(x, this.y(values[i]!));
      isDown = isShown;
    }
    context.stroke();
  }

  private paintRest(examination: Examination, colours: Colours): void {
    const { goAt } = examination;
    if (goAt === undefined || !this.window.isTrial) return;
    const key = `${goAt.segment}/${goAt.scan}`;
    if (key !== this.restOf) {
      this.restOf = key;
      this.rest = restBefore(this.ring, goAt.scan);
    }
    if (this.rest === undefined) return;
    const { context } = this.front;
    context.globalAlpha = 0.25;
    context.fillStyle = colours.green;
    const top = this.y(this.rest.mean + this.rest.half);
    context.fillRect(margin.left, top, this.width(), this.y(this.rest.mean - this.rest.half) - top);
    context.globalAlpha = 1;
    context.fillStyle = colours.quiet;
    context.textAlign = 'right';
    context.textBaseline = 'bottom';
    context.fillText(strings.chair.picture.rest, margin.left + this.width() - 4, top - 2);
  }

  /** Shades the area between the level of P1 and the line, from P1 to P2: the trunk leaves the back rest. */
  private paintDip(reach: Reach, colours: Colours): void {
    if (reach.p1 === undefined || !Number.isFinite(reach.p1.valueMm)) return;
    const level = this.y(reach.p1.valueMm);
    const end = reach.p2 === undefined ? this.ring.endScan : Number(reach.p2.scan);
    const from = Math.max(0, Math.floor(this.xOfScan(Number(reach.p1.scan)) - margin.left));
    const to = Math.min(this.envelope.low.length - 1, Math.ceil(this.xOfScan(end) - margin.left));
    if (to <= from) return;
    const { context } = this.front;
    context.globalAlpha = 0.5;
    context.fillStyle = colours.orange;
    context.beginPath();
    context.moveTo(margin.left + from, level);
    for (let column = from; column <= to; column += 1) {
      const value = this.envelope.low[column]!;
      context.lineTo(margin.left + column, Number.isFinite(value) ? Math.max(level, this.y(value)) : level);
    }
    context.lineTo(margin.left + to, level);
    context.fill();
    context.globalAlpha = 1;
  }

  /** Draws one bar per pixel column, joined to its neighbour. Without a graphics card a stroked path of so many points takes ten times as long. */
  private paintLine(colours: Colours): void {
    const { context } = this.front;
    const { low, high } = this.envelope;
    context.fillStyle = colours.blue;
    let [topBefore, bottomBefore] = [NaN, NaN];
    for (let column = 0; column < low.length; column += 1) {
      const [top, bottom] = [this.y(high[column]!), this.y(low[column]!)];
      const from = bottomBefore < top ? bottomBefore : top;
      const to = topBefore > bottom ? topBefore : bottom;
      if (top === top) context.fillRect(margin.left + column, from - 1, 1, to - from + 2);
      [topBefore, bottomBefore] = [top, bottom];
    }
  }

  private paintPoints(reach: Reach, colours: Colours): void {
    const isFinal = reach.step === ReachStep.FINAL;
    this.paintPoint('P1', reach.p1, isFinal, -1, colours);
    this.paintPoint('P2', reach.p2, isFinal, 1, colours);
    this.paintPoint('P3', reach.p3, isFinal, -1, colours);
  }

  private paintPoint(name: string, point: ReachPoint | undefined, isFinal: boolean, side: -1 | 1, colours: Colours): void {
    if (point === undefined || !Number.isFinite(point.valueMm)) return;
    const x = this.xOfScan(Number(point.scan));
    if (!this.isInView(x)) return;
    const y = this.y(point.valueMm);
    const { context } = this.front;
    context.beginPath();
    context.arc(x, y, 7, 0, 2 * Math.PI);
    context.fillStyle = isFinal ? colours.vermillion : colours.paper;
    context.fill();
    context.lineWidth = 3;
    context.strokeStyle = colours.vermillion;
    context.stroke();
    context.fillStyle = colours.ink;
    context.font = `bold 20px ${fontFamily}`;
    context.textAlign = 'center';
    context.textBaseline = side < 0 ? 'bottom' : 'top';
    const labelY = y + side * 12;
    const isOutside = labelY - 20 < 0;
    if (isOutside) context.textAlign = 'left';
    context.fillText(strings.chair.picture.mm(name, fixed(point.valueMm, 2)), isOutside ? x + 14 : x, isOutside ? y + 20 : labelY);
  }
}
