// SPDX-License-Identifier: Apache-2.0
import { useLayoutEffect, useRef } from 'preact/hooks';

const focusAgain = (before: HTMLElement): void => {
  if (before.isConnected) return before.focus();
  // The form stood in place of the button that opened it: the button is drawn again.
  const testId = before.dataset['testid'];
  if (testId !== undefined) requestAnimationFrame(() => document.querySelector<HTMLElement>(`[data-testid="${CSS.escape(testId)}"]`)?.focus());
};

/**
 * Gives the focus back when a form closes, so that the Tab key does not begin at the top of the page again. Call it before the form takes the focus.
 * A button that was clicked has given up the focus (see Button): then nothing gets it back.
 */
export const useReturnFocus = (): void => {
  const before = useRef(document.activeElement).current; // while the form is drawn for the first time, the button is still there
  useLayoutEffect(
    () => () => {
      if (before instanceof HTMLElement) focusAgain(before);
    },
    [],
  );
};
