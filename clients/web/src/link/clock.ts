// SPDX-License-Identifier: Apache-2.0

interface Answer {
  readonly offsetMs: number; // host time minus browser time
  readonly roundTripMs: number;
}

/**
 * Converts times of the daemon's host to this browser's performance.now(), like NTP: the host read its clock between our request and its answer, so
 * the shortest round trip is the most exact, to half its length. Only the last few round trips count, because the two clocks drift.
 */
export class HostClock {
  static readonly #kept = 8;
  #answers: Answer[] = [];
  #best: Answer | undefined;

  get isKnown(): boolean {
    return this.#best !== undefined;
  }

  /** NaN while the offset is unknown. */
  get errorMs(): number {
    return this.#best === undefined ? NaN : this.#best.roundTripMs / 2;
  }

  /** Adds an answer. Returns false and changes nothing if its times are impossible. */
  answered(askedMs: number, hostTimeNs: bigint, nowMs: number): boolean {
    const roundTripMs = nowMs - askedMs;
    if (!(roundTripMs >= 0) || hostTimeNs <= 0n) return false;
    this.#answers.push({ offsetMs: Number(hostTimeNs) / 1e6 - (askedMs + nowMs) / 2, roundTripMs });
    if (this.#answers.length > HostClock.#kept) this.#answers.shift();
    this.#best = this.#answers.reduce((best, answer) => (answer.roundTripMs <= best.roundTripMs ? answer : best));
    return true;
  }

  /** Returns a host time in ms of performance.now(), or NaN while the offset is unknown. */
  toBrowserMs(hostTimeNs: bigint): number {
    return this.#best === undefined ? NaN : Number(hostTimeNs) / 1e6 - this.#best.offsetMs;
  }

  forget(): void {
    this.#answers = [];
    this.#best = undefined;
  }
}
