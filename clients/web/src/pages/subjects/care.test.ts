// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test } from 'vitest';

import { ProtocolInfoSchema } from '../../generated/dts/v1/sessions_pb';
import { protocols } from '../../parts/names';
import { fakeLink } from '../../testing';
import { rigsFor } from './care';

test.each([
  ['romberg', ['floor', 'plate']],
  ['reaching-short', ['chair']],
  ['free', ['floor', 'plate', 'chair']],
  ['that-dtsd-does-not-have', []],
])('rigsFor.%s runs on %j, also if a session runs there', (protocol, expected) => {
  const kinds = { romberg: 'floor', 'reaching-short': 'chair', free: '' };
  protocols.value = Object.entries(kinds).map(([name, rigKind]) => create(ProtocolInfoSchema, { name, rigKind }));
  const { link } = fakeLink([
    { rig: { name: 'floor', kind: 'floor' }, session: { sessionId: 's1', state: 2 } },
    { rig: { name: 'plate', kind: 'floor' } },
    { rig: { name: 'chair', kind: 'chair' } },
  ]);

  expect(rigsFor(link, protocol).map(({ name }) => name)).toEqual(expected);
});
