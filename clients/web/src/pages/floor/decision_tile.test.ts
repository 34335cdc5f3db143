// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { DecisionOutcome, SteadinessDecisionSchema } from '../../generated/dts/v1/stream_pb';
import { strings } from '../../strings';
import { decisionLimits, decisionWords } from './decision_tile';

const words = strings.steadinessDecision;

const decision = create(SteadinessDecisionSchema, {
  label: 'group60',
  outcome: DecisionOutcome.DECIDED,
  group: 'under60',
  probabilities: [
    { group: '60plus', probability: 0.17 },
    { group: 'under60', probability: 0.83 },
  ],
  people: 124,
  condition: 'condition=ec_firm',
  about: 'nearly nobody of 41 to 59',
  auc: 0.81,
  aucLow: 0.73,
  aucHigh: 0.88,
  bestMeasure: 'MVELO',
  bestMeasureAuc: 0.78,
  rival: 'height_cm with sex',
  rivalAuc: 0.83,
});

test('decisionWords.Decided gives the group and its own probability', () => {
  expect(decisionWords(decision)).toEqual({ value: 'under60', note: words.probability('83') });
});

test('decisionWords.Without a decision gives no group, but the reason', () => {
  const reason = (outcome: DecisionOutcome): string => {
    const { value, note } = decisionWords({ ...decision, outcome, outside: ['MVELO', 'RANGE_AP'], missing: ['MDIST'] });
    expect(value).toBe(words.none);
    return note;
  };
  expect(reason(DecisionOutcome.OUTSIDE)).toBe(words.outside('MVELO, RANGE_AP'));
  expect(reason(DecisionOutcome.NOT_VALID)).toBe(words.notValid);
  expect(reason(DecisionOutcome.MISSING)).toBe(words.missing('MDIST'));
  expect(reason(DecisionOutcome.NOT_COMPARABLE)).toBe(words.notComparable);
  expect(reason(99 as DecisionOutcome)).toBe('');
});

test('decisionLimits.Every decision has its people, its accuracy, the one measure, the rival and the limit', () => {
  const limits = decisionLimits(decision);
  expect(limits).toEqual([
    words.people('124', words.conditionOf('condition=ec_firm')),
    words.auc('0.81', '0.73', '0.88'),
    words.oneMeasure('MVELO', '0.78'),
    words.rival(`${words.facts.height_cm}${words.and}${words.facts.sex}`, '0.83'),
    'nearly nobody of 41 to 59',
    words.limit,
  ]);
});

test('decisionLimits.Facts and the condition are words, and the page says that facts do as well', () => {
  const limits = decisionLimits(decision);
  expect(limits).toContain('Trained on 124 people, condition ec_firm');
  expect(limits).toContain('Without a platform, height with sex does as well as the model (0.83)');
  expect(decisionLimits({ ...decision, rival: 'shoe_size' })).toContain('Without a platform, shoe_size does as well as the model (0.83)');
});

test('decisionLimits.A model that is better does not say that others do as well', () => {
  const limits = decisionLimits({ ...decision, isBetterThanOneMeasure: true, isBetterThanRival: true });
  expect(limits).toHaveLength(5);
  expect(limits).toContain(words.betterThanOneMeasure('MVELO', '0.78'));
});
