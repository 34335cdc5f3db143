// SPDX-License-Identifier: Apache-2.0
// Lines of earlier trials, drawn behind the present one: a few per target, of one session.
import type { At } from './examination';
import type { TransientRing } from './transient_ring';

export const leadS = 1; // shown before Go: the rest before the reach
const stepMs = 10; // the resolution of the features of a reach
const mostPerTarget = 5;
const mostTargets = 16;

/** Means over 10 ms, from one second before Go. */
export interface Ghost {
  readonly trial: number;
  readonly values: Float32Array;
}

export const ghostTimeS = (index: number): number => ((index + 0.5) * stepMs) / 1000 - leadS;

export class Ghosts {
  private sessionId = '';
  private readonly lines = new Map<string, Ghost[]>();
  /** Counts changes, so that a picture knows when to redraw. */
  version = 0;

  /** Keeps the line of a done trial, as far as the ring still holds it. */
  keep(trial: number, condition: string, goAt: At, ring: TransientRing): void {
    const scansEach = Math.round((ring.rateHz * stepMs) / 1000);
    const from = goAt.scan - Math.round(leadS * ring.rateHz);
    if (scansEach < 1 || ring.segment !== goAt.segment) return; // slower than 100 Hz, or a gap: no comparable line
    const count = Math.floor((ring.endScan - from) / scansEach);
    if (count < 1) return;
    const of = this.lines.get(condition) ?? [];
    of.push({ trial, values: ring.means(from, scansEach, count) });
    if (of.length > mostPerTarget) of.shift();
    if (this.lines.has(condition) || this.lines.size < mostTargets) this.lines.set(condition, of);
    this.version += 1;
  }

  /** Removes a trial that was redone or rejected. */
  drop(trial: number): void {
    for (const [condition, lines] of this.lines) this.lines.set(condition, lines.filter((line) => line.trial !== trial));
    this.version += 1;
  }

  /** Starts a session. Removes all lines of another session: they may be another person's. */
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
