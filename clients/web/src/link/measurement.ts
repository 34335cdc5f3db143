// SPDX-License-Identifier: Apache-2.0
// Only with "?measure" in the address: how old the newest COP is when it is on the screen, and what a frame costs the main thread.
import type { PaintObserver } from './painter';
import type { Link } from './types';

export interface MeasuredFrame {
  /** Newest scan of floor/cop in it, in ms of performance.now(); NaN: the frame brought none. */
  readonly newestMs: number;
  /** When the browser had rendered it: the first task after the frame. */
  readonly paintedMs: number;
  /** Decoding since the frame before, and all painting of this one. */
  readonly scriptMs: number;
  /** From the first painter to the task after style, layout and paint, plus the decoding. */
  readonly mainThreadMs: number;
}

declare global {
  interface Window {
    dtsMeasure?: () => readonly MeasuredFrame[];
  }
}

const kept = 2000;

/** Publishes `window.dtsMeasure`. */
export const openMeasurement = (): PaintObserver & { watch(link: Link): void } => {
  const frames: MeasuredFrame[] = [];
  let newestMs = NaN;
  let decodingMs = 0;
  // A message posted in a frame's callback arrives right after that frame's style, layout and paint.
  const afterFrame = new MessageChannel();
  let finish: ((paintedMs: number) => void) | undefined;
  afterFrame.port1.onmessage = () => finish?.(performance.now());
  window.dtsMeasure = () => frames;
  return {
    watch: (link) => void link.onBlock('floor/cop', (block) => (newestMs = block.newestMs)),
    onWork: (milliseconds) => void (decodingMs += milliseconds),
    onPainted: (startedMs) => {
      const [newest, decoding, script] = [newestMs, decodingMs, performance.now() - startedMs];
      newestMs = NaN;
      decodingMs = 0;
      finish = (paintedMs) => {
        frames.push({ newestMs: newest, paintedMs, scriptMs: decoding + script, mainThreadMs: decoding + paintedMs - startedMs });
        if (frames.length > kept) frames.shift();
      };
      afterFrame.port2.postMessage(null);
    },
  };
};
