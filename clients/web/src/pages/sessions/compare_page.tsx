// SPDX-License-Identifier: Apache-2.0
// Sessions side by side: every result with its change, and two reports.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { Field, Notice, Panel } from '../../parts/controls';
import { capitalised, protocolName, sessionTitle, spoken } from '../../parts/names';
import { dateTime, percent, signed, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { useAsked } from './asking';
import type { Caution, ComparedResult, Comparison } from './comparison';
import { comparable, compare, difference, mostCompared, shareOfChange } from './comparison';
import { Report } from './report';
import { resultName, resultValue, unitText } from './result_names';
import { askSession } from './session_detail';
import { mostListed } from './session_list';
import { ResultName } from './session_tables';

/** The sessions to compare: two by their IDs, or all comparable ones of a subject. */
export type Compared = { readonly ids: readonly string[] } | { readonly subject: string };

interface Found {
  readonly sessions: readonly SessionRecord[];
  /** How many other sessions the subject has. */
  readonly leftOut: number;
}

const askSessions = async (link: Link, compared: Compared, signal: AbortSignal): Promise<Found> => {
  if ('ids' in compared) return { sessions: await Promise.all(compared.ids.map((id) => askSession(link, id))), leftOut: 0 };
  const answer = await link.send({ case: 'listSessions', value: { subject: compared.subject, limit: mostListed } });
  const listed = answer.case === 'sessions' ? answer.value.sessions : [];
  const sessions = await comparable(listed, (id) => askSession(link, id), signal);
  return { sessions, leftOut: listed.length - sessions.length };
};

const cautionText = (caution: Caution): string => {
  const { cautions, analyses } = strings.sessions.compare;
  switch (caution.kind) {
    case 'subjects':
      return cautions.subjects;
    case 'rigs':
      return cautions.rigs;
    case 'protocols':
      return cautions.protocols(caution.protocols.map(protocolName).join(', '));
    case 'lost':
      return cautions.lost(caution.when, caution.losses);
    case 'resumed':
      return cautions.resumed(caution.when);
    case 'arms':
      return cautions.arms;
    case 'unit':
      return cautions.unit(resultName(caution.result));
    case 'uneven':
      return cautions.uneven(capitalised(spoken(caution.condition)));
    case 'analysis':
      return cautions.analysis(capitalised(spoken(caution.condition)), analyses[caution.of] ?? caution.of, caution.one, caution.other);
  }
};

interface Pair {
  readonly one: number;
  readonly other: number;
}

const ResultRow = ({ result, pair, columns }: { result: ComparedResult; pair: Pair; columns: readonly string[] }): JSX.Element => {
  const { heads } = strings.sessions.compare;
  const change = difference(result.values[pair.one], result.values[pair.other]);
  const share = shareOfChange(result, pair.one, pair.other);
  return (
    <tr data-testid="comparison-row" data-result={result.name}>
      <th scope="row">
        <ResultName name={result.name} />
      </th>
      {result.values.map((value, index) => (
        <td key={index} data-label={columns[index]} class="number">
          {resultValue({ name: result.name, value })}
        </td>
      ))}
      <td data-label={heads.unit} class="unit-cell">{unitText(result.unit)}</td>
      <td data-label={heads.change} class="number">
        {signed(change, 3)}
      </td>
      <td data-label={heads.share} class="number">
        {share === undefined ? '' : `${share > 0 ? '+' : ''}${percent(share)} %`}
      </td>
    </tr>
  );
};

const ResultTable = ({ comparison, pair }: { comparison: Comparison; pair: Pair }): JSX.Element => {
  const { heads, one, other, table } = strings.sessions.compare;
  const columns = comparison.sessions.map(({ startedUtcNs }, index) => {
    const name = index === pair.one ? `${one}: ` : index === pair.other ? `${other}: ` : '';
    return `${name}${dateTime(startedUtcNs)}`;
  });
  return (
    <div class="sessions-wide" tabIndex={0} role="region" aria-label={table}>
      <table class="stack" data-testid="comparison-table">
        <thead>
          <tr>
            <th>{heads.result}</th>
            {comparison.sessions.map((session, index) => (
              <th key={session.sessionId} class="number">
                {columns[index]}
              </th>
            ))}
            <th>{heads.unit}</th>
            <th class="number">{heads.change}</th>
            <th class="number">{heads.share}</th>
          </tr>
        </thead>
        <tbody>
          {comparison.results.map((result) => (
            <ResultRow key={result.name} result={result} pair={pair} columns={columns} />
          ))}
        </tbody>
      </table>
    </div>
  );
};

const SessionChoice = (props: { label: string; sessions: readonly SessionRecord[]; index: number; testId: string; onChange: (index: number) => void }): JSX.Element => (
  <Field label={props.label}>
    {(links) => (
      <select {...links} value={String(props.index)} data-testid={props.testId} onChange={(event) => props.onChange(Number(event.currentTarget.value))}>
        {props.sessions.map((session, index) => (
          <option key={session.sessionId} value={String(index)}>
            {`${dateTime(session.startedUtcNs)}, ${protocolName(session.protocol)}`}
          </option>
        ))}
      </select>
    )}
  </Field>
);

const SideBySide = ({ sessions }: { sessions: readonly SessionRecord[] }): JSX.Element => (
  <div class="sessions-pair">
    {sessions.map((session, index) => (
      <Panel key={session.sessionId} title={sessionTitle(session)} testId={`compared-${index + 1}`}>
        <p>
          <a class="sessions-link" href={`#/sessions/${encodeURIComponent(session.sessionId)}`}>
            {strings.sessions.openSession}
          </a>
          <span class="sessions-note">
            {strings.sessions.id} {session.sessionId}
          </span>
        </p>
        <Report sessionId={session.sessionId} testId={`report-${index + 1}`} />
      </Panel>
    ))}
  </div>
);

const Compare = ({ comparison }: { comparison: Comparison }): JSX.Element => {
  const { sessions } = comparison;
  const words = strings.sessions.compare;
  const one = useSignal(0);
  const other = useSignal(sessions.length - 1);
  const pair = { one: one.value, other: other.value };
  const shown = [sessions[pair.one], sessions[pair.other]].filter((session) => session !== undefined);
  return (
    <>
      <div class="row">
        <SessionChoice label={words.oneLabel} sessions={sessions} index={pair.one} testId="compare-one" onChange={(index) => (one.value = index)} />
        <SessionChoice label={words.otherLabel} sessions={sessions} index={pair.other} testId="compare-other" onChange={(index) => (other.value = index)} />
      </div>
      {comparison.cautions.map((caution) => (
        <Notice key={JSON.stringify(caution)} kind="warning" what={cautionText(caution)} testId="compare-caution" />
      ))}
      {comparison.results.length === 0 ? <p>{words.noResults}</p> : <ResultTable comparison={comparison} pair={pair} />}
      <SideBySide sessions={shown} />
    </>
  );
};

export const ComparePage = ({ link, compared }: { link: Link; compared: Compared }): JSX.Element => {
  const words = strings.sessions.compare;
  const key = link.state.value === 'up' ? JSON.stringify(compared) : '';
  const asked = useAsked(key, (signal) => askSessions(link, compared, signal)).value;
  const { answer, error } = asked;
  return (
    <div class="column">
      <p>
        <a class="sessions-link" href="#/sessions">
          {strings.sessions.back}
        </a>
      </p>
      <h1>{'subject' in compared ? words.titleOf(compared.subject) : words.title}</h1>
      {error !== undefined && <Notice kind="error" what={error.message} hint={error.hint} testId="compare-error" />}
      {answer !== undefined && answer.leftOut > 0 && (
        <Notice kind="plain" what={words.leftOut(whole(answer.leftOut), whole(mostCompared))} testId="compare-left-out" />
      )}
      {answer !== undefined && answer.sessions.length < 2 && (
        <p class="empty" data-testid="nothing-to-compare">
          {words.tooFew}
        </p>
      )}
      {answer !== undefined && answer.sessions.length >= 2 && (
        <Compare key={answer.sessions.map((one) => one.sessionId).join()} comparison={compare(answer.sessions)} />
      )}
    </div>
  );
};
