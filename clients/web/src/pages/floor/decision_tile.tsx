// SPDX-License-Identifier: Apache-2.0
// What the rig's steadiness model decides about the trial that has just ended, with what must be known to read it.
import type { JSX } from 'preact';

import { DecisionOutcome } from '../../generated/dts/v1/stream_pb';
import type { SteadinessDecision } from '../../generated/dts/v1/stream_pb';
import { fixed, whole } from '../../parts/numbers';
import { strings } from '../../strings';

const words = strings.steadinessDecision;

/** Returns the decision, or why there is none. */
export const decisionWords = (decision: SteadinessDecision): { readonly value: string; readonly note: string } => {
  const listed = (symbols: readonly string[]): string => symbols.join(', ');
  switch (decision.outcome) {
    case DecisionOutcome.DECIDED: {
      const found = decision.probabilities.find(({ group }) => group === decision.group);
      return { value: decision.group, note: words.probability(fixed(found === undefined ? undefined : 100 * found.probability, 0)) };
    }
    case DecisionOutcome.OUTSIDE:
      return { value: words.none, note: words.outside(listed(decision.outside)) };
    case DecisionOutcome.NOT_VALID:
      return { value: words.none, note: words.notValid };
    case DecisionOutcome.MISSING:
      return { value: words.none, note: words.missing(listed(decision.missing)) };
    case DecisionOutcome.NOT_COMPARABLE:
      return { value: words.none, note: words.notComparable };
    default:
      return { value: words.none, note: '' };
  }
};

/** Returns facts of people ("height_cm with sex") in words. A fact without a word stays as it is. */
const factsOf = (rival: string): string => {
  const names: Readonly<Record<string, string | undefined>> = words.facts;
  return rival
    .split(' with ')
    .map((fact) => (Object.hasOwn(names, fact) ? (names[fact] ?? fact) : fact))
    .join(words.and);
};

/** Returns what must stand beside every decision, one sentence each. */
export const decisionLimits = (decision: SteadinessDecision): readonly string[] =>
  [
    words.people(whole(decision.people), words.conditionOf(decision.condition)),
    words.auc(fixed(decision.auc, 2), fixed(decision.aucLow, 2), fixed(decision.aucHigh, 2)),
    (decision.isBetterThanOneMeasure ? words.betterThanOneMeasure : words.oneMeasure)(decision.bestMeasure, fixed(decision.bestMeasureAuc, 2)),
    decision.rivalAuc === undefined || decision.isBetterThanRival ? '' : words.rival(factsOf(decision.rival), fixed(decision.rivalAuc, 2)),
    decision.about,
    words.limit,
  ].filter((line) => line !== '');

export const DecisionTile = ({ decision }: { decision: SteadinessDecision }): JSX.Element => {
  const { value, note } = decisionWords(decision);
  return (
    <div class="tile decision-tile" data-testid="decision" data-outcome={DecisionOutcome[decision.outcome]}>
      <div class="tile-label">
        {words.title} <span class="unit">({decision.label})</span>
      </div>
      <div class="tile-value">
        <span data-testid="decision-group">{value}</span> <span data-testid="decision-note">{note}</span>
      </div>
      <ul class="decision-limits">
        {decisionLimits(decision).map((line) => (
          <li key={line}>{line}</li>
        ))}
      </ul>
    </div>
  );
};
