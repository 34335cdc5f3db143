// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { DecisionOutcome } from '../../generated/dts/v1/stream_pb';
import { strings } from '../../strings';
import { decisionLimitsOf, keptDecision } from './decisions';

const decision = { label: 'group60', outcome: DecisionOutcome.DECIDED, group: 'under60', people: 124, bestMeasure: 'MVELO' };
const session = create(SessionRecordSchema, {
  trials: [
    { trial: 1, outcome: 'done', sway: { decision } },
    { trial: 2, outcome: 'rejected', sway: { decision: { ...decision, people: 99 } } },
    { trial: 3, outcome: 'done', sway: { decision } },
    { trial: 4, outcome: 'done', sway: {} },
  ],
});

// requirement: SWAY-10
test('keptDecision.Only a trial that is done has one', () => {
  expect(session.trials.map((trial) => keptDecision(trial)?.group)).toEqual(['under60', undefined, 'under60', undefined]);
});

test('decisionLimitsOf.Each sentence once, with the limit; nothing of trials that do not count', () => {
  const limits = decisionLimitsOf(session);
  expect(limits.filter((line) => line === strings.steadinessDecision.limit)).toHaveLength(1);
  expect(limits.join()).not.toContain('99');
  expect(decisionLimitsOf(create(SessionRecordSchema, { trials: [{ trial: 1, outcome: 'done', sway: {} }] }))).toEqual([]);
});
