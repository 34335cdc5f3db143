// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { signal } from '@preact/signals';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { runHook } from '../../testing';
import type { Entered } from './corrections';
import { correctionOf, markerCorrection, markerNumber, outcomeCorrection, requestOf, useCorrectionForm } from './corrections';

const session = create(SessionRecordSchema, {
  sessionId: 's1',
  subject: 'P018',
  label: 'before',
  trials: [
    { part: 1, trial: 1, attempt: 1, outcome: 'done' },
    { part: 1, trial: 2, attempt: 1, outcome: 'rejected', recordedOutcome: 'done' },
  ],
  markers: [
    { number: 1, part: 1, numberInPart: 1, text: 'cough' },
    { number: 2, part: 2, numberInPart: 1, text: 'sneezed' },
  ],
  corrections: [
    { number: 1, field: 'subject', oldValue: 'P017', newValue: 'P108', who: 'local', reason: 'typed wrong' },
    { number: 2, field: 'subject', oldValue: 'P108', newValue: 'P018', who: 'anna', reason: 'typed wrong again' },
    { number: 3, field: 'outcome', part: 1, trial: 2, attempt: 1, oldValue: 'done', newValue: 'rejected', who: 'anna', reason: 'spoke' },
    { number: 4, field: 'marker', part: 2, marker: 1, oldValue: 'fell', newValue: 'sneezed', who: 'anna', reason: 'heard wrong' },
  ],
});
const unchanged: Entered = { subject: 'P018', label: 'before', notes: '', trial: undefined, outcome: '', marker: undefined, markerText: '', reason: ' why ' };
const [first, second] = session.trials;
const [cough, sneeze] = session.markers;

test.each<[string, Partial<Entered>, object | undefined]>([
  ['Nothing', {}, undefined],
  ['SpacesAround', { subject: ' P018 ' }, undefined],
  ['Subject', { subject: 'P019' }, { sessionId: 's1', subject: 'P019', reason: 'why' }],
  ['LabelThatIsRemoved', { label: '' }, { sessionId: 's1', label: '', reason: 'why' }],
  ['Outcome', { trial: first!, outcome: 'rejected' }, { sessionId: 's1', trial: 1, attempt: 1, outcome: 'rejected', reason: 'why' }],
  ['SameOutcome', { trial: second!, outcome: 'rejected' }, undefined],
  ['TrialWithoutOutcome', { trial: first! }, undefined],
  ['Marker', { marker: sneeze!, markerText: ' fell ' }, { sessionId: 's1', marker: 2, markerText: 'fell', reason: 'why' }],
  ['MarkerThatIsRemoved', { marker: cough!, markerText: '' }, { sessionId: 's1', marker: 1, markerText: '', reason: 'why' }],
  ['SameMarker', { marker: cough!, markerText: 'cough ' }, undefined],
])('requestOf.Changed %s', (_, changes, expected) => {
  expect(requestOf(session, { ...unchanged, ...changes })).toEqual(expected);
});

test('requestOf.AttemptThatTwoPartsHave names its part', () => {
  const trials = [...session.trials, { ...first!, part: 2 }];
  const changes = { ...unchanged, trial: first!, outcome: 'rejected' };
  expect(requestOf({ ...session, trials }, changes)).toEqual({ sessionId: 's1', trial: 1, attempt: 1, part: 1, outcome: 'rejected', reason: 'why' });
});

test('useCorrectionForm.Corrections of a colleague while the form is open are not taken back', () => {
  const loaded = signal(session);
  const form = runHook(() => useCorrectionForm(loaded.value));
  const set = (typed: object): void => void (form.now().typed.value = { ...form.now().typed.value, ...typed });
  set({ notes: 'slept badly', marker: '1', markerText: 'cough', reason: 'why' });

  const [, ...others] = session.markers;
  loaded.value = { ...session, subject: 'P020', markers: [{ ...cough!, text: 'hiccup' }, ...others] };
  form.draw();
  expect(form.now().request()).toEqual({ sessionId: 's1', notes: 'slept badly', reason: 'why' });
  set({ subject: 'P021' });
  expect(form.now().request()).toMatchObject({ subject: 'P021' });
});

test('correctionOf.NewestCorrection says who, why and what was before; a recorded value has none', () => {
  expect(correctionOf(session, 'subject')).toMatch(/before: P108; by anna, .*: typed wrong again/);
  expect(correctionOf(session, 'label')).toBe('');
  expect(outcomeCorrection(session, second!)).toMatch(/before: done; by anna, .*: spoke/);
  expect(outcomeCorrection(session, first!)).toBe('');
});

test('markerCorrection.IsOfTheMarkerInItsPart', () => {
  expect(markerCorrection(session, cough!)).toBe('');
  expect(markerCorrection(session, sneeze!)).toMatch(/before: fell; by anna, .*: heard wrong/);
  expect(markerNumber(session, session.corrections.at(-1)!)).toBe(2);
});
