// SPDX-License-Identifier: Apache-2.0
import { expect, test, vi } from 'vitest';

vi.stubGlobal('location', { pathname: '/', hash: '' });
vi.stubGlobal('addEventListener', vi.fn());
const { pathIn } = await import('./route');

test.each([
  ['/', '', []],
  ['/', '#/floor/plate', ['floor', 'plate']],
  ['/', '#/patient/floor', ['patient', 'floor']],
  ['/patient', '', ['patient']],
  ['/patient', '#/chair', ['patient', 'chair']],
  ['/patient', '#/patient/chair', ['patient', 'chair']],
])('pathIn(%s %s)', (pathname, hash, expected) => {
  expect(pathIn({ pathname, hash })).toEqual(expected);
});
