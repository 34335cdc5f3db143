// SPDX-License-Identifier: Apache-2.0
import { afterEach, beforeEach, expect, test, vi } from 'vitest';

import { DelayedStop } from './delayed_stop';

beforeEach(() => void vi.useFakeTimers());
afterEach(() => void vi.useRealTimers());

const openStop = () => {
  const send = vi.fn();
  return { send, stop: new DelayedStop(send) };
};

test('DelayedStop.IsSent after 5 s and not earlier, once', () => {
  const { send, stop } = openStop();

  stop.press();
  vi.advanceTimersByTime(4900);
  const early = [send.mock.calls.length, stop.leftS.value];
  vi.advanceTimersByTime(10_000);

  expect(early).toEqual([0, 1]);
  expect([send.mock.calls.length, stop.leftS.value]).toEqual([1, 0]);
});

test('DelayedStop.Undone is never sent, and can be wanted again', () => {
  const { send, stop } = openStop();

  stop.press();
  stop.undo();
  vi.advanceTimersByTime(10_000);
  const afterUndo = send.mock.calls.length;
  stop.press();
  vi.advanceTimersByTime(5000);

  expect([afterUndo, send.mock.calls.length]).toEqual([0, 1]);
});

test('DelayedStop.PressedAgain or flushed is sent at once; without a stop there is nothing to flush', () => {
  const { send, stop } = openStop();

  const flushedNothing = stop.flush();
  stop.press();
  stop.press();
  const afterPress = send.mock.calls.length;
  stop.press();
  const flushed = stop.flush();
  vi.advanceTimersByTime(10_000);

  expect([flushedNothing, afterPress, flushed, send.mock.calls.length]).toEqual([false, 1, true, 2]);
});
