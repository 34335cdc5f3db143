// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test, vi } from 'vitest';

import { SessionRecordSchema } from '../generated/dts/v1/sessions_pb';
import { asSentence, protocolName, sessionTitle } from './names';

test.each([
  ['free', 'Free recording'],
  ['quiet-standing', 'Quiet standing'],
  ['my_own-protocol', 'My own protocol'],
  ['constructor', 'Constructor'],
  ['', ''],
])('protocolName.%j is %j', (name, expected) => {
  expect(protocolName(name)).toBe(expected);
});

const started = (year: number): bigint => BigInt(new Date(year, 10, 23, 12).getTime()) * 1_000_000n;

test('sessionTitle.Names subject, protocol and day, the year only if it is another one', () => {
  vi.useFakeTimers({ now: new Date(2026, 11, 1) });
  const record = (subject: string, year: number) => create(SessionRecordSchema, { subject, protocol: 'romberg', startedUtcNs: started(year) });

  const titles = [record('P017', 2026), record('', 2026), record('P017', 2025)].map(sessionTitle);
  vi.useRealTimers();

  expect(titles[0]).toMatch(/^P017, Romberg, (23 Nov|Nov 23)$/);
  expect(titles[1]).toMatch(/^No subject ID, Romberg, /);
  expect(titles[2]).toMatch(/2025/);
});

test.each([
  ["tare rejected: the plate of rig 'floor' is loaded", "Tare rejected: the plate of rig 'floor' is loaded"],
  ['see dtsctl session list', 'See dtsctl session list'],
  ['dtsctl tare --rig chair', 'dtsctl tare --rig chair'],
  ['', ''],
])('asSentence.%j is %j', (message, expected) => {
  expect(asSentence(message)).toBe(expected);
});
