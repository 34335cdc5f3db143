// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import type { RigStatus } from '../../generated/dts/v1/control_pb';
import { RigStatusSchema, SessionInfoSchema, StatusSnapshotSchema } from '../../generated/dts/v1/control_pb';
import type { TrialStatusSchema } from '../../generated/dts/v1/sessions_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { SessionState } from '../../generated/dts/v1/stream_pb';
import type { Sitting, Standing } from './screen_state';
import { patientRigs, sittingState, standingState } from './screen_state';

const session = (trial?: MessageInitShape<typeof TrialStatusSchema>) =>
  create(SessionInfoSchema, { state: SessionState.RUNNING, ...(trial === undefined ? {} : { trial }) });
const standing: Standing = { isOld: false, session: session({ phase: TrialPhase.MEASURING, trial: 1 }), isSomebody: true, isOffCentre: false };

test.each<[string, Partial<Standing>, string]>([
  ['NoSession', { session: undefined }, 'idle'],
  ['NoSession though somebody stands there', { session: create(SessionInfoSchema, { state: SessionState.IDLE }) }, 'idle'],
  ['WithoutTrials', { session: session() }, 'measure'],
  ['BeforeTheFirstTrial', { session: session({ phase: TrialPhase.WAITING }) }, 'wait'],
  ['BeforeTheFirstTrial without a person', { session: session({ phase: TrialPhase.WAITING }), isSomebody: false }, 'nobody'],
  ['BetweenTrials', { session: session({ phase: TrialPhase.WAITING, trial: 1 }), isSomebody: false }, 'rest'],
  ['Ready', { session: session({ phase: TrialPhase.READY, trial: 1 }) }, 'ready'],
  ['Settling', { session: session({ phase: TrialPhase.SETTLING, trial: 1 }) }, 'settle'],
  ['Settling near an edge', { session: session({ phase: TrialPhase.SETTLING, trial: 1 }), isOffCentre: true }, 'middle'],
  ['Measuring', {}, 'measure'],
  ['Measuring near an edge: the feet stay where they are', { isOffCentre: true }, 'measure'],
  ['SteppedOff', { isSomebody: false }, 'nobody'],
  ['Resting', { session: session({ phase: TrialPhase.RESTING, trial: 1 }) }, 'rest'],
  ['Finished', { session: session({ phase: TrialPhase.FINISHED, trial: 4 }), isSomebody: false }, 'done'],
  ['NoData is louder than everything', { isOld: true }, 'noData'],
])('standingState.%s', (_, given, expected) => {
  expect(standingState({ ...standing, ...given })).toBe(expected);
});

const sitting: Sitting = { isOld: false, isRunning: true, isSomebody: true, step: 'go', trial: 1 };

test.each<[string, Partial<Sitting>, string]>([
  ['NoSession', { isRunning: false, step: 'free' }, 'idle'],
  ['WithoutTrials', { step: 'free' }, 'wait'],
  ['BeforeTheFirstTrial', { step: 'waiting', trial: 0 }, 'wait'],
  ['BetweenTrials', { step: 'waiting' }, 'rest'],
  ['Ready', { step: 'ready' }, 'ready'],
  ['Ready without a person', { step: 'ready', isSomebody: false }, 'nobody'],
  ['Go: a reach may lift the person off the seat', { isSomebody: false }, 'go'],
  ['Back', { step: 'back' }, 'back'],
  ['Resting', { step: 'resting' }, 'rest'],
  ['Finished', { step: 'finished' }, 'done'],
  ['NoData', { isOld: true }, 'noData'],
])('sittingState.%s', (_, given, expected) => {
  expect(sittingState({ ...sitting, ...given })).toBe(expected);
});

const rigStatus = (name: string, kind: string, session?: NonNullable<MessageInitShape<typeof RigStatusSchema>['session']>) =>
  create(RigStatusSchema, { rig: { name, kind }, ...(session === undefined ? {} : { session }) });
const running = { state: SessionState.RUNNING };
const withTrials = { state: SessionState.RUNNING, trial: { phase: TrialPhase.READY } };
const namesIn = (rigs: RigStatus[], named?: string, shown?: string) =>
  patientRigs(create(StatusSnapshotSchema, { rigs }), named, shown).map(({ rig }) => rig!.name);

test('patientRigs is the rig with trials, unless the address names one', () => {
  expect(namesIn([rigStatus('floor', 'floor'), rigStatus('chair', 'chair')])).toEqual(['floor']);
  expect(namesIn([rigStatus('floor', 'floor'), rigStatus('chair', 'chair', running)])).toEqual(['chair']);
  expect(namesIn([rigStatus('plate', 'floor', running), rigStatus('floor', 'floor', withTrials)])).toEqual(['floor']);
  expect(namesIn([rigStatus('floor', 'floor', withTrials), rigStatus('chair', 'chair')], 'chair')).toEqual(['chair']);
  expect(namesIn([rigStatus('floor', 'floor')], 'other')).toEqual([]);
  expect(patientRigs(undefined, undefined)).toEqual([]);
});

// requirement: UI-15
test('patientRigs stays with the person who is shown, and chooses nobody of two', () => {
  const both = [rigStatus('floor', 'floor', withTrials), rigStatus('floor2', 'floor', withTrials)];

  expect(namesIn(both, undefined, 'floor2')).toEqual(['floor2']);
  expect(namesIn(both)).toEqual(['floor', 'floor2']);
  expect(namesIn(both, 'floor')).toEqual(['floor']);
  expect(namesIn([rigStatus('floor', 'floor', withTrials), rigStatus('floor2', 'floor')], undefined, 'floor2')).toEqual(['floor']);
  expect(namesIn([rigStatus('floor', 'floor', withTrials), rigStatus('floor2', 'floor', running)], undefined, 'floor2')).toEqual(['floor2']);
});

test('patientRigs is the leading rig of a session of two', () => {
  const both = { state: SessionState.RUNNING, rigs: ['chair', 'floor'] };

  expect(namesIn([rigStatus('floor', 'floor', both), rigStatus('chair', 'chair', both)])).toEqual(['chair']);
});
