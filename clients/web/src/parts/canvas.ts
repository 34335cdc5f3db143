// SPDX-License-Identifier: Apache-2.0
// A canvas as sharp as the screen, that knows its size in CSS pixels and the theme's colours.
import { signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';

/** Okabe-Ito colours and greys of the theme (theme.css), for whoever draws. */
export interface Colours {
  readonly paper: string;
  readonly raised: string;
  readonly ink: string;
  readonly quiet: string; // text of less weight; contrast still >= 4.5
  readonly line: string;
  readonly grid: string;
  readonly blue: string;
  readonly vermillion: string;
  readonly green: string;
  readonly sky: string;
  readonly orange: string;
  readonly grey: string;
}

const read = (): Colours => {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string): string => style.getPropertyValue(`--${name}`).trim();
  return {
    paper: colour('paper'),
    raised: colour('raised'),
    ink: colour('ink'),
    quiet: colour('quiet'),
    line: colour('line'),
    grid: colour('grid'),
    blue: colour('blue'),
    vermillion: colour('vermillion'),
    green: colour('green'),
    sky: colour('sky'),
    orange: colour('orange'),
    grey: colour('grey'),
  };
};

let present: ReturnType<typeof signal<Colours>> | undefined;

/** The theme's colours; the signal changes when the theme does (then everything is drawn anew). */
export const colours = (): ReadonlySignal<Colours> => {
  present ??= signal(read());
  return present as ReadonlySignal<Colours>;
};
/** After the theme changed. */
export const readColours = (): void => {
  if (present !== undefined) present.value = read();
};

export const fontFamily = 'system-ui, sans-serif';

export interface Surface {
  readonly context: CanvasRenderingContext2D;
  /** In CSS pixels; 0 while it is not shown. */
  width: number;
  height: number;
  release(): void;
}

/** Keeps the bitmap at the device's resolution. `onResize` is called after each change, also at first: a resized canvas is empty. */
export const openSurface = (canvas: HTMLCanvasElement, onResize: () => void): Surface => {
  const context = canvas.getContext('2d');
  if (context === null) throw new Error('this browser has no canvas');
  const fit = (): void => {
    const scale = window.devicePixelRatio || 1;
    surface.width = canvas.clientWidth;
    surface.height = canvas.clientHeight;
    canvas.width = Math.round(surface.width * scale);
    canvas.height = Math.round(surface.height * scale);
    context.setTransform(scale, 0, 0, scale, 0, 0);
    onResize();
  };
  const observer = new ResizeObserver(fit);
  const surface: Surface = { context, width: 0, height: 0, release: () => observer.disconnect() };
  observer.observe(canvas);
  return surface;
};

/** "10 mm" of a scale bar: the largest 1, 2 or 5 times a power of ten that is at most `longest`. */
export const roundLength = (longest: number): number => {
  if (!(longest > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(longest));
  const factor = longest / power;
  return power * (factor >= 5 ? 5 : factor >= 2 ? 2 : 1);
};
