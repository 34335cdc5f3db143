// SPDX-License-Identifier: Apache-2.0
import type { ReadonlySignal } from '@preact/signals';
import { signal } from '@preact/signals';
import { useLayoutEffect, useRef } from 'preact/hooks';

const storedAs = 'dts-keys';
const areOn = signal(typeof localStorage === 'undefined' || localStorage.getItem(storedAs) !== 'off'); // no browser in unit tests

/** Whether keys act. Speech input types the letters of a spoken word: its users turn the keys off. */
export const areKeysOn: ReadonlySignal<boolean> = areOn;

/** Keeps the choice in this browser. */
export const turnKeys = (isOn: boolean): void => {
  localStorage.setItem(storedAs, isOn ? 'on' : 'off');
  areOn.value = isOn;
};

/** Returns whether the focused element needs the key: letters in a text field, Space on a button or in a part that it scrolls. */
export const isTakenByFocus = (key: string, tagName: string, tabIndex: number): boolean => {
  const tag = tagName.toUpperCase();
  if (key === ' ' && tabIndex >= 0) return true;
  if (tag === 'INPUT' || tag === 'SELECT' || tag === 'TEXTAREA') return key !== 'Escape';
  return (key === ' ' || key === 'Enter') && (tag === 'BUTTON' || tag === 'A' || tag === 'SUMMARY');
};

/** Binds keys while a component is shown: { a: accept, ' ': mark }, letters in lower case. The first component that was shown wins. */
export const useKeys = (actions: Readonly<Record<string, () => void>>): void => {
  const latest = useRef(actions);
  latest.current = actions;
  // A layout effect: the key works as soon as the page shows it.
  useLayoutEffect(() => {
    const react = (event: KeyboardEvent): void => {
      if (event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
      const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
      const action = latest.current[key];
      const { tagName = '', tabIndex = -1 } = (event.target as Partial<HTMLElement> | null) ?? {};
      if (action === undefined || (key !== 'Escape' && !areOn.peek()) || isTakenByFocus(key, tagName, tabIndex)) return;
      event.preventDefault();
      action();
    };
    document.addEventListener('keydown', react);
    return () => document.removeEventListener('keydown', react);
  }, []);
};
