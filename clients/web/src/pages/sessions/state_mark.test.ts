// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { usefulnessOf } from './state_mark';

const session = (state: string, plannedTrials: number, ...validTrials: readonly number[]) =>
  create(SessionRecordSchema, { state, plannedTrials, parts: validTrials.map((valid) => ({ validTrials: valid })) });

test.each<[string, ReturnType<typeof session>, object | undefined]>([
  ['CompleteWithoutValidTrial is useless', session('complete', 4, 0), { valid: 0, planned: 4, kind: 'none' }],
  ['SomeValid', session('incomplete', 4, 1, 2), { valid: 3, planned: 4, kind: 'some' }],
  ['AllValid', session('complete', 4, 4), { valid: 4, planned: 4, kind: 'all' }],
  ['ProtocolWithoutTrials has none to count', session('complete', 0, 0), undefined],
  ['RunningSession is not judged yet', session('running', 4, 1), undefined],
])('usefulnessOf.%s', (_, of, expected) => {
  expect(usefulnessOf(of)).toEqual(expected);
});
