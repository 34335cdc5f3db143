// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionInfoSchema } from '../../generated/dts/v1/control_pb';
import { SessionRecordSchema, TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { SessionState, SwaySchema } from '../../generated/dts/v1/stream_pb';
import { missingResult, resultOf } from './recall';

const session = (phase: TrialPhase, state = SessionState.RUNNING, trial = 2) =>
  create(SessionInfoSchema, { sessionId: 's1', state, trial: { phase, trial, attempt: 1 } });
const sway = (sessionId: string, trial: number, isPreliminary = false) => create(SwaySchema, { sessionId, trial, attempt: 1, isPreliminary });
const missing = { sessionId: 's1', trial: 2, attempt: 1 };

test.each([TrialPhase.WAITING, TrialPhase.RESTING, TrialPhase.FINISHED])('missingResult.TabLoadedAnew in phase %i lacks the result of the last trial', (phase) => {
  expect(missingResult(session(phase), undefined)).toEqual(missing);
});

test.each([
  ['running values', sway('', 0, true)],
  ['the trial before', sway('s1', 1)],
  ['another session', sway('s0', 2)],
])('missingResult.Tab that shows %s lacks it as well', (_name, shown) => {
  expect(missingResult(session(TrialPhase.WAITING), shown)).toEqual(missing);
});

test('missingResult.Nothing is missing while it is shown, during a trial, before the first, or after the session', () => {
  const all = [
    missingResult(session(TrialPhase.WAITING), sway('s1', 2)),
    missingResult(session(TrialPhase.MEASURING), undefined),
    missingResult(session(TrialPhase.WAITING, SessionState.RUNNING, 0), undefined),
    missingResult(session(TrialPhase.FINISHED, SessionState.IDLE), undefined),
    missingResult(undefined, undefined),
  ];

  expect(all).toEqual(all.map(() => undefined));
});

test('resultOf.Attempt is found; one that was rejected, or has no result, has none', () => {
  const record = create(SessionRecordSchema, {
    trials: [
      { trial: 1, attempt: 1, outcome: 'done' },
      { trial: 2, attempt: 1, outcome: 'done', sway: sway('s1', 2) },
      { trial: 3, attempt: 1, outcome: 'rejected', sway: sway('s1', 3) },
    ],
  });

  const found = [1, 2, 3, 4].map((trial) => resultOf(record, { ...missing, trial })?.trial);

  expect(found).toEqual([undefined, 2, undefined, undefined]);
});
