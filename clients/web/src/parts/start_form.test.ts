// SPDX-License-Identifier: Apache-2.0
import { h, options, render } from 'preact';
import { expect, test, vi } from 'vitest';

import type { FormState, StartForm } from './start_form';
import { formAfter, useStartForm } from './start_form';

test.each<[string, FormState, boolean, FormState]>([
  ['OpenForm closes when somebody else starts a session', 'open', true, 'taken'],
  ['SentForm waits for its answer: the session is its own', 'sending', true, 'sending'],
  ['OpenForm without a session stays', 'open', false, 'open'],
  ['TakenForm says so while that session goes on', 'taken', true, 'taken'],
  ['TakenForm has nothing more to say after that session', 'taken', false, 'closed'],
  ['ClosedForm stays closed', 'closed', true, 'closed'],
])('formAfter.%s', (_name, state, hasSession, expected) => {
  expect(formAfter(state, hasSession)).toBe(expected);
});

/** What the form is after steps between which Preact draws, but never paints: what it does after a paint is late. */
const shownAfter = (steps: readonly ((form: StartForm) => void)[]): boolean => {
  let form: StartForm | undefined;
  let draw = (): void => undefined;
  options.debounceRendering = (run) => (draw = run);
  options.requestAnimationFrame = () => undefined;
  const Page = (): null => {
    form = useStartForm(false);
    return null;
  };
  vi.stubGlobal('document', {}); // Preact compares with it
  render(h(Page, {}), { childNodes: [] } as unknown as Element); // nothing is drawn into it
  for (const step of steps) {
    step(form!);
    draw();
  }
  return form!.isShown;
};

test('StartForm.AnswerBeforeThePaint closes it for good', () => {
  expect(shownAfter([(form) => form.open(), (form) => form.send()])).toBe(true);
  expect(shownAfter([(form) => form.open(), (form) => form.send(), (form) => form.close()])).toBe(false);
});
