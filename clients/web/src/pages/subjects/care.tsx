// SPDX-License-Identifier: Apache-2.0
// What an operator does for a subject: starts a session, plans sessions, writes notes.
import type { MessageInitShape } from '@bufbuild/protobuf';
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect, useRef } from 'preact/hooks';

import type { EditSubjectRequestSchema, SubjectRecord } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { isActive } from '../../parts/active';
import { Button, CommandNotice, Field, useCommands, whyNotOperate } from '../../parts/controls';
import { isLabel, labelRule, protocolName, protocols } from '../../parts/names';
import { dateTime, day } from '../../parts/numbers';
import { useStartForm } from '../../parts/start_form';
import { StartSession } from '../../parts/start_session';
import { strings } from '../../strings';

const words = strings.subjects;

export interface CareProps {
  link: Link;
  record: SubjectRecord;
  /** A change was made. */
  onChanged: () => void;
}

interface Wish {
  readonly rig: string;
  readonly protocol: string;
}

interface Rig {
  readonly name: string;
  readonly kind: string;
  readonly isBusy: boolean;
}

const rigsOf = (link: Link): readonly Rig[] =>
  (link.status.value?.rigs ?? []).map(({ rig, session }) => ({ name: rig?.name ?? '', kind: rig?.kind ?? '', isBusy: isActive(session) }));

/** Returns the rigs for which a protocol is made, also those in a session. None if dtsd does not have the protocol. */
export const rigsFor = (link: Link, protocol: string): readonly Rig[] => {
  const kind = protocols.value.find(({ name }) => name === protocol)?.rigKind;
  return rigsOf(link).filter((rig) => kind === '' || rig.kind === kind);
};

const whyNotStart = (link: Link, { name, isBusy }: Rig): string => whyNotOperate(link) || (isBusy ? words.start.busy(name) : '');

const StartPanel = ({ link, subject, wish, onClosed }: { link: Link; subject: string; wish: Wish; onClosed: () => void }): JSX.Element => {
  const form = useStartForm(false);
  const kind = rigsOf(link).find(({ name }) => name === wish.rig)?.kind ?? '';
  const shown = { ...form, close: onClosed };
  return (
    <StartSession
      link={link}
      rig={wish.rig}
      form={shown}
      subject={subject}
      protocol={wish.protocol}
      onStarted={() => (location.hash = `#/${kind === 'chair' ? 'chair' : 'floor'}/${encodeURIComponent(wish.rig)}`)}
    />
  );
};

/** Removes with the second press: nothing brings back what was removed. */
const RemoveButton = (props: { label: string; whyNot: string; testId: string; onRemove: () => void }): JSX.Element => {
  const isAsked = useSignal(false);
  useEffect(() => {
    if (!isAsked.value) return undefined;
    const timer = setTimeout(() => (isAsked.value = false), 5000); // a first press by mistake is forgotten
    return () => clearTimeout(timer);
  }, [isAsked.value]);
  return (
    <Button
      label={isAsked.value ? words.removeForGood(props.label) : words.remove(props.label)}
      kind={isAsked.value ? 'danger' : 'plain'}
      testId={props.testId}
      onClick={() => {
        if (isAsked.value) props.onRemove();
        isAsked.value = !isAsked.value;
      }}
      whyNot={props.whyNot}
    />
  );
};

type Change = NonNullable<MessageInitShape<typeof EditSubjectRequestSchema>['change']>;

const useChange = ({ link, record, onChanged }: CareProps) => {
  const commands = useCommands(link);
  const subject = record.about?.subject ?? '';
  const change = async (wanted: Change): Promise<boolean> => {
    const answer = await commands.run({ case: 'editSubject', value: { subject, change: wanted } });
    if (answer !== undefined) onChanged();
    return answer !== undefined;
  };
  return { commands, change };
};

/** A button for each rig on which a planned session can run: the operator chooses, as only they know where the subject is. */
const StartPlanned = ({ link, protocol, onStart }: { link: Link; protocol: string; onStart: (wish: Wish) => void }): JSX.Element => {
  const rigs = rigsFor(link, protocol);
  if (rigs.length === 0) return <span class="why-not">{words.start.noRig}</span>;
  return (
    <>
      {rigs.map((rig) => (
        <Button
          key={rig.name}
          label={rigs.length === 1 ? words.plan.start : words.start.on(rig.name)}
          testId="start-planned"
          onClick={() => onStart({ rig: rig.name, protocol })}
          whyNot={whyNotStart(link, rig)}
        />
      ))}
    </>
  );
};

