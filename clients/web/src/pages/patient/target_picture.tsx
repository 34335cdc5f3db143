// SPDX-License-Identifier: Apache-2.0
// The target of a person who stands: rings that never move, and with feedback a dot for the centre of pressure. In a trial with feedback the rings
// appear with the dot: before, their middle is not known.
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import type { Link } from '../../link/types';
import type { Colours, Surface } from '../../parts/canvas';
import { colours, openSurface } from '../../parts/canvas';
import { strings } from '../../strings';
import type { LiveFloor } from '../floor/live_floor';
import { ap, ml } from '../floor/live_floor';
import type { FeedbackMiddle, Place } from './feedback_middle';

const halfMm = 30; // from the middle of the picture to its edge: quiet sway stays within it
const ringsMm = [10, 25] as const;
const staleMs = 500; // an older dot would look alive

/** Returns where the dot is, in halves of the picture from its middle: right and front are positive. Beyond the edge it stays on the edge. */
export const dotPlace = (now: Place, middle: Place): { readonly x: number; readonly y: number; readonly isBeyond: boolean } => {
  const [x, y] = [(now.mlMm - middle.mlMm) / halfMm, (now.apMm - middle.apMm) / halfMm];
  const far = Math.hypot(x, y);
  const most = 0.94; // the dot itself stays within the picture
  return far <= most ? { x, y, isBeyond: false } : { x: (most * x) / far, y: (most * y) / far, isBeyond: true };
};

const circle = (context: CanvasRenderingContext2D, x: number, y: number, radius: number): void => {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
};

const drawPoint = ({ context, width, height }: Surface, present: Colours): void => {
  context.clearRect(0, 0, width, height);
  context.fillStyle = present.blue;
  circle(context, width / 2, height / 2, Math.min(width, height) / 50);
  context.fill();
};

const drawRings = ({ context, width, height }: Surface, present: Colours): void => {
  const half = Math.min(width, height) / 2;
  context.strokeStyle = present.line;
  context.lineWidth = half / 60;
  for (const mm of ringsMm) {
    circle(context, width / 2, height / 2, (mm / halfMm) * half);
    context.stroke();
  }
};

const drawDot = ({ context, width, height }: Surface, place: ReturnType<typeof dotPlace>, present: Colours): void => {
  const half = Math.min(width, height) / 2;
  context.fillStyle = present.vermillion;
  context.strokeStyle = present.vermillion;
  context.lineWidth = half / 40;
  circle(context, width / 2 + place.x * half, height / 2 - place.y * half, half / 16);
  if (place.isBeyond) context.stroke();
  else context.fill();
};

interface Wanted {
  readonly middle: FeedbackMiddle | undefined; // of a trial with feedback
  readonly hasFeedback: boolean; // now
}

/** Draws until it is released; calls `wanted` for every frame. */
const openPicture = (canvas: HTMLCanvasElement, link: Link, floor: LiveFloor, wanted: () => Wanted): (() => void) => {
  let shown: { readonly isDot: boolean; readonly hasRings: boolean; readonly colours: Colours } | undefined;
  const surface = openSurface(canvas, () => {
    shown = undefined;
    paint(performance.now());
  });
  const dotNow = (nowMs: number, middle: Place | undefined): ReturnType<typeof dotPlace> | undefined => {
    const { ring } = floor;
    if (middle === undefined || ring === undefined || ring.length === 0 || nowMs - floor.newestMs > staleMs) return undefined;
    const now = { mlMm: ring.value(ml, ring.length - 1), apMm: ring.value(ap, ring.length - 1) };
    return Number.isNaN(now.mlMm) || Number.isNaN(now.apMm) ? undefined : dotPlace(now, middle);
  };
  const paint = (nowMs: number): void => {
    if (surface.width === 0 || surface.height === 0) return;
    const present = colours().peek();
    const { middle, hasFeedback } = wanted();
    const place = hasFeedback ? middle?.whileMeasured() : undefined;
    const dot = dotNow(nowMs, place);
    const hasRings = middle === undefined || place !== undefined;
    if (dot === undefined && shown?.isDot === false && shown.hasRings === hasRings && shown.colours === present) return; // nothing moves
    drawPoint(surface, present);
    if (hasRings) drawRings(surface, present);
    if (dot !== undefined) drawDot(surface, dot, present);
    shown = { isDot: dot !== undefined, hasRings, colours: present };
    if (place !== undefined) [canvas.dataset['mlMm'], canvas.dataset['apMm']] = [place.mlMm.toFixed(3), place.apMm.toFixed(3)];
  };
  const stop = link.onPaint(paint);
  return () => {
    stop();
    surface.release();
  };
};

/** Shows the target; with `hasFeedback` around `middle`, with the dot. The middle in mm is in data-ml-mm and data-ap-mm: give each trial a picture of its own (`key`). */
export const TargetPicture = ({ link, floor, middle, hasFeedback }: { link: Link; floor: LiveFloor } & Wanted): JSX.Element => {
  const canvas = useRef<HTMLCanvasElement>(null);
  const wanted = useRef<Wanted>({ middle, hasFeedback });
  wanted.current = { middle, hasFeedback };
  useEffect(() => openPicture(canvas.current!, link, floor, () => wanted.current), [link, floor]);
  const { picture } = strings.patient;
  return (
    <canvas
      ref={canvas}
      class="patient-target"
      role="img"
      aria-label={hasFeedback ? picture.feedback : middle === undefined ? picture.target : picture.point}
      data-testid="patient-target"
      data-feedback={hasFeedback}
    />
  );
};
