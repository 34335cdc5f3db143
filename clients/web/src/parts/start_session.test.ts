// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { CommandError } from '../link/types';
import { fakeLink } from '../testing';
import { askLastProtocol, inputNamedIn, titleOf } from './start_session';

const fields = [
  { name: 'weight_kg', label: 'Body weight' },
  { name: 'sex', label: 'Sex' },
];

test.each([
  ["Field 'weight_kg' must be between 10 and 250", 'weight_kg'],
  ['Body weight must be between 10 and 250', 'weight_kg'],
  ["The subject ID must have at most 64 letters, digits, '_', '.' or '-'", 'subject'],
  ['Label is longer than 200 bytes', 'label'],
  ['Disk full', ''],
])('inputNamedIn.%j is beside %j', (message, expected) => {
  expect(inputNamedIn(message, fields)).toBe(expected);
});

test('titleOf.With several rigs the form names its rig', () => {
  expect(titleOf('plate', ['floor', 'chair'])).toBe('New session on plate');
  expect(titleOf('plate', [])).toBe('New session');
});

test.each<[string, () => Promise<unknown>, string]>([
  ['TheNewestSession', async () => ({ case: 'sessions', value: { sessions: [{ protocol: 'romberg' }] } }), 'romberg'],
  ['NoSession', async () => ({ case: 'sessions', value: { sessions: [] } }), ''],
  ['NoAnswer', async () => Promise.reject(new CommandError(0, 'no', '')), ''],
])('askLastProtocol.Of %s', async (_, answer, expected) => {
  const { link } = fakeLink();
  link.send.mockImplementation(answer as typeof link.send);

  expect(await askLastProtocol(link, 'floor')).toBe(expected);
  expect(link.send).toHaveBeenCalledWith({ case: 'listSessions', value: { rig: 'floor', limit: 1 } });
});
