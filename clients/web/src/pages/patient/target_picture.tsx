// SPDX-License-Identifier: Apache-2.0
// The target of a person who stands: rings that never move, and with feedback a dot for the centre of pressure.
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import type { Link } from '../../link/types';
import type { Colours, Surface } from '../../parts/canvas';
import { colours, openSurface } from '../../parts/canvas';
import type { ScanRing } from '../../parts/scan_ring';
import { strings } from '../../strings';
import type { LiveFloor } from '../floor/live_floor';
import { ap, ml } from '../floor/live_floor';

export interface Place {
  readonly mlMm: number;
  readonly apMm: number;
}

const meanOverMs = 3000;
const fewestMs = 1000;
const halfMm = 30; // from the middle of the picture to its edge: quiet sway stays within it
const ringsMm = [10, 25] as const;
const staleMs = 500; // an older dot would look alive

/**
 * Returns the mean place of the last 3 s: the middle of the target. A person does not stand exactly in the middle of the plate, and a target there
 * would ask to lean. Nothing while there is less than 1 s of a person on the plate.
 */
export const meanPlace = (ring: ScanRing): Place | undefined => {
  let [mlSum, apSum, count, firstMs] = [0, 0, 0, NaN];
  for (let index = ring.indexAt(ring.newestMs - meanOverMs); index < ring.length; index += 1) {
    const [mlMm, apMm] = [ring.value(ml, index), ring.value(ap, index)];
    if (Number.isNaN(mlMm) || Number.isNaN(apMm)) {
      [mlSum, apSum, count, firstMs] = [0, 0, 0, NaN]; // a gap, or the person stepped on here
      continue;
    }
    if (count === 0) firstMs = ring.timeMs(index);
    mlSum += mlMm;
    apSum += apMm;
    count += 1;
  }
  return ring.newestMs - firstMs >= fewestMs ? { mlMm: mlSum / count, apMm: apSum / count } : undefined;
};

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

const drawTarget = ({ context, width, height }: Surface, present: Colours): void => {
  const half = Math.min(width, height) / 2;
  context.clearRect(0, 0, width, height);
  context.strokeStyle = present.line;
  context.lineWidth = half / 60;
  for (const mm of ringsMm) {
    circle(context, width / 2, height / 2, (mm / halfMm) * half);
    context.stroke();
  }
  context.fillStyle = present.blue;
  circle(context, width / 2, height / 2, half / 25);
  context.fill();
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

/** Draws until it is released; calls `hasFeedback` for every frame. */
const openPicture = (canvas: HTMLCanvasElement, link: Link, floor: LiveFloor, hasFeedback: () => boolean): (() => void) => {
  let middle: Place | undefined;
  let isDotShown = false;
  let shownColours: Colours | undefined;
  const surface = openSurface(canvas, () => {
    shownColours = undefined;
    paint(performance.now());
  });
  const dotNow = (nowMs: number): ReturnType<typeof dotPlace> | undefined => {
    const { ring } = floor;
    if (!hasFeedback() || ring === undefined || ring.length === 0 || nowMs - floor.newestMs > staleMs) return undefined;
    middle ??= meanPlace(ring); // fixed from then on: a target that moves would ask to follow it
    const now = { mlMm: ring.value(ml, ring.length - 1), apMm: ring.value(ap, ring.length - 1) };
    return middle === undefined || Number.isNaN(now.mlMm) || Number.isNaN(now.apMm) ? undefined : dotPlace(now, middle);
  };
  const paint = (nowMs: number): void => {
    if (surface.width === 0 || surface.height === 0) return;
    const present = colours().peek();
    const dot = dotNow(nowMs);
    if (dot === undefined && !isDotShown && shownColours === present) return; // the target never changes
    drawTarget(surface, present);
    if (dot !== undefined) drawDot(surface, dot, present);
    isDotShown = dot !== undefined;
    shownColours = present;
  };
  const stop = link.onPaint(paint);
  return () => {
    stop();
    surface.release();
  };
};

/** Shows the target. With feedback, the dot of one trial has one middle: give each trial a picture of its own (`key`). */
export const TargetPicture = ({ link, floor, hasFeedback }: { link: Link; floor: LiveFloor; hasFeedback: boolean }): JSX.Element => {
  const canvas = useRef<HTMLCanvasElement>(null);
  const wanted = useRef(hasFeedback);
  wanted.current = hasFeedback;
  useEffect(() => openPicture(canvas.current!, link, floor, () => wanted.current), [link, floor]);
  const { picture } = strings.patient;
  return (
    <canvas
      ref={canvas}
      class="patient-target"
      role="img"
      aria-label={hasFeedback ? picture.feedback : picture.target}
      data-testid="patient-target"
      data-feedback={hasFeedback}
    />
  );
};
