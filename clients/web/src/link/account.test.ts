// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { ErrorCode } from '../generated/dts/v1/control_pb';
import { Role } from '../generated/dts/v1/options_pb';
import { askWho, logIn, logOut, nobody } from './account';

const answering = (status: number, body = '', headers = {}): typeof fetch => async () => new Response(body, { status, headers });
const unreachable: typeof fetch = async () => Promise.reject(new TypeError('no network'));

test.each([
  [401, '', nobody],
  [200, '{"user": "anna", "role": "operator", "can_log_in": true}', { user: 'anna', role: Role.OPERATOR, canLogIn: true, isFleet: false }],
  [200, '{"user": "anna", "role": "viewer", "can_log_in": true, "fleet": true}', { user: 'anna', role: Role.VIEWER, canLogIn: true, isFleet: true }],
  [200, '{"user": 7, "role": "king"}', { user: '', role: Role.UNSPECIFIED, canLogIn: false, isFleet: false }],
])('askWho.%i %s', async (status, body, expected) => {
  expect(await askWho(answering(status, body))).toEqual(expected);
});

test.each<[string, typeof fetch, object]>([
  ['no gateway', unreachable, { code: ErrorCode.UNREACHABLE }],
  ['wrong password', answering(401), { code: ErrorCode.NOT_ALLOWED }],
  ['too many tries', answering(429, '', { 'Retry-After': '12' }), { code: ErrorCode.LIMIT_EXCEEDED, message: expect.stringContaining('12') }],
  ['another error', answering(500, '{"what": "the disk is full", "hint": "free it"}'), { code: ErrorCode.FAILED, message: 'The disk is full', hint: 'Free it' }],
  ['invalid answer', answering(500, '<'), { code: ErrorCode.FAILED, message: expect.stringMatching(/./), hint: '' }],
])('logIn.Fails by %s', async (_, fetchIt, expected) => {
  await expect(logIn(fetchIt, 'anna', 'x')).rejects.toMatchObject(expected);
});

test('account.Good answers are no errors, others are', async () => {
  await expect(logIn(answering(200), 'anna', 'x')).resolves.toBeUndefined();
  await expect(logOut(answering(200))).resolves.toBeUndefined();
  await expect(logOut(answering(403))).rejects.toThrow('403');
  await expect(askWho(answering(502))).rejects.toThrow('502');
});
