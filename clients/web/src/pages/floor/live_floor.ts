// SPDX-License-Identifier: Apache-2.0
// The state of one platform. Pictures read the ring when they paint; slow values are signals.
import { batch, signal } from '@preact/signals';

import type { SessionInfo, StatusSnapshot } from '../../generated/dts/v1/control_pb';
import { TrialOutcome } from '../../generated/dts/v1/sessions_pb';
import { Quality, SessionState, SwayWindow, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import type { Gap, Sway, TrialChange } from '../../generated/dts/v1/stream_pb';
import type { Block, Instant, Link, LiveEvent } from '../../link/types';
import { instantNow } from '../../link/types';
import { isActive } from '../../parts/active';
import { includesEvent } from '../../parts/later_status';
import { whole } from '../../parts/numbers';
import { ScanRing } from '../../parts/scan_ring';
import type { strings } from '../../strings';
import type { Attempt } from './attempt';
import { isSameAttempt } from './attempt';
import type { Ellipse } from './ellipse';
import { ellipseOf, withArea } from './ellipse';

export const windowS = 20; // of the series
const ringS = 62; // a trial of a minute
export const trailS = 5;
const fastestHz = 2000; // bounds the memory of the ring
const slowEveryMs = 250;
const gravity = 9.80665; // N per kg
const voiding = new Set([TrialEventKind.REDONE, TrialEventKind.REJECTED, TrialEventKind.ABORTED]);
const sparkLength = 120; // one minute at two values per second

/** Columns of the ring. */
export const ml = 0;
export const ap = 1;

export interface Steadiness {
  readonly sway: Sway;
  readonly values: ReadonlyMap<string, number>;
  /** The scans that the values describe, in ms of performance.now(). Undefined for a trial whose measurement this tab did not see. */
  readonly span: { readonly fromMs: number; readonly toMs: number } | undefined;
}

/** Values for texts and tiles, updated at most four times a second. */
export interface Now {
  readonly mlMm: number;
  readonly apMm: number;
  readonly loadKg: number;
  readonly quality: number;
}

const nothing: Now = { mlMm: NaN, apMm: NaN, loadKg: NaN, quality: Quality.UNSPECIFIED };

/** A gap that ended; its length comes from the gap's own count of scans. */
export interface Absence {
  readonly back: Instant;
  readonly seconds: number;
}

export class LiveFloor {
  readonly now = signal<Now>(nothing);
  readonly sway = signal<Steadiness | undefined>(undefined);
  /** The ellipse whose area the tile shows. */
  readonly ellipse = signal<Ellipse | undefined>(undefined);
  readonly absence = signal<Absence | undefined>(undefined);
  /** The newest markers, for flags; at most 50. */
  readonly markers: { readonly timeMs: number; readonly text: string }[] = [];
  readonly sparks = new Map<string, number[]>();

  ring: ScanRing | undefined;
  newestMs = NaN;
  quality = 0;
  /** Newest deflection and quality of each sensor. */
  deflectionMm: number[] = [];
  sensorQuality: number[] = [];

  /** The attempt whose measurement this tab saw begin last, in ms of performance.now(). Its end is unknown until this tab sees it. */
  #measured: (Attempt & { readonly fromMs: number; readonly toMs: number | undefined }) | undefined;
  /** The attempt that the newest event of a trial was about, or a status that includes that event. */
  #present: Attempt | undefined;
  /** The attempt that became void last, unless that was undone. Neither its result nor the decision about it may be shown. */
  #void: Attempt | undefined;
  /** A result from the catalogue that may not be shown yet: the status or an event may be behind it. */
  #recalled: Sway | undefined;
  /** Host time of the newest event of a trial, and the run of the daemon that it is of. */
  #changedNs = 0n;
  #instanceId = 0n;
  #rateHz = 0;
  #loadN = NaN;
  #updatedMs = 0;
  readonly #link: Link;
  readonly #rig: string;
  readonly #stops: (() => void)[];

  constructor(link: Link, rig: string) {
    [this.#link, this.#rig] = [link, rig];
    const topics = ['cop', 'deflection', 'sway', 'gap', 'marker', 'trial', 'session'].map((name) => `${rig}/${name}`);
    this.#stops = [
      link.onBlock(`${rig}/cop`, (block) => this.#addCop(block)),
      link.onBlock(`${rig}/deflection`, (block) => this.#addDeflection(block)),
      link.onEvent(`${rig}/`, (event) => this.#addEvent(event)),
      link.onPaint((nowMs) => this.#updateNow(nowMs)),
      link.subscribe(topics),
      link.status.subscribe((status) => this.#follow(status)),
    ];
  }

  close(): void {
    for (const stop of this.#stops) stop();
  }

  /** Shows a final result from the catalogue as if it had just arrived, unless another trial has begun meanwhile, or this one became void. */
  recall(sway: Sway): void {
    this.#recalled = sway;
    this.#showRecalled();
  }

  #showRecalled(): void {
    const sway = this.#recalled;
    if (sway === undefined || !isSameAttempt(sway, this.#present) || isSameAttempt(sway, this.#void)) return;
    this.#recalled = undefined;
    this.#addSway(sway, this.#measuredSpan(sway));
  }

  /** Returns when the measurement of an attempt began, in ms of performance.now(). Undefined if it has not, or if this tab did not see it. */
  measuredSinceMs(sessionId: string, trial: number, attempt: number): number | undefined {
    return isSameAttempt(this.#measured, { sessionId, trial, attempt }) ? this.#measured?.fromMs : undefined;
  }

  #addCop(block: Block): void {
    const column = (name: string): number => block.format.channels.findIndex((channel) => channel.name === name);
    const [mlColumn, apColumn, loadColumn] = [column('ml_mm'), column('ap_mm'), column('load_n')];
    if (mlColumn < 0 || apColumn < 0) return;
    if (this.ring === undefined || this.#rateHz !== block.rateHz) {
      this.#rateHz = block.rateHz;
      this.ring = new ScanRing(2, Math.ceil(Math.min(block.rateHz, fastestHz) * ringS));
    }
    this.ring.push(block, [mlColumn, apColumn]);
    this.newestMs = block.newestMs;
    const wasEmpty = (this.quality & Quality.NO_CONTACT) !== 0;
    this.quality = (block.quality[mlColumn] ?? 0) | (block.quality[apColumn] ?? 0);
    // A person who steps on after a session may be another one: the old results are not theirs.
    if (wasEmpty && (this.quality & Quality.NO_CONTACT) === 0 && !this.#isInSession()) this.#showSway(undefined);
    this.#loadN = block.columns[loadColumn]?.[block.scanCount - 1] ?? NaN;
  }

  #addDeflection(block: Block): void {
    for (let sensor = 0; sensor < block.columns.length; sensor += 1) {
      this.deflectionMm[sensor] = block.columns[sensor]![block.scanCount - 1]!;
      this.sensorQuality[sensor] = block.quality[sensor]!;
    }
  }

  #addEvent({ timeMs, event }: LiveEvent): void {
    const { body } = event;
    switch (body.case) {
      case 'sway':
        return this.#addSway(body.value, this.#spanOf(body.value, timeMs));
      case 'gap':
        return this.#addGap(body.value);
      case 'marker':
        this.markers.push({ timeMs, text: body.value.text });
        if (this.markers.length > 50) this.markers.shift();
        return;
      case 'trial':
        return this.#addTrial(body.value, timeMs, event.hostTimeNs ?? 0n);
      case 'session':
        if (body.value.state !== SessionState.STARTING) return;
        [this.#present, this.#measured, this.#recalled] = [undefined, undefined, undefined];
        this.#showSway(undefined);
        return;
    }
  }

  #addTrial({ sessionId, step: kind, trial, attempt }: TrialChange, timeMs: number, hostTimeNs: bigint): void {
    const named = { sessionId, trial, attempt };
    if (trial > 0) [this.#present, this.#changedNs] = [named, hostTimeNs]; // the end of the plan names none
    if (kind === TrialEventKind.MEASURE) this.#measured = { ...named, fromMs: timeMs, toMs: undefined };
    else if (kind === TrialEventKind.DONE && isSameAttempt(this.#measured, named)) this.#measured = { ...this.#measured!, toMs: timeMs };
    if (voiding.has(kind)) this.#void = named;
    else if (kind === TrialEventKind.UNDONE) this.#void = undefined;
    if (voiding.has(kind) || kind === TrialEventKind.READY || kind === TrialEventKind.GO) this.#showSway(undefined);
  }

  /** Learns what this tab missed: a hidden tab receives no events, and a new connection repeats none of a trial. */
  #follow(status: StatusSnapshot | undefined): void {
    if (status === undefined) return;
    if (status.instanceId !== this.#instanceId) [this.#instanceId, this.#changedNs] = [status.instanceId, 0n]; // host time begins again at a boot
    const session = this.#sessionIn(status);
    const sessionId = session?.sessionId ?? '';
    if (includesEvent(status.hostTimeNs, this.#changedNs)) {
      const { trial = 0, attempt = 0, lastOutcome, lastTrial = 0, lastAttempt = 0 } = session?.trial ?? {};
      this.#present = { sessionId, trial, attempt };
      this.#void = lastOutcome === TrialOutcome.DONE ? undefined : { sessionId, trial: lastTrial, attempt: lastAttempt };
    }
    const shown = this.sway.peek()?.sway;
    // The page shows the result under the subject ID of this session.
    const isOfAnother = shown?.isPreliminary === false && (shown.sessionId !== sessionId || isSameAttempt(shown, this.#void));
    if (isOfAnother) this.#showSway(undefined);
    this.#showRecalled();
  }

  /** Running values describe the time before their event; the final ones the trial. */
  #spanOf(sway: Sway, timeMs: number): Steadiness['span'] {
    const { isPreliminary, durationS, windowS: longestS } = sway;
    return isPreliminary ? { fromMs: timeMs - 1000 * (durationS ?? longestS ?? 0), toMs: timeMs } : this.#measuredSpan(sway);
  }

  /** Returns the measurement of a result's attempt, or nothing if this tab did not see its begin and its end. */
  #measuredSpan(sway: Sway): Steadiness['span'] {
    const measured = this.#measured;
    return measured?.toMs !== undefined && isSameAttempt(sway, measured) ? { fromMs: measured.fromMs, toMs: measured.toMs } : undefined;
  }

  #showSway(next: Steadiness | undefined): void {
    batch(() => {
      this.sway.value = next;
      this.ellipse.value = this.#ellipseOf(next);
    });
  }

  #ellipseOf(shown: Steadiness | undefined): Ellipse | undefined {
    const area = shown?.values.get('PEA95_F');
    if (area === undefined || shown?.span === undefined || this.ring === undefined) return undefined;
    const ellipse = ellipseOf(this.ring, ml, ap, shown.span.fromMs, shown.span.toMs);
    return ellipse === undefined ? undefined : withArea(ellipse, area);
  }

  #addSway(sway: Sway, span: Steadiness['span']): void {
    const shown = this.sway.peek()?.sway;
    // The result of a trial stays until the next trial begins, or until a person steps on after the session.
    if (sway.isPreliminary && sway.trial === 0 && shown !== undefined && !shown.isPreliminary) return;
    const values = new Map(sway.measures.filter(({ value }) => Number.isFinite(value)).map(({ symbol, value }) => [symbol, value]));
    this.#showSway({ sway, values, span });
    if (!sway.isPreliminary) return;
    if (shown?.trial !== sway.trial || shown.attempt !== sway.attempt) this.sparks.clear();
    for (const symbol of ['MVELO', 'PEA95_F', 'RANGE_AP', 'RANGE_ML']) {
      const spark = this.sparks.get(symbol) ?? [];
      this.sparks.set(symbol, spark);
      spark.push(values.get(symbol) ?? NaN);
      if (spark.length > sparkLength) spark.shift();
    }
  }

  #addGap(gap: Gap): void {
    if (this.#rateHz > 0) this.absence.value = { back: instantNow(), seconds: Number(gap.missingScans) / this.#rateHz };
  }

  #updateNow(nowMs: number): void {
    if (nowMs - this.#updatedMs < slowEveryMs || this.ring === undefined) return;
    this.#updatedMs = nowMs;
    const { ring } = this;
    const last = ring.length - 1;
    this.now.value = {
      mlMm: last >= 0 ? ring.value(ml, last) : NaN,
      apMm: last >= 0 ? ring.value(ap, last) : NaN,
      loadKg: this.#loadN / gravity,
      quality: this.quality,
    };
  }

  #sessionIn(status: StatusSnapshot | undefined): SessionInfo | undefined {
    return status?.rigs.find(({ rig }) => rig?.name === this.#rig)?.session;
  }

  #isInSession(): boolean {
    return isActive(this.#sessionIn(this.#link.status.peek()));
  }
}

/** Returns which scans the values describe, in words: "last 12 s", "trial 1 so far", "trial 1". */
export const windowName = ({ isPreliminary, trial, window, durationS, windowS: longestS }: Sway, words: typeof strings.floor.windows): string => {
  if (!isPreliminary) return words.trial(whole(trial));
  if (window === SwayWindow.TRIAL || trial > 0) return words.soFar(whole(trial));
  return longestS === undefined ? words.standing : words.latest(whole(Math.ceil(durationS ?? longestS)));
};
