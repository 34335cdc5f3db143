// SPDX-License-Identifier: Apache-2.0
// Requests of pages to the daemon and to the gateway's archive.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';

import type { Link } from '../../link/types';
import { CommandError } from '../../link/types';
import { asSentence } from '../../parts/names';

export interface Asked<T> {
  readonly answer: T | undefined;
  readonly error: CommandError | undefined;
  readonly isBusy: boolean;
}

/**
 * Asks when the page is shown and again whenever `key` changes; the old answer stays on the page meanwhile. Does not ask for an empty key. Ignores
 * answers that arrive after the page was left or after the next request.
 */
export const useAsked = <T>(key: string, ask: (signal: AbortSignal) => Promise<T>): ReadonlySignal<Asked<T>> => {
  const asked = useSignal<Asked<T>>({ answer: undefined, error: undefined, isBusy: key !== '' });
  useEffect(() => {
    if (key === '') return undefined;
    const abort = new AbortController();
    asked.value = { ...asked.peek(), isBusy: true };
    const settle = (result: Pick<Asked<T>, 'answer' | 'error'>): void => {
      if (!abort.signal.aborted) asked.value = { ...result, isBusy: false };
    };
    ask(abort.signal).then(
      (answer) => settle({ answer, error: undefined }),
      (problem: unknown) =>
        settle({ answer: asked.peek().answer, error: problem instanceof CommandError ? problem : new CommandError(0, String(problem), '') }),
    );
    return () => abort.abort();
  }, [key]);
  return asked;
};

/** Changes when a session starts, ends or is resumed on any rig, so that lists are loaded again; empty without a connection. */
export const sessionsKey = (link: Link): string =>
  link.state.value !== 'up'
    ? ''
    : `sessions ${(link.status.value?.rigs ?? []).map((rig) => `${rig.session?.sessionId ?? ''} ${rig.session?.state ?? 0}`).join()}`;

const fieldOf = (json: unknown, name: string): string => {
  const value: unknown = typeof json === 'object' && json !== null ? (json as Record<string, unknown>)[name] : undefined;
  return typeof value === 'string' ? value : '';
};

/** Returns the archive's error of a failed response. */
export const responseError = async (response: Response): Promise<CommandError> => {
  const json: unknown = await response.json().catch(() => undefined);
  return new CommandError(0, asSentence(fieldOf(json, 'what')) || `${response.status} ${response.statusText}`, asSentence(fieldOf(json, 'hint')));
};

export const archiveUrl = (sessionId: string, path: string): string => `/api/sessions/${encodeURIComponent(sessionId)}/${path}`;
