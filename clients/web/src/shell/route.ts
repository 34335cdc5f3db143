// SPDX-License-Identifier: Apache-2.0
// The hash of the address names the page, so that reload and bookmarks work: "#/sessions/20261121T144525Z-floor-1".
import { signal } from '@preact/signals';
import type { ReadonlySignal } from '@preact/signals';

export const pathOf = (hash: string): string[] =>
  hash
    .replace(/^#\/?/, '')
    .split('/')
    .filter((part) => part !== '')
    .map((part) => {
      try {
        return decodeURIComponent(part);
      } catch {
        return part; // a "%" that was typed, not an escape
      }
    });

/** Returns the path of an address: of its hash, and "/patient" is the patient screen without a hash too. */
export const pathIn = ({ pathname, hash }: Pick<Location, 'pathname' | 'hash'>): string[] => {
  const path = pathOf(hash);
  return pathname === '/patient' && path[0] !== 'patient' ? ['patient', ...path] : path;
};

const present = signal(pathIn(location));

/** The newest address of each live page that names a rig: back from another page, the operator is at the same rig. */
const live = new Map<string, string>();
const remember = ([page = '', rig]: readonly string[]): void => {
  if ((page === 'floor' || page === 'chair') && rig !== undefined) live.set(page, `#/${page}/${encodeURIComponent(rig)}`);
};
remember(present.peek());
addEventListener('hashchange', () => {
  const next = pathIn(location);
  remember(next);
  present.value = next;
});

/** Returns the address to which the tab of a page leads. */
export const addressOf = (page: string): string => live.get(page) ?? `#/${page}`;

export const path: ReadonlySignal<string[]> = present;
