// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { CommandError } from '../link/types';
import { fakeLink } from '../testing';
import { askSubjects, similarSubject } from './subject_ids';

test.each([
  ['p-017', 'P017'],
  ['P_0.17', 'P017'],
  ['P017', ''], // known
  ['P018', ''],
  ['q1', 'Q_1'],
  ['', ''],
])('similarSubject.Of %j is %j', (entered, expected) => {
  expect(similarSubject(['Q_1', 'P017'], entered)).toBe(expected);
});

test.each<[string, () => Promise<unknown>, readonly string[]]>([
  ['All', async () => ({ case: 'subjects', value: { subjects: [{ subject: 'P017' }, { subject: 'P018' }] } }), ['P017', 'P018']],
  ['NoAnswer', async () => Promise.reject(new CommandError(0, 'no', '')), []],
])('askSubjects.%s', async (_, answer, expected) => {
  const { link } = fakeLink();
  link.send.mockImplementation(answer as typeof link.send);

  expect(await askSubjects(link)).toEqual(expected);
  expect(link.send).toHaveBeenCalledWith({ case: 'listSubjects', value: {} });
});
