// SPDX-License-Identifier: Apache-2.0
// The theme: light, dark, or as the system. The browser remembers the choice.
import { effect, signal } from '@preact/signals';

import { readColours } from '../parts/canvas';

export type ThemeChoice = 'auto' | 'light' | 'dark';
export const themeChoices: readonly ThemeChoice[] = ['auto', 'light', 'dark'];
const storedAs = 'dts-theme';

const stored = (): ThemeChoice => {
  const value = localStorage.getItem(storedAs);
  return themeChoices.find((choice) => choice === value) ?? 'auto';
};

export const themeChoice = signal<ThemeChoice>('auto');

/** Call it once, before the first page is drawn. */
export const startTheme = (): void => {
  themeChoice.value = stored();
  const system = matchMedia('(prefers-color-scheme: dark)');
  const apply = (): void => {
    const isDark = themeChoice.peek() === 'dark' || (themeChoice.peek() === 'auto' && system.matches);
    document.documentElement.dataset['theme'] = isDark ? 'dark' : 'light';
    readColours();
  };
  system.addEventListener('change', apply);
  effect(() => {
    localStorage.setItem(storedAs, themeChoice.value);
    apply();
  });
};
