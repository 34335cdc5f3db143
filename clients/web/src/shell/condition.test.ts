// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { RigStatusSchema, StatusSnapshotSchema } from '../generated/dts/v1/control_pb';
import { DiskState, DiskStatusSchema } from '../generated/dts/v1/sessions_pb';
import { DeviceState } from '../generated/dts/v1/stream_pb';
import { conditionOf } from './condition';

const nothingDropped = { blocks: 0, scans: 0, events: 0, scansLately: 0 };
const rig = (name: string, device: DeviceState, deviceMessage = '') => create(RigStatusSchema, { rig: { name }, device, deviceMessage });
const status = (rigs: ReturnType<typeof rig>[], disk = DiskState.FINE) =>
  create(StatusSnapshotSchema, { rigs, disk: create(DiskStatusSchema, { state: disk, recordableS: 1800 }) });

test('conditionOf.AllWell is quiet', () => {
  const { kind } = conditionOf('up', 1, status([rig('floor', DeviceState.STREAMING)]), nothingDropped);

  expect(kind).toBe('good');
});

test('conditionOf.LostDevice is louder than a disk that fills, with what to do', () => {
  const rigs = [rig('chair', DeviceState.OPEN), rig('floor', DeviceState.GONE, 'plug it in again')];

  const condition = conditionOf('up', 1, status(rigs, DiskState.LOW), nothingDropped);

  expect(condition).toMatchObject({ kind: 'error', hint: 'plug it in again' });
  expect(condition.text).toContain('floor');
});

test.each([
  [DiskState.LOW, 'warning'],
  [DiskState.FULL, 'error'],
  [DiskState.UNUSABLE, 'error'],
])('conditionOf.Disk %s is a %s', (disk, kind) => {
  expect(conditionOf('up', 1, status([rig('floor', DeviceState.STREAMING)], disk), nothingDropped).kind).toBe(kind);
});

test('conditionOf.SlowTab says how much it did not show, while it is slow', () => {
  const condition = (scansLately: number) => conditionOf('up', 1, status([rig('floor', DeviceState.STREAMING)]), { blocks: 3, scans: 99, events: 0, scansLately });

  const [slow, over] = [condition(64), condition(0)];

  expect(slow.kind).toBe('warning');
  expect(slow.text).toContain('64');
  expect(over.kind).toBe('good');
});

test('conditionOf.GoneGateway and silent daemon are different errors', () => {
  const [gateway, daemon] = (['no-gateway', 'no-daemon'] as const).map((state) => conditionOf(state, 1, undefined, nothingDropped));

  expect([gateway!.kind, daemon!.kind]).toEqual(['error', 'error']);
  expect(gateway!.text).not.toBe(daemon!.text);
});
