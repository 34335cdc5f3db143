// SPDX-License-Identifier: Apache-2.0
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import { CommandError } from '../link/types';
import type { Link } from '../link/types';
import { Field, Notice } from '../parts/controls';
import { strings } from '../strings';

const words = strings.common.login;

export const LoginPage = ({ link }: { link: Link }): JSX.Element => {
  const user = useSignal('');
  const password = useSignal('');
  const isBusy = useSignal(false);
  const error = useSignal<CommandError | undefined>(undefined);
  const submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    if (isBusy.value) return;
    isBusy.value = true;
    error.value = undefined;
    try {
      await link.logIn(user.value, password.value);
    } catch (problem) {
      error.value = problem instanceof CommandError ? problem : new CommandError(0, words.failed, '');
    }
    password.value = '';
    isBusy.value = false;
  };
  if (!link.me.value.canLogIn) return <Notice kind="warning" what={words.noLogin} hint={words.noLoginHint} testId="no-login" />;
  return (
    <form class="panel login" data-testid="login" onSubmit={(event) => void submit(event)}>
      <h1>{words.title}</h1>
      <p>{words.sentence}</p>
      <Field label={words.user}>
        {(links) => (
          <input
            {...links}
            data-testid="login-user"
            autocomplete="username"
            required
            value={user.value}
            onInput={(event) => (user.value = event.currentTarget.value)}
          />
        )}
      </Field>
      <Field label={words.password}>
        {(links) => (
          <input
            {...links}
            data-testid="login-password"
            type="password"
            autocomplete="current-password"
            required
            value={password.value}
            onInput={(event) => (password.value = event.currentTarget.value)}
          />
        )}
      </Field>
      {error.value !== undefined && <Notice kind="error" what={error.value.message} hint={error.value.hint} testId="login-error" />}
      <button type="submit" class="button button-main" data-testid="login-submit" aria-disabled={isBusy.value}>
        {isBusy.value ? strings.common.busy : strings.common.logIn}
      </button>
    </form>
  );
};
