// SPDX-License-Identifier: Apache-2.0
// What the page knows of one platform: pictures read the rings as they paint, everything slow is a signal.
import { batch, signal } from '@preact/signals';

import { Quality, SessionState, SwayFlag, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import type { Gap, Sway } from '../../generated/dts/v1/stream_pb';
import type { Block, Link, LiveEvent } from '../../link/types';
import { ScanRing } from '../../parts/scan_ring';
import type { Ellipse } from './ellipse';
import { ellipseOf } from './ellipse';
import { isActive } from './session_controls';

export const windowS = 20;
export const trailS = 5;
const fastestHz = 2000; // a faster stream is not a platform's
const slowEveryMs = 250;
const gravity = 9.80665; // N of a kg, as scales are marked
const sparkLength = 120; // a minute at two a second

/** Columns of the ring. */
export const ml = 0;
export const ap = 1;

export interface Steadiness {
  readonly sway: Sway;
  readonly values: ReadonlyMap<string, number>;
}

/** Values for text and tiles, at most four times a second. */
export interface Now {
  readonly mlMm: number;
  readonly apMm: number;
  readonly loadKg: number;
  readonly quality: number;
  readonly ellipse: Ellipse | undefined;
}

const nothing: Now = { mlMm: NaN, apMm: NaN, loadKg: NaN, quality: Quality.UNSPECIFIED, ellipse: undefined };

/** How long the stream was away, from the gap's own count. */
export interface Absence {
  readonly backAt: number; // Date.now()
  readonly seconds: number;
}

export class LiveFloor {
  readonly now = signal<Now>(nothing);
  readonly sway = signal<Steadiness | undefined>(undefined);
  readonly absence = signal<Absence | undefined>(undefined);
  /** Markers of the window, for flags: bounded. */
  readonly markers: { readonly timeMs: number; readonly text: string }[] = [];
  readonly sparks = new Map<string, number[]>();

  ring: ScanRing | undefined;
  newestMs = NaN;
  quality = 0;
  /** Newest deflection and quality of each sensor. */
  deflectionMm: number[] = [];
  sensorQuality: number[] = [];
  /** When what counts of the trial under way began; NaN: no trial is measured. */
  trialFromMs = NaN;

  #rateHz = 0;
  #loadN = NaN;
  #toldMs = 0;
  readonly #link: Link;
  readonly #rig: string;
  readonly #stops: (() => void)[];

  constructor(link: Link, rig: string) {
    [this.#link, this.#rig] = [link, rig];
    const topics = ['cop', 'deflection', 'sway', 'gap', 'marker', 'trial', 'session'].map((name) => `${rig}/${name}`);
    this.#stops = [
      link.onBlock(`${rig}/cop`, (block) => this.#takeCop(block)),
      link.onBlock(`${rig}/deflection`, (block) => this.#takeDeflection(block)),
      link.onEvent(`${rig}/`, (event) => this.#takeEvent(event)),
      link.onPaint((nowMs) => this.#tellNow(nowMs)),
      link.subscribe(topics),
    ];
  }

  close(): void {
    for (const stop of this.#stops) stop();
  }

  /** A final result from the catalogue, as if it came just now. */
  recall(sway: Sway): void {
    this.#takeSway(sway);
  }

  #takeCop(block: Block): void {
    const column = (name: string): number => block.format.channels.findIndex((channel) => channel.name === name);
    const [mlColumn, apColumn, loadColumn] = [column('ml_mm'), column('ap_mm'), column('load_n')];
    if (mlColumn < 0 || apColumn < 0) return;
    if (this.ring === undefined || this.#rateHz !== block.rateHz) {
      this.#rateHz = block.rateHz;
      this.ring = new ScanRing(2, Math.ceil(Math.min(block.rateHz, fastestHz) * (windowS + 2)));
    }
    this.ring.push(block, [mlColumn, apColumn]);
    this.newestMs = block.newestMs;
    const wasEmpty = (this.quality & Quality.NO_CONTACT) !== 0;
    this.quality = (block.quality[mlColumn] ?? 0) | (block.quality[apColumn] ?? 0);
    // Who steps on after a session may be another person: the former one's results are not theirs.
    if (wasEmpty && (this.quality & Quality.NO_CONTACT) === 0 && !this.#isInSession()) this.sway.value = undefined;
    this.#loadN = block.columns[loadColumn]?.[block.scanCount - 1] ?? NaN;
  }

  #takeDeflection(block: Block): void {
    for (let sensor = 0; sensor < block.columns.length; sensor += 1) {
      this.deflectionMm[sensor] = block.columns[sensor]![block.scanCount - 1]!;
      this.sensorQuality[sensor] = block.quality[sensor]!;
    }
  }

  #takeEvent({ timeMs, event }: LiveEvent): void {
    const { body } = event;
    switch (body.case) {
      case 'sway':
        return this.#takeSway(body.value);
      case 'gap':
        return this.#takeGap(body.value);
      case 'marker':
        this.markers.push({ timeMs, text: body.value.text });
        if (this.markers.length > 50) this.markers.shift();
        return;
      case 'trial':
        return this.#takeTrial(body.value.step, timeMs);
      case 'session':
        if (body.value.state === SessionState.IDLE || body.value.state === SessionState.STARTING) this.trialFromMs = NaN;
        if (body.value.state === SessionState.STARTING) this.sway.value = undefined;
        return;
    }
  }

  #takeTrial(kind: TrialEventKind, timeMs: number): void {
    if (kind === TrialEventKind.MEASURE) this.trialFromMs = timeMs;
    else this.trialFromMs = NaN;
    if (kind === TrialEventKind.READY || kind === TrialEventKind.GO) this.sway.value = undefined;
  }

  #takeSway(sway: Sway): void {
    const shown = this.sway.peek()?.sway;
    // The result of a trial stands until the next one begins, or somebody steps on after the session.
    if (sway.isPreliminary && sway.trial === 0 && shown !== undefined && !shown.isPreliminary) return;
    const values = new Map(sway.measures.filter(({ value }) => Number.isFinite(value)).map(({ symbol, value }) => [symbol, value]));
    this.sway.value = { sway, values };
    if (!sway.isPreliminary) return;
    if (shown?.trial !== sway.trial || shown.attempt !== sway.attempt) this.sparks.clear();
    for (const symbol of ['MVELO', 'PEA95_F', 'RANGE_AP', 'RANGE_ML']) {
      const spark = this.sparks.get(symbol) ?? [];
      this.sparks.set(symbol, spark);
      spark.push(values.get(symbol) ?? NaN);
      if (spark.length > sparkLength) spark.shift();
    }
  }

  #takeGap(gap: Gap): void {
    if (this.#rateHz > 0) this.absence.value = { backAt: Date.now(), seconds: Number(gap.missingScans) / this.#rateHz };
  }

  #tellNow(nowMs: number): void {
    if (nowMs - this.#toldMs < slowEveryMs || this.ring === undefined) return;
    this.#toldMs = nowMs;
    const { ring } = this;
    const last = ring.length - 1;
    batch(() => {
      this.now.value = {
        mlMm: last >= 0 ? ring.value(ml, last) : NaN,
        apMm: last >= 0 ? ring.value(ap, last) : NaN,
        loadKg: this.#loadN / gravity,
        quality: this.quality,
        ellipse: (this.quality & Quality.NO_CONTACT) !== 0 ? undefined : ellipseOf(ring, ml, ap, this.#ellipseFromMs()),
      };
    });
  }

  #isInSession(): boolean {
    return isActive(this.#link.status.peek()?.rigs.find(({ rig }) => rig?.name === this.#rig)?.session);
  }

  /** A trial's ellipse is of the trial alone. */
  #ellipseFromMs(): number {
    const windowMs = this.newestMs - 1000 * windowS;
    return this.trialFromMs > windowMs ? this.trialFromMs : windowMs;
  }
}

export const invalidBecause = (flags: number, words: { steppedOff: string; moved: string }): string =>
  [(flags & SwayFlag.STEPPED_OFF) !== 0 ? words.steppedOff : '', (flags & SwayFlag.MOVED) !== 0 ? words.moved : ''].filter((word) => word !== '').join(', ');
