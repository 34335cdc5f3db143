// SPDX-License-Identifier: Apache-2.0
// The form that starts a session: protocol, subject ID, and the fields that the protocol asks for.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';

import type { ProtocolField, ProtocolInfo } from '../generated/dts/v1/sessions_pb';
import type { Link } from '../link/types';
import { strings } from '../strings';
import { CommandNotice, Field, Notice, Panel, useCommands } from './controls';
import { useReturnFocus } from './focus';
import { useKeys } from './keys';
import { choiceName, isLabel, labelRule, protocolName, protocols } from './names';
import { duration, fixed, whole } from './numbers';
import type { StartForm } from './start_form';
import { askSubjects, similarSubject } from './subject_ids';

const words = strings.common.start;

/** Returns the protocol of the newest session of a rig, or "" if it has none. */
export const askLastProtocol = async (link: Link, rig: string): Promise<string> => {
  const answer = await link.send({ case: 'listSessions', value: { rig, limit: 1 } }).catch(() => undefined); // then the user has to choose
  return answer?.case === 'sessions' ? (answer.value.sessions[0]?.protocol ?? '') : '';
};

type Values = Readonly<Record<string, string>>;

interface FieldProps {
  field: ProtocolField;
  value: string;
  error: string | undefined;
  onInput: (value: string) => void;
}

/** A field of a protocol: "Body weight (kg)", its range and what it means below. */
const FieldInput = ({ field, value, error, onInput }: FieldProps): JSX.Element => {
  const { name, label, unit, help, isRequired, minimum, maximum, choices } = field;
  const isChoice = choices.length > 0;
  const range = isChoice ? '' : words.range(fixed(minimum, 0), fixed(maximum, 0));
  return (
    <Field label={unit === '' ? label : words.withUnit(label, unit)} hint={[range, help].filter((part) => part !== '').join('. ')} error={error}>
      {(links) =>
        isChoice ? (
          <select
            {...links}
            name={name}
            data-testid={`field-${name}`}
            required={isRequired}
            value={value}
            onChange={(event) => onInput(event.currentTarget.value)}
          >
            <option value="">{words.choose}</option>
            {choices.map((choice) => (
              <option key={choice} value={choice}>
                {choiceName(field, choice)}
              </option>
            ))}
          </select>
        ) : (
          <input
            {...links}
            name={name}
            data-testid={`field-${name}`}
            type="number"
            step="any"
            min={minimum}
            max={maximum}
            required={isRequired}
            value={value}
            onInput={(event) => onInput(event.currentTarget.value)}
          />
        )
      }
    </Field>
  );
};

interface TextProps {
  name: 'subject' | 'label';
  hint: string;
  value: string;
  error: string | undefined;
  onInput: (value: string) => void;
}

const TextInput = ({ name, hint, value, error, onInput }: TextProps): JSX.Element => (
  <Field label={words[name]} hint={hint} error={error}>
    {(links) => (
      <input
        {...links}
        name={name}
        data-testid={`start-${name}`}
        maxLength={64}
        autocomplete="off"
        value={value}
        onInput={(event) => onInput(event.currentTarget.value)}
      />
    )}
  </Field>
);

/** "Standing still, eyes open and closed. 4 trials, 2:20 min without pauses." */
const aboutOf = ({ sentence, trials, lengthS }: ProtocolInfo): string => {
  if (trials === 0) return sentence;
  const count = words.trials(whole(trials));
  return `${sentence}. ${lengthS === undefined ? count : words.length(count, duration(lengthS))}.`;
};

/** Check boxes of the other rigs. */
const Companions = ({ rigs, chosen, onChange }: { rigs: readonly string[]; chosen: readonly string[]; onChange: (rigs: readonly string[]) => void }): JSX.Element => (
  <fieldset class="column" data-testid="start-companions">
    <legend>{words.companions}</legend>
    {rigs.map((name) => (
      <label key={name} class="row">
        <input
          type="checkbox"
          data-testid={`companion-${name}`}
          checked={chosen.includes(name)}
          onChange={(event) => onChange(event.currentTarget.checked ? [...chosen, name] : chosen.filter((one) => one !== name))}
        />
        {name}
      </label>
    ))}
    <small>{words.companionsHint}</small>
  </fieldset>
);

