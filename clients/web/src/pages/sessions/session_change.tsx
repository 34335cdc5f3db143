// SPDX-License-Identifier: Apache-2.0
// Correct, delete and restore a closed session.
import { useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';
import { useLayoutEffect, useRef } from 'preact/hooks';

import type { Correction, SessionRecord, TrialRecord } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { Button, CommandNotice, Field, Notice, Panel, useCommands, whyNotOperate } from '../../parts/controls';
import { useReturnFocus } from '../../parts/focus';
import { useKeys } from '../../parts/keys';
import { conditionName, labelRule } from '../../parts/names';
import { dateTime, whole } from '../../parts/numbers';
import { outcomeOf } from '../../parts/outcomes';
import { strings } from '../../strings';
import type { Typed } from './corrections';
import { isInOtherPart, markerNumber, markerOf, shownValue, trialKey, useCorrectionForm } from './corrections';

const words = strings.sessions.change;
const outcomes = ['done', 'rejected', 'redone', 'aborted'] as const;
const longestLine = 200; // bytes of label and reason; the daemon counts
const longestNotes = 1000;

/** A form that opens focused and closes with Esc. */
const OpenForm = (props: { title: string; hint: string; testId: string; submit: string; onSubmit: () => void; onClose: () => void; children: ComponentChildren }): JSX.Element => {
  const form = useRef<HTMLFormElement>(null);
  useReturnFocus();
  useLayoutEffect(() => form.current?.querySelector<HTMLElement>('input, select, textarea')?.focus(), []);
  useKeys({ Escape: props.onClose });
  return (
    <Panel title={props.title} testId={props.testId} onClose={props.onClose}>
      <form
        ref={form}
        class="column change-form"
        noValidate
        onSubmit={(event) => {
          event.preventDefault();
          props.onSubmit();
        }}
      >
        <p>{props.hint}</p>
        {props.children}
        <div class="row">
          <button type="submit" class="button button-main" data-testid={`${props.testId}-submit`}>
            {props.submit}
          </button>
        </div>
      </form>
    </Panel>
  );
};

interface LineProps {
  label: string;
  hint?: string;
  error?: string;
  value: string;
  testId: string;
  onInput: (value: string) => void;
}

const Line = ({ label, hint = '', error, value, testId, onInput }: LineProps): JSX.Element => (
  <Field label={label} hint={hint} error={error}>
    {(links) => (
      <input {...links} maxLength={longestLine} autocomplete="off" data-testid={testId} value={value} onInput={(event) => onInput(event.currentTarget.value)} />
    )}
  </Field>
);

const trialName = (session: SessionRecord, trial: TrialRecord): string =>
  words.trialName(
    whole(trial.trial),
    whole(trial.attempt),
    isInOtherPart(session, trial) ? whole(trial.part) : '',
    conditionName(session.protocol, trial.condition),
    strings.common.outcomes[outcomeOf(trial)],
  );

interface ChangeProps {
  link: Link;
  session: SessionRecord;
  onChanged: () => void;
  onClose: () => void;
}

const Correct = ({ link, session, onChanged, onClose }: ChangeProps): JSX.Element => {
  const commands = useCommands(link);
  const { opened, typed, request } = useCorrectionForm(session);
  const wrong = useSignal<{ readonly reason?: string; readonly all?: string }>({});
  const set = (change: Partial<Typed>): void => {
    typed.value = { ...typed.value, ...change };
    wrong.value = {};
  };
  const { subject, label, notes, trial, outcome, marker, markerText, reason } = typed.value;
  const save = async (): Promise<void> => {
    const value = request();
    if (trial !== '' && outcome === '') wrong.value = { all: words.outcomeMissing };
    else if (value === undefined) wrong.value = { all: words.nothing };
    else if (reason.trim() === '') wrong.value = { reason: words.reasonMissing };
    else if ((await commands.run({ case: 'correctSession', value })) !== undefined) onChanged();
  };
  return (
    <OpenForm title={words.correctTitle} hint={words.correctHint} testId="correct" submit={words.save} onSubmit={() => void save()} onClose={onClose}>
      <Line label={words.subject} hint={strings.common.start.subjectHint} value={subject} testId="correct-subject" onInput={(value) => set({ subject: value })} />
      <Line
        label={words.label}
        hint={labelRule.value.hint || strings.common.start.labelHint}
        value={label}
        testId="correct-label"
        onInput={(value) => set({ label: value })}
      />
      <Field label={words.notes} hint={words.notesHint}>
        {(links) => (
          <textarea
            {...links}
            rows={3}
            maxLength={longestNotes}
            data-testid="correct-notes"
            value={notes}
            onInput={(event) => set({ notes: event.currentTarget.value })}
          />
        )}
      </Field>
      {opened.trials.length > 0 && (
        <Field label={words.trial}>
          {(links) => (
            <select {...links} data-testid="correct-trial" value={trial} onChange={(event) => set({ trial: event.currentTarget.value })}>
              <option value="">{words.noTrial}</option>
              {opened.trials.map((one) => (
                <option key={trialKey(one)} value={trialKey(one)}>
                  {trialName(opened, one)}
                </option>
              ))}
            </select>
          )}
        </Field>
      )}
      {trial !== '' && (
        <Field label={words.outcome}>
          {(links) => (
            <select {...links} data-testid="correct-outcome" value={outcome} onChange={(event) => set({ outcome: event.currentTarget.value })}>
              <option value="">{strings.common.start.choose}</option>
              {outcomes.map((one) => (
                <option key={one} value={one}>
                  {strings.common.outcomes[one]}
                </option>
              ))}
            </select>
          )}
        </Field>
      )}
      {opened.markers.length > 0 && (
        <Field label={words.marker}>
          {(links) => (
            <select
              {...links}
              data-testid="correct-marker"
              value={marker}
              onChange={(event) => set({ marker: event.currentTarget.value, markerText: markerOf(opened, event.currentTarget.value)?.text ?? '' })}
            >
              <option value="">{words.noMarker}</option>
              {opened.markers.map((one) => (
                <option key={one.number} value={String(one.number)}>
                  {words.markerName(whole(one.number), one.text || words.removedText)}
                </option>
              ))}
            </select>
          )}
        </Field>
      )}
      {marker !== '' && (
        <Line
          label={words.markerText}
          hint={words.markerHint}
          value={markerText}
          testId="correct-marker-text"
          onInput={(value) => set({ markerText: value })}
        />
      )}
      <Line
        label={words.reason}
        hint={words.reasonHint}
        error={wrong.value.reason ?? ''}
        value={reason}
        testId="correct-reason"
        onInput={(value) => set({ reason: value })}
      />
      {wrong.value.all !== undefined && <Notice kind="warning" what={wrong.value.all} testId="correct-nothing" />}
      <CommandNotice commands={commands} testId="correct-error" />
    </OpenForm>
  );
};

const Delete = ({ link, session, onChanged, onClose }: ChangeProps): JSX.Element => {
  const commands = useCommands(link);
  const reason = useSignal('');
  const wrong = useSignal('');
  const remove = async (): Promise<void> => {
    if (reason.value.trim() === '') wrong.value = words.reasonMissing;
    else if ((await commands.run({ case: 'deleteSession', value: { sessionId: session.sessionId, reason: reason.value.trim() } })) !== undefined) onChanged();
  };
  return (
    <OpenForm title={words.deleteTitle} hint={words.deleteHint} testId="delete" submit={words.deleteIt} onSubmit={() => void remove()} onClose={onClose}>
      <Line
        label={words.reason}
        hint={words.reasonHint}
        error={wrong.value}
        value={reason.value}
        testId="delete-reason"
        onInput={(value) => {
          reason.value = value;
          wrong.value = '';
        }}
      />
      <CommandNotice commands={commands} testId="delete-error" />
    </OpenForm>
  );
};

/** A deleted session says so and can be restored. */
const Deleted = ({ link, session, onChanged }: Omit<ChangeProps, 'onClose'>): JSX.Element => {
  const commands = useCommands(link);
  const restore = async (): Promise<void> => {
    const request = { sessionId: session.sessionId, isRestore: true };
    if ((await commands.run({ case: 'deleteSession', value: request })) !== undefined) onChanged();
  };
  return (
    <>
      <Notice kind="warning" what={words.isDeleted} hint={words.isDeletedHint} testId="is-deleted" />
      <div class="row">
        <Button label={words.restore} kind="main" testId="restore" onClick={() => void restore()} whyNot={whyNotOperate(link)} />
      </div>
      <CommandNotice commands={commands} testId="restore-error" />
    </>
  );
};

/** The buttons Correct and Delete, and the form that one of them opened. `onChanged` loads the session again. */
export const SessionChange = ({ link, session, onChanged }: Omit<ChangeProps, 'onClose'>): JSX.Element => {
  const open = useSignal<'' | 'correct' | 'delete'>('');
  const isSaved = useSignal(false);
  const whyNot = whyNotOperate(link) || (session.state === 'running' ? words.needsClosed : '');
  if (session.isDeleted) return <Deleted link={link} session={session} onChanged={onChanged} />;
  const close = (): void => void (open.value = '');
  const changed = (): void => {
    close();
    isSaved.value = true;
    onChanged();
  };
  const show = (form: 'correct' | 'delete') => (): void => {
    isSaved.value = false;
    open.value = form;
  };
  const props = { link, session, onChanged: changed, onClose: close };
  return (
    <>
      <div class="row">
        <Button label={words.correct} testId="open-correct" onClick={show('correct')} whyNot={whyNot} />
        <Button label={words.delete} kind="danger" testId="open-delete" onClick={show('delete')} whyNot={whyNot} />
      </div>
      {open.value === 'correct' && <Correct {...props} />}
      {open.value === 'delete' && <Delete {...props} />}
      {isSaved.value && <Notice kind="good" what={words.saved} testId="correct-saved" onDismiss={() => (isSaved.value = false)} />}
    </>
  );
};

/** All corrections, the newest first. */
export const CorrectionTable = ({ session }: { session: SessionRecord }): JSX.Element => {
  const { heads, fields, ofTrial, ofMarker } = words;
  const what = (one: Correction): string => {
    if (one.field === 'outcome') return ofTrial(whole(one.trial), whole(one.attempt));
    return one.field === 'marker' ? ofMarker(whole(markerNumber(session, one))) : (fields[one.field] ?? one.field);
  };
  return (
    <table class="stack" data-testid="correction-table">
      <thead>
        <tr>
          {Object.values(heads).map((head) => (
            <th key={head}>{head}</th>
          ))}
        </tr>
      </thead>
      <tbody>
        {[...session.corrections].reverse().map((one) => (
          <tr key={one.number}>
            <td data-label={heads.when}>{dateTime(one.utcNs)}</td>
            <td data-label={heads.who}>{one.who}</td>
            <td data-label={heads.what}>{what(one)}</td>
            <td data-label={heads.before}>{shownValue(one, one.oldValue) || strings.common.undefinedValue}</td>
            <td data-label={heads.after}>{shownValue(one, one.newValue) || strings.common.undefinedValue}</td>
            <td data-label={heads.reason}>{one.reason}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
};
