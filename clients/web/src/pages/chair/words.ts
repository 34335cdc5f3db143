// SPDX-License-Identifier: Apache-2.0
// Words for the result of a reach.
import { ClassReason } from '../../generated/dts/v1/stream_pb';
import type { Reach, TrunkMovement } from '../../generated/dts/v1/stream_pb';
import { strings } from '../../strings';

const wordsOf = (bits: number, words: Readonly<Record<number, string>>): string[] =>
  Object.entries(words)
    .filter(([bit]) => (bits & Number(bit)) !== 0)
    .map(([, word]) => word);

export const reasonWords = (reasons: number): string[] => wordsOf(reasons, strings.chair.reasons);
export const flagWords = (flags: number): string[] => wordsOf(flags, strings.chair.flags);

/** Returns "moderate" and the like. A minor reach cannot be distinguished from one with the arm alone: "none or minor". */
export const classWord = (movement: TrunkMovement): string => {
  const { classes, uncertain } = strings.chair;
  const isMinor = (movement.reasons & ClassReason.MINOR) !== 0;
  if (movement.trunkClass === 1 && isMinor) return classes.noneOrMinor;
  return [classes.none, classes.minor, classes.moderate, classes.maximum][movement.trunkClass] ?? uncertain;
};

/** Returns why there is no class. The flags of the reach say more than the reason "reach doubtful". */
export const doubts = (movement: TrunkMovement, reach: Reach | undefined): string[] => {
  const ofReach = (movement.reasons & ClassReason.BAD_REACH) !== 0 ? flagWords(reach?.flags ?? 0) : [];
  return ofReach.length > 0 ? ofReach : reasonWords(movement.reasons & ~ClassReason.CALIBRATED);
};
