// SPDX-License-Identifier: Apache-2.0
import { signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';

import type { Dropped } from './types';

const nothing: Dropped = { blocks: 0, scans: 0, events: 0, scansLately: 0 };
/** A tab counts as slow for this long after its last drop. A notice that stays longer is no longer read. */
export const slowForMs = 10_000;

/** What the gateway dropped because this tab was too slow, counted since the tab connected. */
export class Drops {
  readonly #current = signal(nothing);
  #scansBefore = 0; // dropped in earlier slow periods
  #lastMs = 0;

  get current(): ReadonlySignal<Dropped> {
    return this.#current;
  }

  /** Takes the gateway's totals. */
  count(blocks: number, scans: number, events: number, nowMs: number): void {
    const known = this.#current.peek();
    if (blocks === known.blocks && events === known.events) return;
    this.#lastMs = nowMs;
    this.#current.value = { blocks, scans, events, scansLately: scans - this.#scansBefore };
  }

  tick(nowMs: number): void {
    const known = this.#current.peek();
    if (known.scansLately === 0 || nowMs - this.#lastMs < slowForMs) return;
    this.#scansBefore = known.scans;
    this.#current.value = { ...known, scansLately: 0 };
  }

  /** Starts again from 0 for a new connection. */
  forget(): void {
    this.#scansBefore = 0;
    this.#current.value = nothing;
  }
}
