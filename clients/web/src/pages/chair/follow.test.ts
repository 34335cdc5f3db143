// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { SessionState, TrialEventKind } from '../../generated/dts/v1/stream_pb';
import { fakeLink, runHook } from '../../testing';
import { useFollowed } from './follow';

const { READY, GO, DONE, REST, REDONE, REJECTED } = TrialEventKind;

const answered = (): Promise<void> => new Promise((resolve) => void setTimeout(resolve));

const openChair = () => {
  const fake = fakeLink();
  fake.link.send.mockImplementation(async ({ value: { sessionId } }) => ({ case: 'sessionRecord', value: { trials: [{ trial: 1, condition: sessionId }] } }));
  const { now, draw } = runHook(() => useFollowed(fake.link, 'chair'));
  fake.block('chair/transient', [Array.from({ length: 400 }, (_, scan) => scan)]);
  const trial = (kind: TrialEventKind, number = 1, sessionId = 's1'): void => {
    fake.event('chair/trial', { scan: 200n, body: { case: 'trial', value: { sessionId, step: kind, trial: number, attempt: 1, condition: '120', restS: 5 } } }, 1000);
    draw();
  };
  const lines = (): number[] => now().ghosts.of('120').map((ghost) => ghost.trial);
  return { ...fake, now, draw, trial, lines };
};

test.each([
  ['DoneAfterGo is kept', [READY, GO, DONE], 1, [1]],
  ['DoneWithoutGo has no line', [READY, DONE], 1, []],
  ['DoneOfAnother is not it', [READY, GO, DONE], 2, []],
  ['Redone is no trial', [READY, GO, DONE, REDONE], 1, []],
  ['Rejected is no trial', [READY, GO, DONE, REJECTED], 1, []],
  ['Rest keeps it', [READY, GO, DONE, REST], 1, [1]],
])('useFollowed.%s', (_, kinds, last, expected) => {
  const { trial, lines } = openChair();

  kinds.forEach((kind, i) => trial(kind, i < 2 ? 1 : last));

  expect(lines()).toEqual(expected);
});

test('useFollowed.Another session forgets the lines and loads its own trials', async () => {
  const { now, trial, lines } = openChair();
  [READY, GO, DONE].forEach((kind) => trial(kind));
  await answered();
  const before = now().trials.value.map(({ condition }) => condition);

  trial(READY, 1, 's2');
  const between = now().trials.value;
  await answered();

  expect([before, between, lines()]).toEqual([['s1'], [], []]);
  expect(now().trials.value.map(({ condition }) => condition)).toEqual(['s2']);
});

test('useFollowed.Rest is counted down in whole seconds; the status names the session', () => {
  const { now, draw, trial, paint, link } = openChair();
  trial(READY);
  trial(REST);

  const left = [1000, 5001, 6500].map((nowMs) => (paint(nowMs), now().restS.value));
  link.status.value = { ...link.status.value, hostTimeNs: 9n, rigs: [{ rig: { name: 'chair' }, session: { sessionId: 's3', state: SessionState.RUNNING } }] } as never;
  draw();

  expect(left).toEqual([5, 1, 0]);
  expect(now().examination.value.sessionId).toBe('s3');
});
