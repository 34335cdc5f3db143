// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { RigStatusSchema, StatusSnapshotSchema } from '../generated/dts/v1/control_pb';
import type { TrialStatusSchema } from '../generated/dts/v1/sessions_pb';
import { DiskState, DiskStatusSchema, TrialFault, TrialOutcome, TrialPhase } from '../generated/dts/v1/sessions_pb';
import { DeviceState, SessionState } from '../generated/dts/v1/stream_pb';
import { conditionOf } from './condition';

const nothingDropped = { blocks: 0, scans: 0, events: 0, scansLately: 0 };
const rig = (name: string, device: DeviceState, deviceMessage = '') => create(RigStatusSchema, { rig: { name }, device, deviceMessage });
const status = (rigs: ReturnType<typeof rig>[], disk = DiskState.FINE) =>
  create(StatusSnapshotSchema, { rigs, disk: create(DiskStatusSchema, { state: disk, recordableS: 1800 }) });

const well = [rig('floor', DeviceState.STREAMING)];
const slow = (scansLately: number) => ({ blocks: 3, scans: 99, events: 0, scansLately });

test.each<[string, Parameters<typeof conditionOf>, object]>([
  ['AllWell is quiet', ['up', 1, status(well), nothingDropped], { kind: 'good' }],
  ['LostDevice is louder than a disk that fills, with what to do',
    ['up', 1, status([rig('chair', DeviceState.OPEN), rig('floor', DeviceState.GONE, 'plug it in again')], DiskState.LOW), nothingDropped],
    { kind: 'error', hint: 'Plug it in again', text: expect.stringContaining('floor') }],
  ['DiskThatFills', ['up', 1, status(well, DiskState.LOW), nothingDropped], { kind: 'warning' }],
  ['FullDisk', ['up', 1, status(well, DiskState.FULL), nothingDropped], { kind: 'error' }],
  ['UnusableDisk', ['up', 1, status(well, DiskState.UNUSABLE), nothingDropped], { kind: 'error' }],
  ['SlowTab says how many scans it did not show', ['up', 1, status(well), slow(64)], { kind: 'warning', text: expect.stringContaining('64') }],
  ['TabThatWasSlow is quiet', ['up', 1, status(well), slow(0)], { kind: 'good' }],
])('conditionOf.%s', (_, given, expected) => {
  expect(conditionOf(...given)).toMatchObject(expected);
});

test.each<[string, MessageInitShape<typeof TrialStatusSchema>, string]>([
  ['Rejected', { phase: TrialPhase.WAITING, lastOutcome: TrialOutcome.REJECTED, lastTrial: 2 }, '1 rig OK · floor: trial 2 rejected'],
  ['SteppedOff', { phase: TrialPhase.WAITING, lastOutcome: TrialOutcome.DONE, lastFault: TrialFault.STEPPED_OFF, lastTrial: 2 }, '1 rig OK · floor: trial 2: person stepped off'],
  ['Running', { phase: TrialPhase.SETTLING, lastOutcome: TrialOutcome.DONE, trial: 3, of: 4, lastTrial: 2 }, '1 rig OK · floor: trial 3 of 4'],
  ['NotBegun', { phase: TrialPhase.WAITING }, '1 rig OK · floor: session running'],
])('conditionOf.SessionWithTrial %s is named behind the rigs', (_, trial, text) => {
  const running = create(RigStatusSchema, { rig: { name: 'floor' }, device: DeviceState.STREAMING, session: { state: SessionState.RUNNING, trial } });

  expect(conditionOf('up', 1, status([running]), nothingDropped)).toMatchObject({ kind: 'good', text });
});

test('conditionOf.GatewayLost and silent daemon are different errors', () => {
  const [gateway, daemon] = (['no-gateway', 'no-daemon'] as const).map((state) => conditionOf(state, 1, undefined, nothingDropped));

  expect([gateway!.kind, daemon!.kind]).toEqual(['error', 'error']);
  expect(gateway!.text).not.toBe(daemon!.text);
});
