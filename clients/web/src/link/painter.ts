// SPDX-License-Identifier: Apache-2.0

/** Observes painting for measurements. */
export interface PaintObserver {
  /** Receives the main-thread time of one message before painting. */
  onWork(milliseconds: number): void;
  /** Called when all handlers of a frame have painted; `startedMs` is the start of the first one. */
  onPainted(startedMs: number): void;
}

/** The only requestAnimationFrame loop. It runs only when there is something to paint. */
export class Painter {
  readonly #requestFrame: (callback: () => void) => void;
  readonly #afterPaint: (startedMs: number) => void;
  #handlers = new Set<{ readonly paint: (nowMs: number) => void }>();
  #isAsked = false;

  constructor(requestFrame: (callback: () => void) => void, afterPaint: (startedMs: number) => void) {
    this.#requestFrame = requestFrame;
    this.#afterPaint = afterPaint;
  }

  add(paint: (nowMs: number) => void): () => void {
    const entry = { paint };
    this.#handlers.add(entry);
    this.ask();
    return () => this.#handlers.delete(entry);
  }

  ask(): void {
    if (this.#isAsked) return;
    this.#isAsked = true;
    this.#requestFrame(() => this.#paint());
  }

  #paint(): void {
    this.#isAsked = false;
    const startedMs = performance.now();
    for (const handler of this.#handlers) {
      try {
        handler.paint(startedMs);
      } catch (problem) {
        reportError(problem);
      }
    }
    this.#afterPaint(startedMs);
  }
}
