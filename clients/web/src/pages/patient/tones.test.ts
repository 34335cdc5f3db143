// SPDX-License-Identifier: Apache-2.0
import { expect, test, vi } from 'vitest';

import type { ScreenState } from './screen_state';
import { ToneRule, Tones } from './tones';

const tonesOf = (...states: ScreenState[]): string => {
  const rule = new ToneRule();
  return states.map((state) => rule.next(state) ?? '-').join(' ');
};

test.each<[string, ScreenState[], string]>([
  ['Chair', ['wait', 'ready', 'go', 'back', 'rest', 'ready', 'go', 'done'], '- - start - end - start end'],
  ['Floor: none between settling and measuring', ['wait', 'settle', 'measure', 'rest'], '- start - end'],
  ['OpenedInATrial', ['measure', 'rest'], '- end'],
  ['SteppedOff: the trial goes on', ['settle', 'nobody', 'measure', 'rest'], '- - - end'],
  ['Redo: no end, and another start', ['go', 'ready', 'go'], '- - start'],
  ['DataLost: the moment is missed', ['measure', 'noData', 'rest'], '- - -'],
])('ToneRule.%s', (_, states, expected) => {
  expect(tonesOf(...states)).toBe(expected);
});

test('Tones.Plays nothing before a press, and nothing if the browser does not allow it', async () => {
  const started: number[] = [];
  let state = 'suspended';
  const node = { connect: () => node, gain: { setValueAtTime: vi.fn(), linearRampToValueAtTime: vi.fn() } };
  const context = {
    get state() {
      return state;
    },
    resume: vi.fn(),
    close: vi.fn(),
    createGain: () => node,
    createOscillator: () => {
      const frequency = { value: 0 };
      return { ...node, frequency, start: () => started.push(frequency.value), stop: vi.fn() };
    },
  };
  vi.stubGlobal('AudioContext', function AudioContext() {
    return context;
  });
  const tones = new Tones();

  tones.play('start');
  await tones.turnOn();
  expect([tones.isOn.value, started]).toEqual([false, []]);

  state = 'running';
  await tones.turnOn();
  tones.play('end');
  expect([tones.isOn.value, started]).toEqual([true, [880, 440]]);

  tones.turnOff();
  tones.play('end');
  tones.close();
  expect(started.length).toBe(2);
  expect(context.close).toHaveBeenCalled();
});
