// SPDX-License-Identifier: Apache-2.0
// The page is in the address's hash, so that a reload and a bookmark come back to it: "#/sessions/20261121T144525Z-floor-1".
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
        return part; // a lone "%" is somebody's typing, not an escape
      }
    });

const present = signal(pathOf(location.hash));
addEventListener('hashchange', () => (present.value = pathOf(location.hash)));

export const path: ReadonlySignal<string[]> = present;
