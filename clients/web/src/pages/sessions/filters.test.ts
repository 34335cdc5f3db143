// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { durationS, noFilters, passes, rigsOf } from './filters';

const startedMs = new Date(2026, 0, 31, 23, 30).getTime(); // late in the evening, in the reader's own time zone
const session = create(SessionRecordSchema, {
  subject: 'P017',
  protocol: 'romberg',
  state: 'recovered',
  startedUtcNs: BigInt(startedMs) * 1_000_000n,
});

test.each([
  ['None', {}, true],
  ['PartOfSubject', { subject: ' p01' }, true],
  ['Protocol', { protocol: 'romberg' }, true],
  ['State', { state: 'recovered' }, true],
  ['DayItself', { from: '2026-01-31', to: '2026-01-31' }, true],
  ['OtherSubject', { subject: 'P018' }, false],
  ['PartOfProtocol', { protocol: 'rom' }, false],
  ['OtherState', { state: 'interrupted' }, false],
  ['LaterDay', { from: '2026-02-01' }, false],
  ['EarlierDay', { to: '2026-01-30' }, false],
])('passes.%s', (_, filters, expected) => {
  expect(passes(session, { ...noFilters, ...filters })).toBe(expected);
});

const ofTwoRigs = create(SessionRecordSchema, {
  rig: 'floor',
  parts: [
    { part: 1, rig: 'floor', durationS: 30 },
    { part: 2, leadingPart: 1, rig: 'plate', durationS: 29.5 },
    { part: 3, rig: 'floor', durationS: 10 },
    { part: 4, leadingPart: 3, rig: 'plate', durationS: 10 },
  ],
});

test('durationS.OfTwoRigs is that of the leading one', () => {
  expect(durationS(ofTwoRigs)).toBe(40);
});

test('rigsOf.TwoRigs names each once, the leading one first', () => {
  expect(rigsOf(ofTwoRigs)).toBe('floor, plate');
});
