// SPDX-License-Identifier: Apache-2.0
// The part of the plate that the large picture shows. It follows the ellipse in steps: a continuous zoom would look like sway.
import type { Ellipse } from './ellipse';

/** Centre and height of the shown part in mm, relative to the plate's centre. */
export interface View {
  readonly x: number;
  readonly y: number;
  readonly spanMm: number;
}

const spans = [20, 40, 80, 160, 320] as const;

const reachOf = (view: Pick<View, 'x' | 'y'>, ellipse: Ellipse): number =>
  Math.max(Math.abs(ellipse.centreX - view.x), Math.abs(ellipse.centreY - view.y)) + ellipse.long;

/** Returns the next view. Returns `whole`, which shows the whole plate, if there is no ellipse or it is too large. */
export const nextView = (view: View, ellipse: Ellipse | undefined, whole: View): View => {
  if (ellipse === undefined) return whole;
  // The view stays while the ellipse is inside and fills at least a fifth: the margin keeps it from changing with every breath.
  const isInside = (2 * reachOf(view, ellipse)) / view.spanMm <= 0.95;
  const isLarge = (2 * ellipse.long) / view.spanMm >= 0.2 || view.spanMm === spans[0];
  if (view !== whole && isInside && isLarge) return view;
  const spanMm = spans.find((span) => span >= 2 * 1.4 * ellipse.long);
  if (spanMm === undefined || spanMm >= whole.spanMm) return whole;
  const step = spanMm / 20;
  return { x: Math.round(ellipse.centreX / step) * step, y: Math.round(ellipse.centreY / step) * step, spanMm };
};
