// SPDX-License-Identifier: Apache-2.0
// Everything about one subject: start of a session, plan, notes, trend, plain words, sessions, erasure.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useLayoutEffect, useRef } from 'preact/hooks';

import { Role } from '../../generated/dts/v1/options_pb';
import type { EraseSubjectResponse, SessionRecord, SubjectRecord } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { Button, CommandNotice, Field, Notice, Panel, useCommands, whyNotOperate } from '../../parts/controls';
import { useReturnFocus } from '../../parts/focus';
import { useKeys } from '../../parts/keys';
import { asSentence } from '../../parts/names';
import { bytes, dateTime, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { useAsked } from '../sessions/asking';
import { SessionTable } from '../sessions/session_list';
import { Care } from './care';
import { useSubject } from './subject_record';
import { askTrend } from './trend_data';
import { PlainWords, TrendView } from './trend_view';

const words = strings.sessions.subject;

interface EraseProps {
  link: Link;
  subject: string;
  record: SubjectRecord;
  onErased: (erased: EraseSubjectResponse) => void;
  onClose: () => void;
}

/** The ID must be typed: nobody erases a person with one wrong click. */
const Erase = ({ link, subject, record, onErased, onClose }: EraseProps): JSX.Element => {
  const commands = useCommands(link);
  const typed = useSignal('');
  const wrong = useSignal('');
  const input = useRef<HTMLInputElement>(null);
  useReturnFocus();
  useLayoutEffect(() => input.current?.focus(), []);
  useKeys({ Escape: onClose });
  const erase = async (event: Event): Promise<void> => {
    event.preventDefault();
    if (typed.value !== subject) {
      wrong.value = words.confirmWrong(subject);
      return input.current?.focus();
    }
    const answer = await commands.run({ case: 'eraseSubject', value: { subject } });
    if (answer?.case === 'erased') onErased(answer.value);
  };
  return (
    <Panel title={words.eraseTitle} testId="erase" onClose={onClose}>
      <form class="column change-form" noValidate onSubmit={(event) => void erase(event)}>
        <p>{words.eraseHint(whole(record.about?.sessions ?? 0), bytes(record.about?.bytes))}</p>
        <Field label={words.confirm(subject)} error={wrong.value}>
          {(links) => (
            <input
              {...links}
              ref={input}
              autocomplete="off"
              data-testid="erase-confirm"
              value={typed.value}
              onInput={(event) => {
                typed.value = event.currentTarget.value;
                wrong.value = '';
              }}
            />
          )}
        </Field>
        <CommandNotice commands={commands} testId="erase-error" />
        <div class="row">
          <button type="submit" class="button button-danger" data-testid="erase-submit" aria-disabled={commands.isBusy.value}>
            {commands.isBusy.value ? strings.common.busy : words.eraseIt}
          </button>
        </div>
      </form>
    </Panel>
  );
};

const Facts = ({ record: { about } }: { record: SubjectRecord }): JSX.Element => (
  <dl class="facts" data-testid="subject-facts">
    <dt>{words.facts.sessions}</dt>
    <dd>{whole(about?.sessions ?? 0)}</dd>
    <dt>{words.facts.deleted}</dt>
    <dd>{whole(about?.deletedSessions ?? 0)}</dd>
    <dt>{words.facts.first}</dt>
    <dd>{dateTime(about?.firstUtcNs ?? 0n)}</dd>
    <dt>{words.facts.last}</dt>
    <dd>{dateTime(about?.lastUtcNs ?? 0n)}</dd>
    <dt>{words.facts.size}</dt>
    <dd>{bytes(about?.bytes ?? 0n)}</dd>
  </dl>
);

/** What was erased, and what a person still has to do. */
const Erased = ({ subject, erased }: { subject: string; erased: EraseSubjectResponse }): JSX.Element => (
  <>
    <Notice kind="good" what={words.erased(subject, whole(erased.sessions), whole(erased.files))} hint={asSentence(erased.backups)} testId="erased" />
    {erased.left.length > 0 && <Notice kind="error" what={words.left} hint={erased.left.map(asSentence).join(' ')} testId="erase-left" />}
  </>
);

/** Changes with everything that changes results: a new session, its end, a correction. */
const resultsKey = (sessions: readonly SessionRecord[]): string =>
  sessions.map(({ sessionId, state, corrections }) => `${sessionId} ${state} ${corrections.length}`).join();

/** Results over the visits. */
const Results = ({ link, subject, record }: { link: Link; subject: string; record: SubjectRecord }): JSX.Element => {
  const key = link.state.value === 'up' ? `trend ${subject} ${resultsKey(record.sessions)}` : '';
  const { answer, error, isBusy } = useAsked(key, (signal) => askTrend(link, subject, signal)).value;
  return (
    <>
      {error !== undefined && <Notice kind="error" what={error.message} hint={error.hint} testId="trend-error" />}
      {isBusy && answer === undefined && <p role="status">{strings.subjects.trend.asking}</p>}
      {answer !== undefined && (
        <>
          <h2>{strings.subjects.words.title}</h2>
          <PlainWords trend={answer} sessions={record.sessions} />
          <h2>{strings.subjects.trend.title}</h2>
          <TrendView trend={answer} />
        </>
      )}
    </>
  );
};

export const SubjectPage = ({ link, subject }: { link: Link; subject: string }): JSX.Element => {
  const isErasing = useSignal(false);
  const erased = useSignal<EraseSubjectResponse | undefined>(undefined);
  const { answer, error, reload } = useSubject(link, subject, erased.value !== undefined);
  const isEmpty = erased.value === undefined && answer !== undefined && answer.sessions.length + answer.notes.length + answer.plan.length === 0;
  const whyNot = whyNotOperate(link) || (link.me.value.role < Role.ENGINEER ? words.needsEngineer : '');
  return (
    <div class="column">
      <p>
        <a class="sessions-link" href="#/subjects">
          {words.back}
        </a>
      </p>
      <h1>{words.title(subject)}</h1>
      {erased.value !== undefined && <Erased subject={subject} erased={erased.value} />}
      {erased.value === undefined && error !== undefined && <Notice kind="error" what={error.message} hint={error.hint} testId="subject-error" />}
      {isEmpty && (
        <p class="empty" data-testid="no-subject">
          {words.none(subject)}
        </p>
      )}
      {erased.value === undefined && answer !== undefined && !isEmpty && (
        <>
          <Facts record={answer} />
          <div class="row">
            <a class="button" href={`#/compare/subject/${encodeURIComponent(subject)}`} data-testid="compare-subject">
              {words.compare}
            </a>
            <Button label={words.erase} kind="danger" testId="open-erase" onClick={() => (isErasing.value = true)} whyNot={whyNot} />
          </div>
          {isErasing.value && (
            <Erase
              link={link}
              subject={subject}
              record={answer}
              onErased={(result) => (erased.value = result)}
              onClose={() => (isErasing.value = false)}
            />
          )}
          <Care link={link} record={answer} onChanged={reload} />
          <Results link={link} subject={subject} record={answer} />
          {answer.mentioningSessions.length > 0 && <p data-testid="mentions">{words.mentions(whole(answer.mentioningSessions.length))}</p>}
          <SessionTable sessions={answer.sessions} />
        </>
      )}
    </div>
  );
};