/** Names of the inputs that are no fields of the protocol. */
const ownInputs = new Set(['protocol', 'subject', 'label', 'duration']);

/** Returns what is wrong with an input, with its label; nothing if it is right. */
const wrongOf = (input: HTMLInputElement | HTMLSelectElement, label: string, unit: string): string | undefined => {
  const { valueMissing, badInput, rangeUnderflow, rangeOverflow } = input.validity;
  if (valueMissing && !badInput) return words.wrong.missing(label);
  if (badInput) return words.wrong.number(label);
  if (!rangeUnderflow && !rangeOverflow) return undefined;
  const { min, max } = input as HTMLInputElement;
  return max === '' ? words.wrong.number(label) : words.wrong.range(label, min, max, unit);
};

/** Returns the name of the input that a message of the daemon is about, or "" if it names none. */
export const inputNamedIn = (message: string, fields: readonly Pick<ProtocolField, 'name' | 'label'>[]): string => {
  const field = fields.find(({ name, label }) => message.includes(`'${name}'`) || message.includes(label));
  if (field !== undefined) return field.name;
  return /\bsubject ID\b/i.exec(message) !== null ? 'subject' : /\blabels?\b/i.exec(message) !== null ? 'label' : '';
};

/** Returns the title of the form. With several rigs it names the rig: on the page of a subject nothing else does. */
export const titleOf = (rig: string, others: readonly string[]): string => (others.length === 0 ? words.title : words.titleOn(rig));

export interface StartSessionProps {
  link: Link;
  rig: string;
  form: StartForm;
  /** The form begins with these; absent: no subject, and the protocol that the rig used last. */
  subject?: string;
  protocol?: string;
  onStarted?: () => void;
}

/** Says that the form closed because another session started. */
export const StartTaken = ({ form, protocol }: { form: StartForm; protocol: string }): JSX.Element | null =>
  form.state.value === 'taken' ? (
    <Notice kind="warning" what={words.taken(protocolName(protocol))} hint={words.takenHint} testId="start-taken" onDismiss={form.close} />
  ) : null;

