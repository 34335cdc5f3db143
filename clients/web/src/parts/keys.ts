// SPDX-License-Identifier: Apache-2.0
import { useLayoutEffect, useRef } from 'preact/hooks';

/** What a key means on the focused element comes first: letters belong to a text field, space presses the focused button. */
export const isTakenByFocus = (key: string, tagName: string): boolean => {
  const tag = tagName.toUpperCase();
  if (tag === 'INPUT' || tag === 'SELECT' || tag === 'TEXTAREA') return key !== 'Escape';
  return (key === ' ' || key === 'Enter') && (tag === 'BUTTON' || tag === 'A' || tag === 'SUMMARY');
};

/** Keys of a page while it is shown: { a: accept, ' ': mark }, letters in lower case. */
export const useKeys = (actions: Readonly<Record<string, () => void>>): void => {
  const latest = useRef(actions);
  latest.current = actions;
  // As soon as it is drawn: a key counts from when the page says that it does something.
  useLayoutEffect(() => {
    const react = (event: KeyboardEvent): void => {
      if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
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
