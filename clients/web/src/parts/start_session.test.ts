// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { CommandError } from '../link/types';
import { fakeLink } from '../testing';
import { askLastProtocol, unitOfField } from './start_session';

test.each([
  ['weight_kg', 'Body weight', 'kg'],
  ['age_years', 'Age in whole years', ''], // the label has it already
  ['age_years', 'Age', 'years'],
  ['sex', 'Sex', ''],
  ['kg', 'Weight', ''], // a name, not a unit behind a name
  ['trial_constructor', 'Other', ''],
])('unitOfField.%s of "%s" is %j', (name, sentence, unit) => {
  expect(unitOfField({ name, sentence })).toBe(unit);
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
