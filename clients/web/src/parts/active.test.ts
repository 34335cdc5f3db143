// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { TrialPhase, TrialStatusSchema } from '../generated/dts/v1/sessions_pb';
import { isOpenEnded } from './active';

test.each([
  ['MeasuredWithoutADuration', TrialPhase.MEASURING, undefined, true],
  ['MeasuredForAWhile', TrialPhase.MEASURING, 30, false],
  ['NotMeasuredYet', TrialPhase.SETTLING, undefined, false],
  ['Between', TrialPhase.WAITING, undefined, false],
])('isOpenEnded.%s', (_name, phase, durationS, isIt) => {
  expect(isOpenEnded(create(TrialStatusSchema, durationS === undefined ? { phase } : { phase, durationS }))).toBe(isIt);
});
