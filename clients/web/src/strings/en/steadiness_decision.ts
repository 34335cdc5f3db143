// SPDX-License-Identifier: Apache-2.0
// The decision of the steadiness model after a trial. It says whose sway this resembles; it must never read as a statement about health.
export const steadinessDecision = {
  title: 'Sway resembles',
  none: 'No decision',
  probability: (percent: string) => `${percent} % probability`,
  outside: (measures: string) => `Outside of the training: ${measures}`,
  notValid: 'Trial not valid: stepped off or moved the feet',
  missing: (measures: string) => `Missing: ${measures}`,
  notComparable: 'Other rate, filter or duration than in the training',
  people: (people: string, condition: string) => `Trained on ${people} people${condition === '' ? '' : `, ${condition}`}`,
  conditionOf: (condition: string) => condition.replace(/^condition=/, 'condition '),
  auc: (auc: string, low: string, high: string) => `Right order in a share of ${auc} of pairs (${low} to ${high}); chance is 0.50`,
  oneMeasure: (name: string, auc: string) => `No better than one measure: ${name} (${auc})`,
  betterThanOneMeasure: (name: string, auc: string) => `Better than one measure: ${name} (${auc})`,
  rival: (facts: string, auc: string) => `Without a platform, ${facts} does as well as the model (${auc})`,
  facts: { age: 'age', height_cm: 'height', sex: 'sex' },
  and: ' with ',
  limit: 'No statement about health or risk of falling',
};
