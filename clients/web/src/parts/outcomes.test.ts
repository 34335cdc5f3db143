// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { TrialFault, TrialOutcome, TrialRecordSchema, TrialStatusSchema } from '../generated/dts/v1/sessions_pb';
import { lastOutcome, outcomeOf } from './outcomes';

const { DONE, REDONE, REJECTED, ABORTED, UNSPECIFIED } = TrialOutcome;
const { STEPPED_OFF, FEET_MOVED, NO_REACH, NO_VALUES } = TrialFault;
const none = TrialFault.UNSPECIFIED;

test.each([
  [UNSPECIFIED, none, undefined],
  [DONE, none, 'done'],
  [DONE, STEPPED_OFF, 'steppedOff'],
  [DONE, FEET_MOVED, 'feetMoved'],
  [DONE, NO_REACH, 'noReach'],
  [DONE, NO_VALUES, 'noValues'],
  [REDONE, none, 'redone'],
  [REJECTED, STEPPED_OFF, 'rejected'], // rejected because the person stepped off
  [ABORTED, none, 'aborted'],
])('lastOutcome.%i with fault %i is %j', (outcome, fault, expected) => {
  expect(lastOutcome(create(TrialStatusSchema, { lastOutcome: outcome, lastFault: fault }))).toBe(expected);
});

test.each([
  ['done', none, '', 'done'],
  ['done', STEPPED_OFF, '', 'steppedOff'],
  ['done', STEPPED_OFF, 'rejected', 'done'], // corrected by a person
  ['rejected', STEPPED_OFF, '', 'rejected'],
  ['redone', none, '', 'redone'],
  ['aborted', none, 'done', 'aborted'],
])('outcomeOf.%j with fault %i, recorded as %j, is %j', (outcome, fault, recordedOutcome, expected) => {
  expect(outcomeOf(create(TrialRecordSchema, { outcome, fault, recordedOutcome }))).toBe(expected);
});
