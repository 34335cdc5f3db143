// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import type { TrialRecord } from '../generated/dts/v1/sessions_pb';
import { TrialRecordSchema } from '../generated/dts/v1/sessions_pb';
import { nextTrial } from './next_trial';

const record = (trial: number, outcome: string, attempt = 1) => create(TrialRecordSchema, { trial, outcome, attempt });

test.each<[string, readonly TrialRecord[] | undefined, number | undefined]>([
  ['Of a new session is the first', [], 1],
  ['Of a resumed session is the one after those that are done', [record(1, 'done'), record(2, 'done')], 3],
  ['Is not one that was rejected', [record(1, 'done'), record(2, 'rejected')], 3],
  ['Is one that was aborted', [record(1, 'done'), record(2, 'done'), record(3, 'aborted')], 3],
  ['Is one whose redo has not ended', [record(1, 'done'), record(2, 'redone')], 2],
  ['Is not one whose redo is done', [record(1, 'redone'), record(1, 'done', 2)], 2],
  ['Is a gap in the plan', [record(2, 'done')], 1],
  ['Is none after the last', [1, 2, 3, 4].map((trial) => record(trial, 'done')), undefined],
  ['Is not known without the records', undefined, undefined],
])('nextTrial.%s', (_, records, expected) => {
  expect(nextTrial(4, records)).toBe(expected);
});
