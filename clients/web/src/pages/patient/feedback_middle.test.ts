// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { SessionState, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import { fakeLink } from '../../testing';
import { LiveFloor } from '../floor/live_floor';
import { FeedbackMiddle } from './feedback_middle';

const channels = ['ml_mm', 'ap_mm', 'load_n'].map((name) => ({ name }));

/** A floor of 100 Hz on which a person stands: `stand(from, to, place)` delivers the scans of these seconds. */
const openFloor = () => {
  const fake = fakeLink([{ rig: { name: 'floor' } }]);
  const floor = new LiveFloor(fake.link, 'floor');
  const stand = (fromS: number, toS: number, [mlMm, apMm]: readonly [number, number]): void => {
    const [first, count] = [Math.round(fromS * 100), Math.round((toS - fromS) * 100)];
    const same = (value: number): number[] => new Array<number>(count).fill(value);
    fake.block('floor/cop', [same(mlMm), same(apMm), same(700)], { format: { channels }, firstScan: first, timeMs: first * 10, newestMs: (first + count - 1) * 10 });
  };
  const trial = (step: TrialEventKind, atS: number, number = 1): void =>
    fake.event('floor/trial', { body: { case: 'trial', value: { sessionId: 's1', step, trial: number, attempt: 1 } } }, atS * 1000);
  return { fake, floor, stand, trial };
};
const nobody = [NaN, NaN] as const;

test('FeedbackMiddle.Is the mean of the last second of settling, however long a person stood elsewhere before', () => {
  const { floor, stand, trial } = openFloor();
  const middle = new FeedbackMiddle(floor, 's1', 1, 1);
  stand(0, 4, [100, 0]);
  stand(4, 5, [42, -20]);
  trial(TrialEventKind.MEASURE, 5);
  expect(middle.whileMeasured()).toBeUndefined(); // the scan at the beginning is still to come
  stand(5, 5.1, [60, 10]);

  expect(middle.whileMeasured()).toEqual({ mlMm: 42, apMm: -20 });
});

test('FeedbackMiddle.Stays the same after a gap, wherever the person stands then', () => {
  const { floor, stand, trial } = openFloor();
  const middle = new FeedbackMiddle(floor, 's1', 1, 1);
  stand(0, 5, [42, -20]);
  trial(TrialEventKind.MEASURE, 5);
  stand(5, 5.1, [42, -20]);
  middle.whileMeasured();
  stand(9, 90, [10, 10]); // the ring no longer holds the settling

  expect(middle.whileMeasured()).toEqual({ mlMm: 42, apMm: -20 });
});

test('FeedbackMiddle.Is of the first whole second if there is a gap in the last second of settling', () => {
  const { floor, stand, trial } = openFloor();
  const middle = new FeedbackMiddle(floor, 's1', 1, 1);
  stand(0, 4.5, [42, -20]);
  trial(TrialEventKind.MEASURE, 5);
  stand(5.5, 6, nobody);
  stand(6, 7, [7, 3]);
  expect(middle.whileMeasured()).toBeUndefined();
  stand(7, 7.1, [7, 3]);

  expect(middle.whileMeasured()).toEqual({ mlMm: 7, apMm: 3 });
});

test('FeedbackMiddle.A screen that was opened in the trial uses the first second that it saw', () => {
  const { floor, stand } = openFloor();
  const middle = new FeedbackMiddle(floor, 's1', 1, 1);
  stand(0, 5, [100, 100]);
  expect(middle.whileMeasured()).toBeUndefined();
  stand(5, 5.99, [42, -20]);
  expect(middle.whileMeasured()).toBeUndefined();
  stand(5.99, 8, [5, 5]);

  expect(middle.whileMeasured()).toEqual({ mlMm: (100 + 99 * 42) / 100, apMm: (100 - 99 * 20) / 100 }); // one scan was there when it was opened
});

test('FeedbackMiddle.Knows its own attempt and session only', () => {
  const { fake, floor, stand, trial } = openFloor();
  stand(0, 5, [42, -20]);
  trial(TrialEventKind.MEASURE, 5);
  stand(5, 9, [1, 2]);
  expect(new FeedbackMiddle(floor, 's1', 2, 1).whileMeasured()).toBeUndefined();
  expect(new FeedbackMiddle(floor, 's1', 1, 2).whileMeasured()).toBeUndefined();
  expect(new FeedbackMiddle(floor, 's2', 1, 1).whileMeasured()).toBeUndefined(); // also if the event of its start was missed
  fake.event('floor/session', { body: { case: 'session', value: { state: SessionState.STARTING } } });

  expect(new FeedbackMiddle(floor, 's1', 1, 1).whileMeasured()).toBeUndefined();
});
