// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { TrialFault, TrialPhase, TrialRecordSchema, TrialStatusSchema } from '../../generated/dts/v1/sessions_pb';
import { stripOf } from './trial_strip';

const record = (trial: number, outcome: string, attempt = 1, fault = TrialFault.UNSPECIFIED) => create(TrialRecordSchema, { trial, outcome, attempt, fault });
const at = (trial: number, of: number, phase = TrialPhase.MEASURING) => create(TrialStatusSchema, { trial, of, phase });

test('stripOf.EachTrial has the outcome of its newest attempt, the present one runs', () => {
  const records = [record(1, 'redone'), record(1, 'done', 2), record(2, 'rejected'), record(3, 'done', 1, TrialFault.STEPPED_OFF)];

  expect(stripOf(at(4, 5), records).map(({ state }) => state)).toEqual(['done', 'rejected', 'steppedOff', 'now', 'planned']);
  expect(stripOf(at(3, 4, TrialPhase.WAITING), records).map(({ state }) => state)).toEqual(['done', 'rejected', 'steppedOff', 'planned']);
});

test.each([
  [0, 60, 1],
  [30, 60, 24],
  [60, 60, 49],
])('stripOf.LongPlan at trial %i of %i begins with trial %i', (trial, of, first) => {
  const shown = stripOf(at(trial, of), []);

  expect([shown.length, shown[0]!.trial]).toEqual([12, first]);
});
