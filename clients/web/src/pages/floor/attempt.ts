// SPDX-License-Identifier: Apache-2.0

/** One attempt at a trial of a session. */
export interface Attempt {
  readonly sessionId: string;
  readonly trial: number;
  readonly attempt: number;
}

/** Returns whether two are the same attempt. Running values have no attempt number: they are never of the same one. */
export const isSameAttempt = (one: Partial<Attempt> | undefined, other: Attempt | undefined): boolean =>
  other !== undefined && one?.sessionId === other.sessionId && one.trial === other.trial && one.attempt === other.attempt;
