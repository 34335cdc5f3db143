// SPDX-License-Identifier: Apache-2.0
// Consistency: the spread of the trunk angle per target, and the thesis's range beside it.
import type { TrialRecord } from '../../generated/dts/v1/sessions_pb';
import type { TrunkMovement } from '../../generated/dts/v1/stream_pb';

/** Trunk flexion of ten healthy volunteers per trunk class (lowest, mean, highest): thesis Table 6.3. */
export const thesisWindows = [
  { trunkClass: 1, lowDeg: 0.4, meanDeg: 4.1, highDeg: 9.9 },
  { trunkClass: 2, lowDeg: 20.6, meanDeg: 29.2, highDeg: 36.4 },
  { trunkClass: 3, lowDeg: 48.0, meanDeg: 54.3, highDeg: 61.4 },
] as const;
export type ThesisWindow = (typeof thesisWindows)[number];

export const windowOf = (expectedClass: number): ThesisWindow | undefined => thesisWindows.find((window) => window.trunkClass === expectedClass);

export interface TargetSummary {
  readonly condition: string;
  readonly targetCm: number;
  readonly trials: number; // with outcome "done"
  readonly withAngle: number;
  readonly meanDeg: number; // NaN without an angle
  readonly sdDeg: number; // NaN with fewer than two angles
  readonly window: ThesisWindow | undefined;
}

export const mean = (values: readonly number[]): number => values.reduce((sum, value) => sum + value, 0) / values.length;

/** Returns the standard deviation of a sample (divided by n - 1), or NaN for fewer than two values. */
export const standardDeviation = (values: readonly number[]): number => {
  if (values.length < 2) return Number.NaN;
  const centre = mean(values);
  return Math.sqrt(values.reduce((sum, value) => sum + (value - centre) ** 2, 0) / (values.length - 1));
};

/** Returns whether a trial counts. Redone, rejected and aborted trials stay in the record but are in no result. */
export const counts = (trial: TrialRecord): boolean => trial.outcome === 'done';

/** Returns the trunk angle, or nothing if the class was rejected: the angle would be a guess. */
export const angleIn = (movement: TrunkMovement | undefined): number | undefined =>
  movement !== undefined && movement.trunkClass >= 0 && Number.isFinite(movement.trunkDeg) ? movement.trunkDeg : undefined;
export const angleOf = (trial: TrialRecord): number | undefined => angleIn(trial.result?.movement);

const summarise = (condition: string, trials: readonly TrialRecord[]): TargetSummary => {
  const angles = trials.map(angleOf).filter((angle) => angle !== undefined);
  const results = trials.map((trial) => trial.result).filter((result) => result !== undefined);
  return {
    condition,
    targetCm: results[0]?.targetCm ?? 0,
    trials: trials.length,
    withAngle: angles.length,
    meanDeg: mean(angles),
    sdDeg: standardDeviation(angles),
    window: windowOf(results.find((result) => (result.expectedClass ?? -1) > 0)?.expectedClass ?? -1),
  };
};

/** Returns one summary per target, the nearest first. */
export const byTarget = (trials: readonly TrialRecord[]): TargetSummary[] => {
  const groups = new Map<string, TrialRecord[]>();
  for (const trial of trials.filter(counts)) groups.set(trial.condition, [...(groups.get(trial.condition) ?? []), trial]);
  return [...groups].map(([condition, group]) => summarise(condition, group)).sort((one, other) => one.targetCm - other.targetCm);
};
