// SPDX-License-Identifier: Apache-2.0
// A person on a chair, from the side: before a reach with the target, after it with how much the trunk helped.
import type { JSX } from 'preact';

import type { TrunkMovement } from '../../generated/dts/v1/stream_pb';
import { ClassReason } from '../../generated/dts/v1/stream_pb';
import { fixed } from '../../parts/numbers';
import { strings } from '../../strings';
import { angleIn } from '../chair/consistency';

const words = strings.patient.helped;
const trunk = 100;
const shoulderAt = 0.92; // of the trunk, from the hip
const arm = 75;
const mostDeg = 90;

/** Returns how much the trunk helped, in words for the patient. Without a class, "not certain" is the result. */
export const helpedWords = (movement: TrunkMovement): string => {
  const isMinor = (movement.reasons & ClassReason.MINOR) !== 0;
  if (movement.trunkClass === 1 && isMinor) return words.noneOrMinor;
  return [words.none, words.minor, words.moderate, words.maximum][movement.trunkClass] ?? words.uncertain;
};

interface Point {
  readonly x: number;
  readonly y: number;
}

/** Returns a point on the trunk; the hip is at (0, 0), the target to the right. */
const onTrunk = (deg: number, share: number): Point => {
  const angle = (Math.min(mostDeg, Math.max(0, deg)) * Math.PI) / 180;
  return { x: share * trunk * Math.sin(angle), y: -share * trunk * Math.cos(angle) };
};

/** Returns the hand of an arm that points from the shoulder to the target. */
const handTowards = (shoulder: Point, target: Point): Point => {
  const far = Math.hypot(target.x - shoulder.x, target.y - shoulder.y) || 1;
  const share = Math.min(1, arm / far);
  return { x: shoulder.x + share * (target.x - shoulder.x), y: shoulder.y + share * (target.y - shoulder.y) };
};

const line = (name: string, points: readonly Point[]): JSX.Element => (
  <polyline class={name} points={points.map(({ x, y }) => `${x.toFixed(1)},${y.toFixed(1)}`).join(' ')} />
);

interface ReachPictureProps {
  /** Of the target, in percent of the arm length; undefined: unknown or no target. */
  percent: number | undefined;
  /** Undefined: no reach to show. */
  movement: TrunkMovement | undefined;
  isWithoutReach: boolean;
}

export const ReachPicture = ({ percent, movement, isWithoutReach }: ReachPictureProps): JSX.Element => {
  const deg = angleIn(movement);
  const hasResult = movement !== undefined || isWithoutReach;
  const helped = movement !== undefined ? helpedWords(movement) : isWithoutReach ? words.noReach : '';
  const angle = deg === undefined ? '' : strings.patient.angle(fixed(deg, 0));
  const shoulder = onTrunk(deg ?? 0, shoulderAt);
  const upright = onTrunk(0, shoulderAt);
  const target = { x: upright.x + (Math.min(200, percent ?? 120) / 100) * arm, y: upright.y + 20 };
  const hand = deg === undefined ? { x: 58, y: -14 } : handTowards(shoulder, target);
  const head = onTrunk(deg ?? 0, 1.2);
  const trunkClass = movement === undefined || movement.trunkClass < 0 ? 'none' : String(movement.trunkClass);
  return (
    <div class="patient-reach" data-testid="patient-reach" data-class={hasResult ? trunkClass : ''}>
      <svg viewBox="-60 -150 290 235" role="img" aria-label={hasResult ? strings.patient.picture.trunk([helped, angle].join(' ')) : strings.patient.picture.reach}>
        <path class="patient-chair" d="M -34 -70 L -26 12 L 52 12 M -20 12 L -20 80 M 44 12 L 44 80" />
        {line('patient-body', [{ x: 0, y: 0 }, { x: 66, y: 2 }, { x: 68, y: 76 }, { x: 86, y: 78 }])}
        {deg !== undefined && deg > 0 && line('patient-upright', [{ x: 0, y: 0 }, onTrunk(0, 1)])}
        {line('patient-trunk', [{ x: 0, y: 0 }, onTrunk(deg ?? 0, 1)])}
        <circle class="patient-head" cx={head.x} cy={head.y} r="15" />
        {percent !== undefined && <circle class="patient-goal" cx={target.x} cy={target.y} r="11" />}
        {line('patient-arm', [shoulder, hand])}
      </svg>
      {hasResult && (
        <p class="patient-helped">
          <span data-testid="patient-helped">{helped}</span>
          {angle !== '' && ', '}
          {angle !== '' && <span data-testid="patient-angle">{angle}</span>}
        </p>
      )}
    </div>
  );
};
