// SPDX-License-Identifier: Apache-2.0
// What a session needs to know before it starts: a protocol, whom, and what that protocol asks about them.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect } from 'preact/hooks';

import type { ProtocolField, ProtocolInfo } from '../generated/dts/v1/sessions_pb';
import type { Link } from '../link/types';
import { strings } from '../strings';
import { CommandNotice, Field, Notice, Panel, useCommands } from './controls';
import { fixed, whole } from './numbers';
import type { StartForm } from './start_form';

const words = strings.common.start;

/** All protocols, once there is a connection, and again after each new one: the daemon may have others after a restart. */
export const useProtocols = (link: Link): ReadonlySignal<readonly ProtocolInfo[]> => {
  const protocols = useSignal<readonly ProtocolInfo[]>([]);
  const state = link.state.value;
  useEffect(() => {
    if (state !== 'up') return;
    link.send({ case: 'listProtocols', value: {} }).then(
      (answer) => {
        if (answer.case === 'protocols') protocols.value = answer.value.protocols;
      },
      () => undefined, // the next connection asks again
    );
  }, [link, state]);
  return protocols;
};

const FieldInput = (props: { field: ProtocolField; value: string; onInput: (value: string) => void }): JSX.Element => {
  const { name, sentence, isRequired, minimum, maximum, choices } = props.field;
  const needed = isRequired ? words.required : words.optional;
  const hint = choices.length > 0 ? needed : `${words.range(fixed(minimum, 0), fixed(maximum, 0))}, ${needed}`;
  return (
    <Field label={sentence} hint={hint}>
      {(id) =>
        choices.length > 0 ? (
          <select id={id} data-testid={`field-${name}`} required={isRequired} value={props.value} onChange={(event) => props.onInput(event.currentTarget.value)}>
            <option value="">{words.choose}</option>
            {choices.map((choice) => (
              <option key={choice} value={choice}>
                {choice}
              </option>
            ))}
          </select>
        ) : (
          <input
            id={id}
            data-testid={`field-${name}`}
            type="number"
            step="any"
            min={minimum}
            max={maximum}
            required={isRequired}
            value={props.value}
            onInput={(event) => props.onInput(event.currentTarget.value)}
          />
        )
      }
    </Field>
  );
};

const TextInput = (props: { label: string; hint?: string; testId: string; value: string; onInput: (value: string) => void }): JSX.Element => (
  <Field label={props.label} hint={props.hint ?? ''}>
    {(id) => (
      <input
        id={id}
        data-testid={props.testId}
        maxLength={64}
        autocomplete="off"
        value={props.value}
        onInput={(event) => props.onInput(event.currentTarget.value)}
      />
    )}
  </Field>
);

const aboutOf = ({ sentence, trials, settleS, durationS = 0 }: ProtocolInfo): string =>
  trials > 0 && durationS > 0 ? `${sentence}. ${words.about(whole(trials), whole(settleS), whole(durationS))}` : sentence;

export interface StartSessionProps {
  link: Link;
  rig: string;
  protocols: readonly ProtocolInfo[];
  form: StartForm;
}

/** Why the form is gone. */
export const StartTaken = ({ form, protocol }: { form: StartForm; protocol: string }): JSX.Element | null =>
  form.state.value === 'taken' ? (
    <Notice kind="warning" what={words.taken(protocol)} hint={words.takenHint} testId="start-taken" onDismiss={form.close} />
  ) : null;

export const StartSession = ({ link, rig, protocols, form }: StartSessionProps): JSX.Element => {
  const protocol = useSignal('free');
  const subject = useSignal('');
  const label = useSignal('');
  const durationS = useSignal('0');
  const fields = useSignal<Readonly<Record<string, string>>>({});
  const commands = useCommands(link);
  const kind = link.status.value?.rigs.find((state) => state.rig?.name === rig)?.rig?.kind;
  const fitting = protocols.filter(({ rigKind }) => rigKind === '' || rigKind === kind);
  const chosen = fitting.find(({ name }) => name === protocol.value);
  const submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    if (commands.isBusy.value) return;
    form.send();
    const asked = (chosen?.fields ?? []).map(({ name }) => [name, fields.value[name] ?? ''] as const).filter(([, value]) => value !== '');
    const answer = await commands.run({
      case: 'startSession',
      value: {
        rig,
        protocol: protocol.value,
        subject: subject.value.trim(),
        label: label.value.trim(),
        durationS: (chosen?.trials ?? 0) > 0 ? 0 : Number(durationS.value),
        fields: Object.fromEntries(asked),
      },
    });
    if (answer !== undefined) form.close();
    else form.failed();
  };
  return (
    <Panel title={words.title} testId="start-session" onClose={form.close}>
      <form class="column" onSubmit={(event) => void submit(event)}>
        <Field label={words.protocol} hint={chosen === undefined ? '' : aboutOf(chosen)}>
          {(id) => (
            <select id={id} data-testid="start-protocol" value={protocol.value} onChange={(event) => (protocol.value = event.currentTarget.value)}>
              {fitting.map(({ name }) => (
                <option key={name} value={name}>
                  {name}
                </option>
              ))}
            </select>
          )}
        </Field>
        <TextInput label={words.subject} hint={words.subjectHint} testId="start-subject" value={subject.value} onInput={(value) => (subject.value = value)} />
        <TextInput label={words.label} testId="start-label" value={label.value} onInput={(value) => (label.value = value)} />
        {(chosen?.trials ?? 0) === 0 && (
          <Field label={words.duration}>
            {(id) => (
              <input
                id={id}
                data-testid="start-duration"
                type="number" // "60 s" is refused: as no number it would mean until stopped
                step="any"
                min={0}
                required
                value={durationS.value}
                onInput={(event) => (durationS.value = event.currentTarget.value)}
              />
            )}
          </Field>
        )}
        {chosen?.fields.map((field) => (
          <FieldInput
            key={field.name}
            field={field}
            value={fields.value[field.name] ?? ''}
            onInput={(value) => (fields.value = { ...fields.value, [field.name]: value })}
          />
        ))}
        <CommandNotice commands={commands} testId="start-error" />
        <button type="submit" class="button button-main" data-testid="start-submit" disabled={commands.isBusy.value}>
          {commands.isBusy.value ? strings.common.busy : words.submit}
        </button>
      </form>
    </Panel>
  );
};
