// SPDX-License-Identifier: Apache-2.0
// Lines of earlier trials, to be drawn behind the present one: a few of each target, of one examination.
import type { At } from './examination';
import type { TransientRing } from './transient_ring';

export const leadS = 1; // shown before "Go": the rest that the reach starts from
const stepMs = 10; // as fine as the features of a reach are found
const mostPerTarget = 5;
const mostTargets = 16;

/** Means of 10 ms each, from one second before "Go". */
export interface Ghost {
  readonly trial: number;
  readonly values: Float32Array;
}

export const ghostTimeS = (index: number): number => ((index + 0.5) * stepMs) / 1000 - leadS;

export class Ghosts {
  private sessionId = '';
  private readonly lines = new Map<string, Ghost[]>();
  /** Counts changes: who draws draws anew. */
  version = 0;

  /** Keeps what the ring holds of a trial that is done. */
  keep(trial: number, condition: string, goAt: At, ring: TransientRing): void {
    const scansEach = Math.round((ring.rateHz * stepMs) / 1000);
    const from = goAt.scan - Math.round(leadS * ring.rateHz);
    if (scansEach < 1 || ring.segment !== goAt.segment) return; // slower than its own line, or a gap: nothing to compare with
    const count = Math.floor((ring.endScan - from) / scansEach);
    if (count < 1) return;
    const of = this.lines.get(condition) ?? [];
    of.push({ trial, values: ring.means(from, scansEach, count) });
    if (of.length > mostPerTarget) of.shift();
    if (this.lines.has(condition) || this.lines.size < mostTargets) this.lines.set(condition, of);
    this.version += 1;
  }

  /** A trial that was redone or rejected after all. */
  drop(trial: number): void {
    for (const [condition, lines] of this.lines) this.lines.set(condition, lines.filter((line) => line.trial !== trial));
    this.version += 1;
  }

  /** Another examination: another person's lines have no place behind this one's. */
  begin(sessionId: string): void {
    if (sessionId === this.sessionId) return;
    this.sessionId = sessionId;
    this.lines.clear();
    this.version += 1;
  }

  of(condition: string): readonly Ghost[] {
    return this.lines.get(condition) ?? [];
  }
}
