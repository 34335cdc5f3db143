// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import type { ComponentChildren, VNode } from 'preact';
import { expect, test } from 'vitest';

import { SessionRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { SessionTable } from './session_list';

/** Returns the text of a component without hooks, and of the components in it. */
const textOf = (node: ComponentChildren): string => {
  if (Array.isArray(node)) return node.map(textOf).join(' ');
  if (typeof node !== 'object' || node === null) return typeof node === 'string' ? node : '';
  const { type, props } = node as VNode<{ children?: ComponentChildren }>;
  return textOf(typeof type === 'function' ? (type as (props: object) => ComponentChildren)(props) : props.children);
};

test('SessionTable.A deleted session says so', () => {
  const [kept, deleted] = [false, true].map((isDeleted) => create(SessionRecordSchema, { sessionId: 's1', subject: 'P017', state: 'complete', isDeleted }));

  expect(textOf(SessionTable({ sessions: [kept!] }))).not.toContain('deleted');
  expect(textOf(SessionTable({ sessions: [deleted!] }))).toMatch(/complete .*deleted/);
});
