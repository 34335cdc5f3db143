// SPDX-License-Identifier: Apache-2.0
// The state of the form that starts a session: shown or not, and why not.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';

/** `sending`: the command was sent, a session that begins now belongs to this form. `taken`: the form closed because another session began. */
export type FormState = 'closed' | 'open' | 'sending' | 'taken';

/** Returns the next state for a rig that has a session, or has none. */
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
  /** No session was started; the form stays open for another attempt. */
  failed(): void;
}

export const useStartForm = (hasSession: boolean): StartForm => {
  const state = useSignal<FormState>('closed');
  const present = formAfter(state.value, hasSession);
  // Effects run late: the answer may have closed the form since it was drawn. Therefore `present` is not stored.
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
