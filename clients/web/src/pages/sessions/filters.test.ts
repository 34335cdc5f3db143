// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { noFilters, passes } from './filters';

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
