// SPDX-License-Identifier: Apache-2.0
import { signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';

import type { Dropped } from './types';

const nothing: Dropped = { blocks: 0, scans: 0, events: 0, scansLately: 0 };
/** So long after the last drop a tab is no longer called slow: a notice that stays is not looked at any more. */
export const slowForMs = 10_000;

/** What this tab did not get because it was too slow; the gateway counts it from the tab's connection on. */
export class Drops {
  readonly #told = signal(nothing);
  #scansBefore = 0; // of former times when it was slow
  #lastMs = 0;

  get told(): ReadonlySignal<Dropped> {
    return this.#told;
  }

  /** The gateway's totals. */
  count(blocks: number, scans: number, events: number, nowMs: number): void {
    const known = this.#told.peek();
    if (blocks === known.blocks && events === known.events) return;
    this.#lastMs = nowMs;
    this.#told.value = { blocks, scans, events, scansLately: scans - this.#scansBefore };
  }

  tick(nowMs: number): void {
    const known = this.#told.peek();
    if (known.scansLately === 0 || nowMs - this.#lastMs < slowForMs) return;
    this.#scansBefore = known.scans;
    this.#told.value = { ...known, scansLately: 0 };
  }

  /** A new connection counts from 0. */
  forget(): void {
    this.#scansBefore = 0;
    this.#told.value = nothing;
  }
}
