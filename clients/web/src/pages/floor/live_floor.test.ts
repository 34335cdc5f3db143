// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { signal } from '@preact/signals';
import { expect, test } from 'vitest';

import { StatusSnapshotSchema } from '../../generated/dts/v1/control_pb';
import { EventSchema, Quality, SessionState } from '../../generated/dts/v1/stream_pb';
import type { Block, Link, LiveEvent } from '../../link/types';
import { LiveFloor } from './live_floor';

const channels = ['ml_mm', 'ap_mm', 'load_n'].map((name) => ({ name }));

const openFloor = (state: SessionState) => {
  let tellBlock: (block: Block) => void = () => undefined;
  let tellEvent: (event: LiveEvent) => void = () => undefined;
  const stop = (): void => undefined;
  const link = {
    status: signal(create(StatusSnapshotSchema, { rigs: [{ rig: { name: 'floor' }, session: { state } }] })),
    onBlock: (topic: string, handler: typeof tellBlock) => {
      if (topic === 'floor/cop') tellBlock = handler;
      return stop;
    },
    onEvent: (_topic: string, handler: typeof tellEvent) => {
      tellEvent = handler;
      return stop;
    },
    onPaint: () => stop,
    subscribe: () => stop,
  } as unknown as Link;
  const floor = new LiveFloor(link, 'floor');
  const stand = (quality: number): void =>
    tellBlock({
      format: { channels },
      rateHz: 100,
      scanCount: 1,
      timeMs: 0,
      newestMs: 0,
      missingScans: 0,
      columns: channels.map(() => new Float32Array(1)),
      quality: new Uint8Array(3).fill(quality),
    } as unknown as Block);
  const finish = (trial: number): void =>
    tellEvent({ timeMs: 0, event: create(EventSchema, { body: { case: 'sway', value: { trial, isPreliminary: false, isValid: true } } }) } as LiveEvent);
  return { floor, stand, finish };
};

test.each<[string, SessionState, number | undefined]>([
  ['NextPersonAfterTheSession sees no result of the former one', SessionState.IDLE, undefined],
  ['SubjectBackOnThePlate within the session keeps the result', SessionState.RUNNING, 4],
])('LiveFloor.%s', (_, state, expected) => {
  const { floor, stand, finish } = openFloor(state);
  stand(Quality.UNSPECIFIED);
  finish(4);
  stand(Quality.NO_CONTACT);
  const whileEmpty = floor.sway.value?.sway.trial;

  stand(Quality.UNSPECIFIED);

  expect(whileEmpty).toBe(4);
  expect(floor.sway.value?.sway.trial).toBe(expected);
});
