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

const present = signal(pathOf(location.hash));
addEventListener('hashchange', () => (present.value = pathOf(location.hash)));

export const path: ReadonlySignal<string[]> = present;
