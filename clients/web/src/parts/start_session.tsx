// SPDX-License-Identifier: Apache-2.0
// The form that starts a session: protocol, subject ID, and the fields that the protocol asks for.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import type { ProtocolField, ProtocolInfo } from '../generated/dts/v1/sessions_pb';
import type { Link } from '../link/types';
import { strings } from '../strings';
import { CommandNotice, Field, Notice, Panel, useCommands } from './controls';
import { useKeys } from './keys';
import { protocolName } from './names';
import { fixed, whole } from './numbers';
import type { StartForm } from './start_form';

const words = strings.common.start;

/** Returns all protocols. Asks again after each new connection: a restarted daemon may have others. */
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

/** Returns the protocol of the newest session of a rig, or "" if it has none. */
export const askLastProtocol = async (link: Link, rig: string): Promise<string> => {
  const answer = await link.send({ case: 'listSessions', value: { rig, limit: 1 } }).catch(() => undefined); // then the user has to choose
  return answer?.case === 'sessions' ? (answer.value.sessions[0]?.protocol ?? '') : '';
};

/** Returns the unit at the end of a field's name: "kg" for "weight_kg", "" for "sex" and for a label that has the unit already. */
export const unitOfField = ({ name, sentence }: Pick<ProtocolField, 'name' | 'sentence'>): string => {
  const suffix = name.slice(name.lastIndexOf('_') + 1);
  if (suffix === name || !Object.hasOwn(words.units, suffix)) return '';
  const unit = words.units[suffix] ?? '';
  return sentence.split(' ').at(-1) === unit ? '' : unit;
};

const FieldInput = (props: { field: ProtocolField; value: string; onInput: (value: string) => void }): JSX.Element => {
  const { name, sentence, isRequired, minimum, maximum, choices } = props.field;
  const needed = isRequired ? words.required : words.optional;
  const unit = choices.length > 0 ? '' : unitOfField(props.field);
  const hint = choices.length > 0 ? needed : `${words.range(fixed(minimum, 0), fixed(maximum, 0), unit)}, ${needed}`;
  return (
    <Field label={unit === '' ? sentence : words.withUnit(sentence, unit)} hint={hint}>
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
  trials === 0 ? sentence : `${sentence}. ${durationS > 0 ? words.about(whole(trials), whole(settleS), whole(durationS)) : words.trials(whole(trials))}.`;

export interface StartSessionProps {
  link: Link;
  rig: string;
  protocols: readonly ProtocolInfo[];
  form: StartForm;
}

/** Says that the form closed because another session started. */
export const StartTaken = ({ form, protocol }: { form: StartForm; protocol: string }): JSX.Element | null =>
  form.state.value === 'taken' ? (
    <Notice kind="warning" what={words.taken(protocolName(protocol))} hint={words.takenHint} testId="start-taken" onDismiss={form.close} />
  ) : null;

export const StartSession = ({ link, rig, protocols, form }: StartSessionProps): JSX.Element => {
  const typed = useSignal<string | undefined>(undefined);
  const lastUsed = useSignal('');
  const subject = useSignal('');
  const label = useSignal('');
  const durationS = useSignal('');
  const first = useRef<HTMLSelectElement>(null);
  const fields = useSignal<Readonly<Record<string, string>>>({});
  const commands = useCommands(link);
  const kind = link.status.value?.rigs.find((state) => state.rig?.name === rig)?.rig?.kind;
  const fitting = protocols.filter(({ rigKind }) => rigKind === '' || rigKind === kind);
  const chosen = fitting.find(({ name }) => name === (typed.value ?? lastUsed.value));
  useEffect(() => {
    first.current?.focus();
    void askLastProtocol(link, rig).then((name) => (lastUsed.value = name));
  }, [link, rig]);
  useKeys({ Escape: form.close });
  const submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    if (commands.isBusy.value || chosen === undefined) return;
    form.send();
    const asked = chosen.fields.map(({ name }) => [name, fields.value[name] ?? ''] as const).filter(([, value]) => value !== '');
    const answer = await commands.run({
      case: 'startSession',
      value: {
        rig,
        protocol: chosen.name,
        subject: subject.value.trim(),
        label: label.value.trim(),
        durationS: chosen.trials > 0 ? 0 : Number(durationS.value), // 0: until it is stopped
        fields: Object.fromEntries(asked),
      },
    });
    if (answer !== undefined) form.close();
    else form.failed();
  };
  return (
    <Panel title={words.title} testId="start-session" onClose={form.close}>
      <form class="column" onSubmit={(event) => void submit(event)}>
        <Field label={words.protocol} hint={chosen === undefined ? words.protocolHint : aboutOf(chosen)}>
          {(id) => (
            <select
              id={id}
              ref={first}
              data-testid="start-protocol"
              required
              value={chosen?.name ?? ''}
              onChange={(event) => (typed.value = event.currentTarget.value)}
            >
              <option value="">{words.chooseProtocol}</option>
              {fitting.map(({ name }) => (
                <option key={name} value={name}>
                  {protocolName(name)}
                </option>
              ))}
            </select>
          )}
        </Field>
        <TextInput label={words.subject} hint={words.subjectHint} testId="start-subject" value={subject.value} onInput={(value) => (subject.value = value)} />
        <TextInput label={words.label} hint={words.labelHint} testId="start-label" value={label.value} onInput={(value) => (label.value = value)} />
        {chosen?.trials === 0 && (
          <Field label={chosen.durationS > 0 ? words.durationOr(fixed(chosen.durationS, 0)) : words.duration}>
            {(id) => (
              <input
                id={id}
                data-testid="start-duration"
                type="number" // the browser rejects "60 s"; read as text it would mean manual stop
                step="any"
                min={0}
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
