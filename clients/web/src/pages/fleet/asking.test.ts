// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from 'vitest';

import { ErrorCode } from '../../generated/dts/v1/control_pb';
import type { Link } from '../../link/types';
import { askCentre } from './asking';

afterEach(() => vi.unstubAllGlobals());

const signal = new AbortController().signal;
const linkWith = (checkLogin = vi.fn()): Link => ({ checkLogin }) as unknown as Link;
const answering = (status: number, body: string) => {
  const asked = vi.fn(async (_url: string) => new Response(body, { status }));
  vi.stubGlobal('fetch', asked);
  return asked;
};

test('askCentre.Answer', async () => {
  const asked = answering(200, '{"clinics": []}');

  expect(await askCentre(linkWith(), 'clinics', signal)).toEqual({ clinics: [] });
  expect(asked.mock.calls[0]![0]).toBe('/api/fleet/clinics');
});

test('askCentre.Ended login: the link asks who the user is', async () => {
  answering(401, '{"what": "not logged in", "hint": "log in first"}');
  const checkLogin = vi.fn();

  await expect(askCentre(linkWith(checkLogin), 'clinics', signal)).rejects.toMatchObject({ message: 'Not logged in' });
  expect(checkLogin).toHaveBeenCalledOnce();
});

test('askCentre.Error of the centre', async () => {
  answering(503, '{"what": "the database of the centre does not answer", "hint": "check PostgreSQL"}');
  const checkLogin = vi.fn();

  await expect(askCentre(linkWith(checkLogin), 'clinics', signal)).rejects.toMatchObject({ message: 'The database of the centre does not answer', hint: 'Check PostgreSQL' });
  expect(checkLogin).not.toHaveBeenCalled();
});

test('askCentre.No network', async () => {
  vi.stubGlobal('fetch', async () => Promise.reject(new TypeError('no network')));

  await expect(askCentre(linkWith(), 'clinics', signal)).rejects.toMatchObject({ code: ErrorCode.UNREACHABLE, hint: expect.stringMatching(/./) });
});
