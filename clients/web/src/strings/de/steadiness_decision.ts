// SPDX-License-Identifier: Apache-2.0
// The decision of the steadiness model after a trial. It says whose sway this resembles; it must never read as a statement about health.
import type { steadinessDecision as english } from '../en/steadiness_decision';

export const steadinessDecision: typeof english = {
  title: 'Schwankung ähnlich',
  none: 'Keine Zuordnung',
  probability: (percent) => `Wahrscheinlichkeit ${percent} %`,
  outside: (measures) => `Außerhalb der Lerndaten: ${measures}`,
  notValid: 'Durchgang nicht gültig: Platte verlassen oder Füße bewegt',
  missing: (measures) => `Fehlt: ${measures}`,
  notComparable: 'Andere Abtastrate, anderer Filter oder andere Dauer als in den Lerndaten',
  people: (people, condition) => `Gelernt aus Daten von ${people} Personen${condition === '' ? '' : `, ${condition}`}`,
  conditionOf: (condition) => condition.replace(/^condition=/, 'Bedingung '),
  auc: (auc, low, high) => `Richtige Reihenfolge bei einem Anteil von ${auc} der Paare (${low} bis ${high}); Zufall ist 0,50`,
  oneMeasure: (name, auc) => `Nicht besser als eine Kenngröße allein: ${name} (${auc})`,
  betterThanOneMeasure: (name, auc) => `Besser als eine Kenngröße allein: ${name} (${auc})`,
  rival: (facts, auc) => `Ohne Plattform unterscheidet das ebenso gut: ${facts} (${auc})`,
  facts: { age: 'Alter', height_cm: 'Körpergröße', sex: 'Geschlecht' },
  and: ' mit ',
  limit: 'Keine Aussage über Gesundheit oder Sturzgefahr',
};
