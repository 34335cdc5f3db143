// SPDX-License-Identifier: Apache-2.0

interface Answer {
  readonly offsetMs: number; // host time minus browser time
  readonly roundTripMs: number;
}

/**
 * Maps times of the daemon's host to this browser's performance.now(), as NTP does it: the host read its clock somewhere between our question
 * and its answer, so the shortest of the last few round trips knows best, to half its length. "The last few", since the two clocks may drift.
 */
export class HostClock {
  static readonly #kept = 8;
  #answers: Answer[] = [];
  #best: Answer | undefined;

  get isKnown(): boolean {
    return this.#best !== undefined;
  }

  /** NaN while unknown. */
  get errorMs(): number {
    return this.#best === undefined ? NaN : this.#best.roundTripMs / 2;
  }

  /** False: the answer makes no sense and changed nothing. */
  answered(askedMs: number, hostTimeNs: bigint, nowMs: number): boolean {
    const roundTripMs = nowMs - askedMs;
    if (!(roundTripMs >= 0) || hostTimeNs <= 0n) return false;
    this.#answers.push({ offsetMs: Number(hostTimeNs) / 1e6 - (askedMs + nowMs) / 2, roundTripMs });
    if (this.#answers.length > HostClock.#kept) this.#answers.shift();
    this.#best = this.#answers.reduce((best, answer) => (answer.roundTripMs <= best.roundTripMs ? answer : best));
    return true;
  }

  /** NaN while unknown. */
  toBrowserMs(hostTimeNs: bigint): number {
    return this.#best === undefined ? NaN : Number(hostTimeNs) / 1e6 - this.#best.offsetMs;
  }

  forget(): void {
    this.#answers = [];
    this.#best = undefined;
  }
}