export const StartSession = ({ link, rig, form, subject = '', protocol = '', onStarted }: StartSessionProps): JSX.Element => {
  const typed = useSignal<string | undefined>(protocol === '' ? undefined : protocol);
  const lastUsed = useSignal('');
  const subjects = useSignal<readonly string[]>([]);
  const values = useSignal<Values>({ subject });
  const wrong = useSignal<Values>({});
  const companions = useSignal<readonly string[]>([]);
  const first = useRef<HTMLSelectElement>(null);
  const commands = useCommands(link);
  const others = (link.status.value?.rigs ?? []).map((state) => state.rig?.name ?? '').filter((name) => name !== '' && name !== rig);
  const kind = link.status.value?.rigs.find((state) => state.rig?.name === rig)?.rig?.kind;
  const fitting = protocols.value.filter(({ rigKind }) => rigKind === '' || rigKind === kind);
  const chosen = fitting.find(({ name }) => name === (typed.value ?? lastUsed.value));
  const fields = chosen?.fields ?? [];
  useReturnFocus();
  useLayoutEffect(() => first.current?.focus(), []);
  useEffect(() => {
    void askLastProtocol(link, rig).then((name) => (lastUsed.value = name));
    void askSubjects(link).then((known) => (subjects.value = known));
  }, [link, rig]);
  useKeys({ Escape: form.close });

  const valueOf = (name: string): string => values.value[name] ?? '';
  const set = (name: string) => (value: string): void => {
    values.value = { ...values.value, [name]: value };
    wrong.value = { ...wrong.value, [name]: '' };
  };
  const similar = similarSubject(subjects.value, valueOf('subject').trim());
  const labelOf = (name: string): string =>
    ownInputs.has(name) ? words[name as 'protocol' | 'subject' | 'label' | 'duration'] : (fields.find((one) => one.name === name)?.label ?? name);
  const unitOf = (name: string): string => fields.find((one) => one.name === name)?.unit ?? '';
  /** Shows what is wrong beside each input, and moves to the first. Returns whether all are right. */
  const check = (element: HTMLFormElement): boolean => {
    const inputs = [...element.elements].filter((one): one is HTMLInputElement | HTMLSelectElement => 'validity' in one && 'name' in one && one.name !== '');
    const found: Record<string, string> = {};
    for (const input of inputs) found[input.name] = wrongOf(input, labelOf(input.name), unitOf(input.name)) ?? '';
    if (!isLabel(valueOf('label').trim())) found['label'] = `${words.label}: ${labelRule.value.hint || words.labelHint}`;
    wrong.value = found;
    const firstWrong = inputs.find(({ name }) => found[name] !== '');
    firstWrong?.focus();
    return firstWrong === undefined;
  };
  const submit = async (event: Event): Promise<void> => {
    event.preventDefault();
    const element = event.currentTarget as HTMLFormElement;
    if (commands.isBusy.value || !check(element) || chosen === undefined) return;
    form.send();
    const asked = fields.map(({ name }) => [name, valueOf(name)] as const).filter(([, value]) => value !== '');
    const answer = await commands.run({
      case: 'startSession',
      value: {
        rig,
        protocol: chosen.name,
        subject: valueOf('subject').trim(),
        label: valueOf('label').trim(),
        durationS: chosen.trials > 0 ? 0 : Number(valueOf('duration')), // 0: until it is stopped
        fields: Object.fromEntries(asked),
        companions: companions.value.filter((name) => others.includes(name)),
      },
    });
    if (answer !== undefined) {
      form.close();
      return onStarted?.();
    }
    form.failed();
    const error = commands.error.peek();
    const name = inputNamedIn(error?.message ?? '', fields);
    if (error === undefined || name === '') return;
    commands.dismiss(); // shown beside the input instead
    wrong.value = { ...wrong.value, [name]: `${labelOf(name)}: ${error.message}. ${error.hint}` };
    element.querySelector<HTMLElement>(`[name="${name}"]`)?.focus();
  };
  const input = (field: ProtocolField): JSX.Element => (
    <FieldInput key={field.name} field={field} value={valueOf(field.name)} error={wrong.value[field.name]} onInput={set(field.name)} />
  );
  return (
    <Panel title={titleOf(rig, others)} testId="start-session" onClose={form.close}>
      <form class="column" noValidate onSubmit={(event) => void submit(event)}>
        <Field label={words.protocol} hint={chosen === undefined ? '' : aboutOf(chosen)} error={wrong.value['protocol']}>
          {(links) => (
            <select
              {...links}
              ref={first}
              name="protocol"
              data-testid="start-protocol"
              required
              value={chosen?.name ?? ''}
              onChange={(event) => {
                typed.value = event.currentTarget.value;
                wrong.value = {};
              }}
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
        <TextInput
          name="subject"
          hint={similar === '' ? words.subjectHint : words.similarSubject(similar, valueOf('subject').trim())}
          value={valueOf('subject')}
          error={wrong.value['subject']}
          onInput={set('subject')}
        />
        <div class="form-grid">{fields.filter(({ isRequired }) => isRequired).map(input)}</div>
        <CommandNotice commands={commands} testId="start-error" />
        <button type="submit" class="button button-main" data-testid="start-submit" aria-disabled={commands.isBusy.value}>
          {commands.isBusy.value ? strings.common.busy : words.submit}
        </button>
        <fieldset class="column start-optional">
          <legend>{words.optional}</legend>
          <TextInput
            name="label"
            hint={labelRule.value.hint || words.labelHint}
            value={valueOf('label')}
            error={wrong.value['label']}
            onInput={set('label')}
          />
          {chosen?.trials === 0 && (
            <Field
              label={words.duration}
              hint={chosen.durationS !== undefined && chosen.durationS > 0 ? words.durationOr(fixed(chosen.durationS, 0)) : words.durationHint}
              error={wrong.value['duration']}
            >
              {(links) => (
                <input
                  {...links}
                  name="duration"
                  data-testid="start-duration"
                  type="number" // "60 s" is no number; read as text it would mean manual stop
                  step="any"
                  min={0}
                  value={valueOf('duration')}
                  onInput={(event) => set('duration')(event.currentTarget.value)}
                />
              )}
            </Field>
          )}
          <div class="form-grid">{fields.filter(({ isRequired }) => !isRequired).map(input)}</div>
          {others.length > 0 && <Companions rigs={others} chosen={companions.value} onChange={(rigs) => (companions.value = rigs)} />}
        </fieldset>
      </form>
    </Panel>
  );
};
