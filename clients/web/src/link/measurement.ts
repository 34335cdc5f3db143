// SPDX-License-Identifier: Apache-2.0
// Measures the age of the newest COP on the screen and the time of the main thread per frame. Active only with "?measure" in the address.
import type { PaintObserver } from './painter';
import type { Link } from './types';

export interface MeasuredFrame {
  /** Newest scan of floor/cop in the frame, in ms of performance.now(); NaN if the frame has none. */
  readonly newestMs: number;
  /** When the browser had rendered the frame: the first task after it. */
  readonly paintedMs: number;
  /** Decoding since the previous frame, plus all painting of this one. */
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
  // A message posted in a frame's callback arrives right after style, layout and paint of that frame.
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
