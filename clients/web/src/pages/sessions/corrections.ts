// SPDX-License-Identifier: Apache-2.0
// What a person changed in a closed session. The newest correction of a value counts; the oldest knows what was recorded.
import type { MessageInitShape } from '@bufbuild/protobuf';
import type { Signal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import { useRef } from 'preact/hooks';

import type { CorrectSessionRequestSchema, Correction, MarkerRecord, SessionRecord, TrialRecord } from '../../generated/dts/v1/sessions_pb';
import { dateTime } from '../../parts/numbers';
import { strings } from '../../strings';

const words = {
  outcomes: strings.common.outcomes as Readonly<Record<string, string>>,
  sessions: strings.sessions.change.isIt as Readonly<Record<string, string>>,
};

export type CorrectionRequest = MessageInitShape<typeof CorrectSessionRequestSchema>;

/** What the form of a correction contains. */
export interface Entered {
  readonly subject: string;
  readonly label: string;
  readonly notes: string;
  readonly trial: TrialRecord | undefined;
  readonly outcome: string;
  readonly marker: MarkerRecord | undefined;
  readonly markerText: string;
  readonly reason: string;
}

/** Returns whether another part has the same attempt of the same trial: sessions of earlier builds counted attempts in each part. */
export const isInOtherPart = (session: SessionRecord, { part, trial, attempt }: TrialRecord): boolean =>
  session.trials.some((one) => one.trial === trial && one.attempt === attempt && one.part !== part);

/** Returns a request with the changed values only, or nothing if none changed. */
export const requestOf = (session: SessionRecord, entered: Entered): CorrectionRequest | undefined => {
  const { trial, marker } = entered;
  const changes: CorrectionRequest = {};
  for (const name of ['subject', 'label', 'notes'] as const) {
    const value = entered[name].trim();
    if (value !== session[name]) changes[name] = value;
  }
  if (trial !== undefined && entered.outcome !== '' && entered.outcome !== trial.outcome) {
    Object.assign(changes, { trial: trial.trial, attempt: trial.attempt, outcome: entered.outcome });
    if (isInOtherPart(session, trial)) changes.part = trial.part;
  }
  if (marker !== undefined && entered.markerText.trim() !== marker.text) {
    Object.assign(changes, { marker: marker.number, markerText: entered.markerText.trim() });
  }
  return Object.keys(changes).length === 0 ? undefined : { ...changes, sessionId: session.sessionId, reason: entered.reason.trim() };
};

/** What a person typed and chose; `trial` and `marker` are keys of the lists, "" if none is chosen. */
export type Typed = Omit<Entered, 'trial' | 'marker'> & { readonly trial: string; readonly marker: string };

export interface CorrectionForm {
  /** The session as it was when the form opened. */
  readonly opened: SessionRecord;
  readonly typed: Signal<Typed>;
  readonly request: () => CorrectionRequest | undefined;
}

export const trialKey = ({ part, trial, attempt }: TrialRecord): string => `${part}.${trial}.${attempt}`;

export const markerOf = (session: SessionRecord, number: string): MarkerRecord | undefined => session.markers.find((one) => String(one.number) === number);

/**
 * Holds what a form of a correction contains while it is open. The session may be loaded again meanwhile, with a colleague's correction. The form
 * still has the values from before, so they are compared with the session as it was: else the form would take the colleague's correction back.
 */
export const useCorrectionForm = (session: SessionRecord): CorrectionForm => {
  const opened = useRef(session).current;
  const { subject, label, notes } = opened;
  const typed = useSignal<Typed>({ subject, label, notes, trial: '', outcome: '', marker: '', markerText: '', reason: '' });
  const request = (): CorrectionRequest | undefined => {
    const { trial, marker } = typed.value;
    return requestOf(opened, { ...typed.value, trial: opened.trials.find((one) => trialKey(one) === trial), marker: markerOf(opened, marker) });
  };
  return { opened, typed, request };
};

/** Returns a value of a correction as the reader sees it: an outcome in the reader's language; "" if there is none. */
export const shownValue = ({ field }: Correction, value: string): string =>
  (field === 'outcome' ? words.outcomes[value] : field === 'deleted' ? words.sessions[value] : undefined) ?? value;

const detail = (one: Correction): string => strings.sessions.change.detail(shownValue(one, one.oldValue), one.who, dateTime(one.utcNs), one.reason);

/** Returns who changed a value, when and why, and what it was before; "" if it is as recorded. */
export const correctionOf = (session: SessionRecord, field: 'subject' | 'label' | 'notes'): string => {
  const newest = session.corrections.filter((one) => one.field === field).at(-1);
  return newest === undefined ? '' : detail(newest);
};

/** The same for the outcome of an attempt. */
export const outcomeCorrection = (session: SessionRecord, { part, trial, attempt }: TrialRecord): string => {
  const isIt = (one: Correction): boolean => one.field === 'outcome' && one.part === part && one.trial === trial && one.attempt === attempt;
  const newest = session.corrections.filter(isIt).at(-1);
  return newest === undefined ? '' : detail(newest);
};

/** The same for the text of a marker. */
export const markerCorrection = (session: SessionRecord, { part, numberInPart }: MarkerRecord): string => {
  const newest = session.corrections.filter((one) => one.field === 'marker' && one.part === part && one.marker === numberInPart).at(-1);
  return newest === undefined ? '' : detail(newest);
};

/** Returns the number within the session of the marker that a correction is about. */
export const markerNumber = (session: SessionRecord, { part, marker }: Correction): number =>
  session.markers.find((one) => one.part === part && one.numberInPart === marker)?.number ?? marker;
