// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import type { SessionInfo } from '../../generated/dts/v1/control_pb';
import { SessionInfoSchema } from '../../generated/dts/v1/control_pb';
import { SessionRecordSchema, TrialPhase } from '../../generated/dts/v1/sessions_pb';
import type { Sway } from '../../generated/dts/v1/stream_pb';
import { SessionState, SwaySchema } from '../../generated/dts/v1/stream_pb';
import { missingResult, resultOf } from './recall';

const session = (phase: TrialPhase, state = SessionState.RUNNING, trial = 2) =>
  create(SessionInfoSchema, { sessionId: 's1', state, trial: { phase, trial, attempt: 1 } });
const sway = (sessionId: string, trial: number, isPreliminary = false) => create(SwaySchema, { sessionId, trial, attempt: 1, isPreliminary });
const missing = { sessionId: 's1', trial: 2, attempt: 1 };

test.each<[string, SessionInfo | undefined, Sway | undefined, boolean]>([
  ['while it waits', session(TrialPhase.WAITING), undefined, true],
  ['while it rests', session(TrialPhase.RESTING), undefined, true],
  ['after the plan', session(TrialPhase.FINISHED), undefined, true],
  ['that shows running values', session(TrialPhase.WAITING), sway('', 0, true), true],
  ['that shows the trial before', session(TrialPhase.WAITING), sway('s1', 1), true],
  ['that shows another session', session(TrialPhase.WAITING), sway('s0', 2), true],
  ['that shows it', session(TrialPhase.WAITING), sway('s1', 2), false],
  ['during a trial', session(TrialPhase.MEASURING), undefined, false],
  ['before the first trial', session(TrialPhase.WAITING, SessionState.RUNNING, 0), undefined, false],
  ['after the session', session(TrialPhase.FINISHED, SessionState.IDLE), undefined, false],
  ['without a session', undefined, undefined, false],
])('missingResult.Tab %s', (_name, of, shown, isMissing) => {
  expect(missingResult(of, shown)).toEqual(isMissing ? missing : undefined);
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
