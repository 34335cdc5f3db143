// SPDX-License-Identifier: Apache-2.0
// Whether the form that starts a session is in sight.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';

/** `sending`: the daemon was asked; a session that begins now is this form's. `taken`: it closed, since a session began that is not. */
export type FormState = 'closed' | 'open' | 'sending' | 'taken';

/** What becomes of it when the rig has a session, or none. */
export const formAfter = (state: FormState, hasSession: boolean): FormState => {
  if (state === 'open' && hasSession) return 'taken';
  if (state === 'taken' && !hasSession) return 'closed';
  return state;
};

export interface StartForm {
  readonly state: ReadonlySignal<FormState>;
  readonly isShown: boolean;
  open(): void;
  close(): void;
  send(): void;
  /** Nothing was started: it can be tried again. */
  failed(): void;
}

export const useStartForm = (hasSession: boolean): StartForm => {
  const state = useSignal<FormState>('closed');
  const present = formAfter(state.value, hasSession);
  // Effects run late: the answer may have closed the form since it was drawn, so `present` is not what to keep.
  useEffect(() => void (state.value = formAfter(state.peek(), hasSession)), [state.value, hasSession]);
  return {
    state,
    isShown: present === 'open' || present === 'sending',
    open: () => (state.value = 'open'),
    close: () => (state.value = 'closed'),
    send: () => (state.value = 'sending'),
    failed: () => (state.value = 'open'),
  };
};
