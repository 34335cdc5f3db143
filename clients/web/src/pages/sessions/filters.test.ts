// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { describe, expect, it } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { noFilters, passes } from './filters';

const startedMs = new Date(2026, 0, 31, 23, 30).getTime(); // late in the evening, in the reader's own time zone
const session = create(SessionRecordSchema, {
  subject: 'P017',
  protocol: 'romberg',
  state: 'recovered',
  startedUtcNs: BigInt(startedMs) * 1_000_000n,
});

describe('Filters', () => {
  it.each([
    ['None', {}],
    ['PartOfSubject', { subject: ' p01' }],
    ['Protocol', { protocol: 'romberg' }],
    ['State', { state: 'recovered' }],
    ['DayItself', { from: '2026-01-31', to: '2026-01-31' }],
  ])('%sThatFits.Passes', (_, filters) => {
    expect(passes(session, { ...noFilters, ...filters })).toBe(true);
  });

  it.each([
    ['Subject', { subject: 'P018' }],
    ['PartOfProtocol', { protocol: 'rom' }],
    ['State', { state: 'interrupted' }],
    ['LaterDay', { from: '2026-02-01' }],
    ['EarlierDay', { to: '2026-01-30' }],
  ])('%sThatDoesNotFit.HoldsBack', (_, filters) => {
    expect(passes(session, { ...noFilters, ...filters })).toBe(false);
  });
});