const Plan = (props: CareProps & { onStart: (wish: Wish) => void }): JSX.Element => {
  const { link, record } = props;
  const { commands, change } = useChange(props);
  const protocol = useSignal('');
  const date = useSignal('');
  const { heads } = words.plan;
  const whyNot = whyNotOperate(link);
  const wrong = useSignal<{ readonly protocol?: string; readonly date?: string }>({});
  const dateInput = useRef<HTMLInputElement>(null);
  const add = async (event: Event): Promise<void> => {
    event.preventDefault();
    if (commands.isBusy.value) return;
    // A date without its year has no value, and would be any day.
    if (dateInput.current?.validity.badInput === true) return void (wrong.value = { date: words.plan.dateWrong });
    if (protocol.value === '') return void (wrong.value = { protocol: words.plan.protocolMissing });
    wrong.value = {};
    if (await change({ case: 'addPlan', value: { protocol: protocol.value, dueDate: date.value } })) protocol.value = date.value = '';
  };
  return (
    <section class="column" data-testid="plan">
      <h2>{words.plan.title}</h2>
      {record.plan.length === 0 ? (
        <p>{words.plan.none}</p>
      ) : (
        <table class="sessions-table stack" data-testid="plan-table">
          <thead>
            <tr>
              <th>{heads.protocol}</th>
              <th>{heads.due}</th>
              <th>{heads.state}</th>
              <th />
            </tr>
          </thead>
          <tbody>
            {record.plan.map((planned) => (
              <tr key={planned.number} data-testid="planned" data-state={planned.sessionId === '' ? 'due' : 'done'}>
                <th scope="row">{protocolName(planned.protocol)}</th>
                <td data-label={heads.due}>{planned.dueDate === '' ? words.plan.anyDay : day(BigInt(Date.parse(`${planned.dueDate}T12:00:00`)) * 1_000_000n)}</td>
                <td data-label={heads.state}>
                  {planned.sessionId === '' ? (
                    words.plan.due
                  ) : (
                    <a class="sessions-link" href={`#/sessions/${encodeURIComponent(planned.sessionId)}`}>
                      {words.plan.done}
                    </a>
                  )}
                </td>
                <td>
                  <div class="row">
                    {planned.sessionId === '' && <StartPlanned link={link} protocol={planned.protocol} onStart={props.onStart} />}
                    <RemoveButton
                      label={protocolName(planned.protocol)}
                      testId="remove-planned"
                      onRemove={() => void change({ case: 'removePlan', value: planned.number })}
                      whyNot={whyNot}
                    />
                  </div>
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      <form class="row" noValidate onSubmit={(event) => void add(event)}>
        <Field label={words.plan.protocol} error={wrong.value.protocol}>
          {(links) => (
            <select
              {...links}
              data-testid="plan-protocol"
              value={protocol.value}
              onChange={(event) => {
                protocol.value = event.currentTarget.value;
                wrong.value = {};
              }}
            >
              <option value="">{strings.common.start.chooseProtocol}</option>
              {protocols.value.map(({ name }) => (
                <option key={name} value={name}>
                  {protocolName(name)}
                </option>
              ))}
            </select>
          )}
        </Field>
        <Field label={words.plan.date} error={wrong.value.date}>
          {(links) => (
            <input
              {...links}
              ref={dateInput}
              type="date"
              data-testid="plan-date"
              value={date.value}
              onInput={(event) => {
                date.value = event.currentTarget.value;
                wrong.value = {};
              }}
            />
          )}
        </Field>
        <button type="submit" class="button" data-testid="plan-add" aria-disabled={commands.isBusy.value}>
          {words.plan.add}
        </button>
      </form>
      <CommandNotice commands={commands} testId="plan-error" />
    </section>
  );
};

const Notes = (props: CareProps): JSX.Element => {
  const { link, record } = props;
  const { commands, change } = useChange(props);
  const text = useSignal('');
  const wrong = useSignal('');
  const add = async (event: Event): Promise<void> => {
    event.preventDefault();
    const note = text.value.trim();
    if (commands.isBusy.value) return;
    if (note === '') return void (wrong.value = words.notes.textMissing);
    if (!note.split(/(?<=[.!?]) /).every(isLabel)) return void (wrong.value = labelRule.value.hint || words.notes.hint);
    if (await change({ case: 'addNote', value: note })) text.value = '';
  };
  return (
    <section class="column" data-testid="notes">
      <h2>{words.notes.title}</h2>
      {record.notes.length === 0 ? (
        <p>{words.notes.none}</p>
      ) : (
        <ul>
          {record.notes.map((note) => (
            <li key={note.number} class="row" data-testid="note">
              <span>{note.text}</span>
              <span class="sessions-note">{words.notes.by(note.who, dateTime(note.utcNs))}</span>
              <RemoveButton
                label={words.notes.ofTime(dateTime(note.utcNs))}
                testId="remove-note"
                onRemove={() => void change({ case: 'removeNote', value: note.number })}
                whyNot={whyNotOperate(link)}
              />
            </li>
          ))}
        </ul>
      )}
      <form class="row" noValidate onSubmit={(event) => void add(event)}>
        <Field label={words.notes.text} hint={words.notes.hint} error={wrong.value}>
          {(links) => (
            <input
              {...links}
              data-testid="note-text"
              maxLength={1000}
              autocomplete="off"
              value={text.value}
              onInput={(event) => {
                text.value = event.currentTarget.value;
                wrong.value = '';
              }}
            />
          )}
        </Field>
        <button type="submit" class="button" data-testid="note-add" aria-disabled={commands.isBusy.value}>
          {words.notes.add}
        </button>
      </form>
      <CommandNotice commands={commands} testId="note-error" />
    </section>
  );
};

export const Care = (props: CareProps): JSX.Element => {
  const { link, record } = props;
  const wish = useSignal<Wish | undefined>(undefined);
  const rigs = rigsOf(link);
  return (
    <>
      <div class="row">
        {rigs.map((rig) => (
          <Button
            key={rig.name}
            label={words.start.on(rig.name)}
            kind="main"
            testId={`start-on-${rig.name}`}
            onClick={() => (wish.value = { rig: rig.name, protocol: '' })}
            whyNot={whyNotStart(link, rig)}
          />
        ))}
        {rigs.length === 0 && <span class="why-not">{words.start.noRig}</span>}
      </div>
      {wish.value !== undefined && (
        <StartPanel
          key={`${wish.value.rig} ${wish.value.protocol}`}
          link={link}
          subject={record.about?.subject ?? ''}
          wish={wish.value}
          onClosed={() => (wish.value = undefined)}
        />
      )}
      <Plan {...props} onStart={(wanted) => (wish.value = wanted)} />
      <Notes {...props} />
    </>
  );
};
