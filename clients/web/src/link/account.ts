// SPDX-License-Identifier: Apache-2.0
// The user: the gateway's /api/me, /api/login and /api/logout.
import { ErrorCode } from '../generated/dts/v1/control_pb';
import { Role } from '../generated/dts/v1/options_pb';
import { asSentence } from '../parts/names';
import { fixed } from '../parts/numbers';
import { strings } from '../strings';
import type { Me } from './types';
import { CommandError } from './types';

const roles: Readonly<Record<string, Role>> = { viewer: Role.VIEWER, operator: Role.OPERATOR, engineer: Role.ENGINEER };
const patienceMs = 2000;

export const nobody: Me = { user: '', role: Role.UNSPECIFIED, canLogIn: true, isFleet: false };

const textOf = (value: unknown): string => (typeof value === 'string' ? value : '');

/** Returns the user. Fails if the gateway cannot be reached or sends an invalid answer. */
export const askWho = async (fetchIt: typeof fetch): Promise<Me> => {
  const response = await fetchIt('/api/me', { cache: 'no-store', signal: AbortSignal.timeout(patienceMs) });
  if (response.status === 401) return nobody;
  if (!response.ok) throw new Error(`/api/me: ${response.status}`);
  const answer = (await response.json()) as { user?: unknown; role?: unknown; can_log_in?: unknown; fleet?: unknown };
  const role = roles[textOf(answer.role)] ?? Role.UNSPECIFIED;
  return { user: textOf(answer.user), role, canLogIn: answer.can_log_in === true, isFleet: answer.fleet === true };
};

export const logIn = async (fetchIt: typeof fetch, user: string, password: string): Promise<void> => {
  const words = strings.common.login;
  let response: Response;
  try {
    response = await fetchIt('/api/login', {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({ user, password }),
    });
  } catch {
    throw new CommandError(ErrorCode.UNREACHABLE, strings.common.command.notConnected, strings.common.link.noGatewayHint);
  }
  if (response.ok) return;
  if (response.status === 401) throw new CommandError(ErrorCode.NOT_ALLOWED, words.wrong, words.wrongHint);
  if (response.status === 429) {
    const seconds = Number(response.headers.get('Retry-After') ?? NaN);
    throw new CommandError(ErrorCode.LIMIT_EXCEEDED, words.tooMany(fixed(seconds, 0)), words.tooManyHint);
  }
  const problem = (await response.json().catch(() => ({}))) as { what?: unknown; hint?: unknown };
  throw new CommandError(ErrorCode.FAILED, asSentence(textOf(problem.what)) || words.failed, asSentence(textOf(problem.hint)));
};

export const logOut = async (fetchIt: typeof fetch): Promise<void> => {
  // The gateway rejects a request without this type, because a foreign page could send it.
  const response = await fetchIt('/api/logout', { method: 'POST', headers: { 'Content-Type': 'application/json' } });
  if (!response.ok) throw new Error(`/api/logout: ${response.status}`);
};
