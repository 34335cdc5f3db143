// SPDX-License-Identifier: Apache-2.0
// The result of a reach: the trunk class in three steps, and the trunk angle with its interval. "Uncertain" is a result, not an error.
import type { JSX } from 'preact';

import { fixed, percent } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Reach, TrunkMovement } from '../../generated/dts/v1/stream_pb';
import { ClassReason } from '../../generated/dts/v1/stream_pb';
import { angleIn } from './consistency';
import { classWord, doubts } from './words';

interface ReachResult {
  movement: TrunkMovement | undefined;
  reach: Reach | undefined;
  expectedClass: number;
  isWithoutReach: boolean;
  hasGap: boolean;
  /** The result belongs to the last trial, and the next one is about to begin. */
  isOfLastTrial: boolean;
  isGuiding: boolean;
}

const ClassStep = ({ movement, trunkClass }: { movement: TrunkMovement | undefined; trunkClass: 1 | 2 | 3 }): JSX.Element => {
  const { classes } = strings.chair;
  const isFound = movement?.trunkClass === trunkClass;
  const word = [classes.minor, classes.moderate, classes.maximum][trunkClass - 1];
  return (
    <li class={`chair-step chair-step-${trunkClass}${isFound ? ' chair-step-on' : ''}`} aria-current={isFound ? 'true' : undefined}>
      <span class="chair-step-bar" aria-hidden="true">
        {isFound ? '●' : ''}
      </span>
      <span class="chair-step-word">{word}</span>
      <span data-testid={`class-probability-${trunkClass}`}>
        {movement === undefined ? strings.common.undefinedValue : `${percent(movement.probability[trunkClass - 1])} %`}
      </span>
    </li>
  );
};

const sentence = ({ movement, reach, expectedClass, isWithoutReach, hasGap, isGuiding }: ReachResult): string => {
  const { result, classes } = strings.chair;
  if (hasGap) return isGuiding ? result.gapHint : '';
  if (isWithoutReach) return expectedClass === 0 ? result.asExpected : isGuiding ? result.noReachHint : '';
  if (movement === undefined) return result.pending;
  if (movement.trunkClass < 0) return doubts(movement, reach).join(', ');
  const expected = [classes.none, classes.minor, classes.moderate, classes.maximum][expectedClass];
  const calibrated = (movement.reasons & ClassReason.CALIBRATED) !== 0 ? result.calibrated : '';
  const comparison = expected === undefined ? '' : movement.trunkClass === expectedClass ? result.asExpected : result.expected(expected);
  return [comparison, calibrated].filter((part) => part !== '').join('; ');
};

export const ClassResult = (result: ReachResult): JSX.Element => {
  const { movement, isWithoutReach, hasGap } = result;
  const words = strings.chair.result;
  const noReach = hasGap ? strings.common.outcomes.noValues : words.noReach;
  const word = isWithoutReach ? noReach : movement === undefined ? strings.common.undefinedValue : classWord(movement);
  return (
    <section class="chair-class" aria-labelledby="chair-class-head">
      <h2 id="chair-class-head">{result.isOfLastTrial ? words.trunkClassBefore : words.trunkClass}</h2>
      <div class="chair-class-word" data-testid="trunk-class" aria-live="polite">
        {word}
      </div>
      <ol class="chair-steps">
        <ClassStep movement={movement} trunkClass={1} />
        <ClassStep movement={movement} trunkClass={2} />
        <ClassStep movement={movement} trunkClass={3} />
      </ol>
      <p class="chair-sentence" data-testid="class-sentence">
        {sentence(result)}
      </p>
    </section>
  );
};

const radius = 150;
const most = 90;

/** Returns a point on the trunk that bends `deg` forward, seen from its right side; the hip is at (0, 0). */
const place = (deg: number, at: number): string => {
  const angle = (Math.min(most, Math.max(0, deg)) * Math.PI) / 180;
  return `${(at * Math.sin(angle)).toFixed(1)} ${(-at * Math.cos(angle)).toFixed(1)}`;
};
const arc = (fromDeg: number, toDeg: number, at: number): string => `M ${place(fromDeg, at)} A ${at} ${at} 0 0 1 ${place(toDeg, at)}`;

export const AngleGauge = ({ movement, isOfLastTrial }: Pick<ReachResult, 'movement' | 'isOfLastTrial'>): JSX.Element => {
  const words = strings.chair.result;
  const deg = angleIn(movement);
  const interval =
    movement !== undefined && deg !== undefined ? words.interval(fixed(movement.trunkLoDeg, 0), fixed(movement.trunkHiDeg, 0)) : '';
  return (
    <section class="chair-angle" aria-labelledby="chair-angle-head">
      <h2 id="chair-angle-head">{isOfLastTrial ? words.angleBefore : words.angle}</h2>
      <div class="chair-angle-value">
        <span data-testid="trunk-deg">{fixed(deg, 1)}</span>
        <span class="unit">°</span>
      </div>
      <p data-testid="trunk-interval">{interval}</p>
      <svg class="chair-gauge" viewBox="-26 -186 214 212" aria-hidden="true">
        <path class="chair-gauge-scale" d={arc(0, most, radius)} />
        {[0, 30, 60, 90].map((tick) => (
          <g key={tick}>
            <path class="chair-gauge-tick" d={`M ${place(tick, radius - 8)} L ${place(tick, radius + 4)}`} />
            <text x={place(tick, radius + 18).split(' ')[0]} y={place(tick, radius + 18).split(' ')[1]}>
              {tick}
            </text>
          </g>
        ))}
        {movement !== undefined && deg !== undefined && (
          <g>
            <path class="chair-gauge-interval" d={arc(movement.trunkLoDeg ?? deg, movement.trunkHiDeg ?? deg, radius - 22)} />
            <path class="chair-gauge-trunk" d={`M 0 0 L ${place(deg, radius - 8)}`} />
          </g>
        )}
        <circle class="chair-gauge-hip" cx="0" cy="0" r="9" />
      </svg>
    </section>
  );
};
