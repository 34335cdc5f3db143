// SPDX-License-Identifier: Apache-2.0
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import { Role } from '../../generated/dts/v1/options_pb';
import type { ListSubjectsResponse, SubjectInfo } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { Field, Notice } from '../../parts/controls';
import { dateTime, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { useAsked } from '../sessions/asking';

const words = strings.subjects;
const mostListed = 200;

/** Returns the subjects whose ID contains the text, most recent visit first. */
export const found = (all: readonly SubjectInfo[], text: string): readonly SubjectInfo[] =>
  all
    .filter(({ subject }) => subject.toLowerCase().includes(text.trim().toLowerCase()))
    .sort((one, other) => (one.lastUtcNs < other.lastUtcNs ? 1 : one.lastUtcNs > other.lastUtcNs ? -1 : one.subject.localeCompare(other.subject)));

const askList = async (link: Link): Promise<ListSubjectsResponse> => {
  const answer = await link.send({ case: 'listSubjects', value: {} });
  if (answer.case !== 'subjects') throw new Error(strings.sessions.unexpected);
  return answer.value;
};

export const SubjectList = ({ link }: { link: Link }): JSX.Element => {
  const text = useSignal('');
  const mayLook = link.me.value.role >= Role.OPERATOR;
  const { answer, error, isBusy } = useAsked(link.state.value === 'up' && mayLook ? 'subjects' : '', () => askList(link)).value;
  const listed = found(answer?.subjects ?? [], text.value);
  const shown = listed.slice(0, mostListed);
  const unlisted = listed.length - shown.length + (answer?.moreSubjects ?? 0);
  const { heads } = words;
  return (
    <div class="column">
      <h1>{words.title}</h1>
      {!mayLook && <Notice kind="plain" what={words.needsOperator} testId="subjects-role" />}
      {error !== undefined && <Notice kind="error" what={error.message} hint={error.hint} testId="subjects-error" />}
      {isBusy && answer === undefined && <p role="status">{words.asking}</p>}
      {answer?.subjects.length === 0 && (
        <p class="empty" data-testid="no-subjects">
          {words.none}
        </p>
      )}
      {answer !== undefined && answer.subjects.length > 0 && (
        <>
          <div class="row" role="search">
            <Field label={words.search}>
              {(links) => (
                <input {...links} type="search" autocomplete="off" data-testid="subject-search" value={text.value} onInput={(event) => (text.value = event.currentTarget.value)} />
              )}
            </Field>
          </div>
          <table class="sessions-table stack" data-testid="subject-table" aria-label={words.list}>
            <thead>
              <tr>
                <th>{heads.subject}</th>
                <th>{heads.last}</th>
                <th class="number">{heads.visits}</th>
                <th>{heads.rigs}</th>
              </tr>
            </thead>
            <tbody>
              {shown.map(({ subject, sessions, deletedSessions, lastUtcNs, rigs }) => (
                <tr key={subject} data-testid="subject-row">
                  <th scope="row">
                    <a class="sessions-link" href={`#/subjects/${encodeURIComponent(subject)}`}>
                      {subject}
                    </a>
                  </th>
                  <td data-label={heads.last}>{lastUtcNs === 0n ? '' : dateTime(lastUtcNs)}</td>
                  <td data-label={heads.visits} class="number">
                    {whole(sessions - deletedSessions)}
                  </td>
                  <td data-label={heads.rigs}>{rigs.join(', ')}</td>
                </tr>
              ))}
            </tbody>
          </table>
          {unlisted > 0 && <p>{words.more(whole(unlisted))}</p>}
        </>
      )}
    </div>
  );
};
