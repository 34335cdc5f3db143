// SPDX-License-Identifier: Apache-2.0
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';

import type { CommandError, Link } from '../../link/types';
import type { Session, Sessions } from './asking';
import { askCentre } from './asking';

export interface SessionPages {
  /** Of all pages so far; undefined until the first answer. */
  readonly sessions: readonly Session[] | undefined;
  readonly error: CommandError | undefined;
  readonly hasOlder: boolean;
  /** Appends the next page. Does nothing while a page is loading. */
  readonly loadOlder: () => void;
}

/** Asks the centre for the newest sessions, and again whenever the query changes. */
export const useSessionPages = (link: Link, query: string): SessionPages => {
  const sessions = useSignal<readonly Session[] | undefined>(undefined);
  const next = useSignal<string | null>(null);
  const error = useSignal<CommandError | undefined>(undefined);
  const isLoading = useRef(false);
  const abort = useRef(new AbortController()); // of this query: pages of the query before must not be appended

  /** Replaces the list, or appends the page that begins at `before`. */
  const load = async (before: string): Promise<void> => {
    const { signal } = abort.current;
    const joined = before === '' ? query : `${query}${query === '' ? '?' : '&'}before=${encodeURIComponent(before)}`;
    isLoading.current = true;
    try {
      const page = await askCentre<Sessions>(link, `sessions${joined}`, signal);
      if (signal.aborted) return;
      sessions.value = before === '' ? page.sessions : [...(sessions.value ?? []), ...page.sessions];
      next.value = page.next;
      error.value = undefined;
    } catch (problem) {
      if (signal.aborted) return;
      if (before === '') next.value = null; // the list is still that of the query before
      error.value = problem as CommandError;
    }
    isLoading.current = false;
  };
  useEffect(() => {
    abort.current = new AbortController();
    void load('');
    return () => abort.current.abort();
  }, [query]);

  const loadOlder = (): void => {
    if (!isLoading.current && next.value !== null) void load(next.value);
  };
  return { sessions: sessions.value, error: error.value, hasOlder: next.value !== null, loadOlder };
};
