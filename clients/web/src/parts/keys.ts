// SPDX-License-Identifier: Apache-2.0
import { useLayoutEffect, useRef } from 'preact/hooks';

/** Returns whether the focused element needs the key: letters in a text field, Space on a button. */
export const isTakenByFocus = (key: string, tagName: string): boolean => {
  const tag = tagName.toUpperCase();
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
      if (action === undefined || isTakenByFocus(key, (event.target as Element | null)?.tagName ?? '')) return;
      event.preventDefault();
      action();
    };
    document.addEventListener('keydown', react);
    return () => document.removeEventListener('keydown', react);
  }, []);
};
