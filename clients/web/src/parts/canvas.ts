// SPDX-License-Identifier: Apache-2.0
// Canvases at the resolution of the screen, sized in CSS pixels, and the colours of the theme.
import { signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';

/** Okabe-Ito colours and greys of the theme (theme.css), for canvases. */
export interface Colours {
  readonly paper: string;
  readonly raised: string;
  readonly ink: string;
  readonly quiet: string; // for secondary text; contrast >= 4.5
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

/** Returns the colours of the theme. The signal changes with the theme; all pictures must then be redrawn. */
export const colours = (): ReadonlySignal<Colours> => {
  present ??= signal(read());
  return present as ReadonlySignal<Colours>;
};
/** Reads the colours again. Call it after the theme changed. */
export const readColours = (): void => {
  if (present !== undefined) present.value = read();
};

export const fontFamily = 'system-ui, sans-serif';

export interface Surface {
  readonly context: CanvasRenderingContext2D;
  /** In CSS pixels; 0 while the canvas is not shown. */
  width: number;
  height: number;
  release(): void;
}

/** Keeps the bitmap at the resolution of the screen. Calls `onResize` at the start and after each change, because a resized canvas is empty. */
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

/** Returns the length for a scale bar: the largest 1, 2 or 5 times a power of ten that is at most `longest`. */
export const roundLength = (longest: number): number => {
  if (!(longest > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(longest));
  const factor = longest / power;
  return power * (factor >= 5 ? 5 : factor >= 2 ? 2 : 1);
};
