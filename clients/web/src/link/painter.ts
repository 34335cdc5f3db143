// SPDX-License-Identifier: Apache-2.0

/** Watches the painting for measurements. */
export interface PaintObserver {
  /** Main-thread time spent on a message before painting. */
  onWork(milliseconds: number): void;
  /** All handlers of a frame have painted; `startedMs` is when the first began. */
  onPainted(startedMs: number): void;
}

/** The one requestAnimationFrame loop: runs only when something is to be painted. */
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
