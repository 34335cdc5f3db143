// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { runHook } from '../testing';
import type { FormState, StartForm } from './start_form';
import { formAfter, useStartForm } from './start_form';

test.each<[string, FormState, boolean, FormState]>([
  ['OpenForm closes when another client starts a session', 'open', true, 'taken'],
  ['SentForm waits for its answer: the session is its own', 'sending', true, 'sending'],
  ['OpenForm without a session stays', 'open', false, 'open'],
  ['TakenForm says so while that session goes on', 'taken', true, 'taken'],
  ['TakenForm has nothing more to say after that session', 'taken', false, 'closed'],
  ['ClosedForm stays closed', 'closed', true, 'closed'],
])('formAfter.%s', (_name, state, hasSession, expected) => {
  expect(formAfter(state, hasSession)).toBe(expected);
});

test.each<[string, readonly (keyof StartForm & ('open' | 'send' | 'close'))[], boolean]>([
  ['OpenAndSent is shown', ['open', 'send'], true],
  ['AnswerBeforeThePaint closes it for good', ['open', 'send', 'close'], false],
])('StartForm.%s', (_name, steps, isShown) => {
  const form = runHook(() => useStartForm(false), false); // never paints: effects after a paint would be late

  for (const step of steps) {
    form.now()[step]();
    form.draw();
  }

  expect(form.now().isShown).toBe(isShown);
});
