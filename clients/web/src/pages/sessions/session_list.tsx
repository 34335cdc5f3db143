// SPDX-License-Identifier: Apache-2.0
// All sessions, newest first, with filters. Two sessions, or all of a subject, can be compared.
import { useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';

import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { Field, Notice } from '../../parts/controls';
import { protocolName, sessionTitle } from '../../parts/names';
import { dateTime, duration, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { sessionsKey, useAsked } from './asking';
import type { Filters } from './filters';
import { durationS, noFilters, passes, rigsOf } from './filters';
import { LostScans, StateMark } from './state_mark';

export const mostListed = 500;

const askList = async (link: Link, deleted: boolean): Promise<readonly SessionRecord[]> => {
  const answer = await link.send({ case: 'listSessions', value: { limit: mostListed, deleted } });
  return answer.case === 'sessions' ? answer.value.sessions : [];
};

const Choice = (props: { label: string; value: string; values: readonly string[]; word: (value: string) => string; testId: string; onChange: (value: string) => void }): JSX.Element => (
  <Field label={props.label}>
    {(links) => (
      <select {...links} value={props.value} data-testid={props.testId} onChange={(event) => props.onChange(event.currentTarget.value)}>
        <option value="">{strings.sessions.filters.all}</option>
        {props.values.map((value) => (
          <option key={value} value={value}>
            {props.word(value)}
          </option>
        ))}
      </select>
    )}
  </Field>
);

interface FilterBarProps {
  filters: Filters;
  protocols: readonly string[];
  onChange: (filters: Filters) => void;
  children: ComponentChildren;
}

const FilterBar = (props: FilterBarProps): JSX.Element => {
  const { filters, onChange } = props;
  const { filters: words, states } = strings.sessions;
  const set = (change: Partial<Filters>): void => onChange({ ...filters, ...change });
  const input = (name: 'subject' | 'from' | 'to', type: string): JSX.Element => (
    <Field label={words[name]}>
      {(links) => <input {...links} type={type} value={filters[name]} data-testid={`filter-${name}`} onInput={(event) => set({ [name]: event.currentTarget.value })} />}
    </Field>
  );
  return (
    <div class="row" role="search">
      {input('subject', 'search')}
      <Choice label={words.protocol} value={filters.protocol} values={props.protocols} word={protocolName} testId="filter-protocol" onChange={(protocol) => set({ protocol })} />
      <Choice label={words.state} value={filters.state} values={Object.keys(states)} word={(state) => states[state] ?? state} testId="filter-state" onChange={(state) => set({ state })} />
      {input('from', 'date')}
      {input('to', 'date')}
      {props.children}
    </div>
  );
};

interface Choosing {
  readonly chosen: readonly string[];
  choose(id: string): void;
}

const Row = ({ session, choosing }: { session: SessionRecord; choosing: Choosing | undefined }): JSX.Element => {
  const { choose, underWay, heads } = strings.sessions.list;
  const { corrected, deleted } = strings.sessions.change;
  const { sessionId } = session;
  return (
    <tr data-testid="session-row" data-session={sessionId}>
      {choosing !== undefined && (
        <td data-label={heads.compare}>
          <label class="sessions-choose">
            <input
              type="checkbox"
              checked={choosing.chosen.includes(sessionId)}
              onChange={() => choosing.choose(sessionId)}
              aria-label={choose(sessionTitle(session))}
            />
          </label>
        </td>
      )}
      <td data-label={heads.session}>
        <div>
          <a class="sessions-link" href={`#/sessions/${encodeURIComponent(sessionId)}`}>
            {sessionTitle(session)}
          </a>
          <div class="sessions-note">
            {sessionId}
            {session.corrections.length > 0 && <span class="corrected"> {corrected}</span>}
          </div>
        </div>
      </td>
      <td data-label={heads.subject}>
        {session.subject === '' ? (
          strings.common.undefinedValue
        ) : (
          <a class="sessions-link" href={`#/subjects/${encodeURIComponent(session.subject)}`} title={strings.sessions.subject.page(session.subject)}>
            {session.subject}
          </a>
        )}
      </td>
      <td data-label={heads.started}>{dateTime(session.startedUtcNs)}</td>
      <td data-label={heads.rig}>{rigsOf(session)}</td>
      <td data-label={heads.duration} class="number">
        {session.state === 'running' ? underWay : duration(durationS(session))}
      </td>
      <td data-label={heads.state}>
        <div>
          <StateMark session={session} />
          {session.isDeleted && (
            <div class="corrected" data-testid="session-deleted">
              {deleted}
            </div>
          )}
          <LostScans session={session} />
        </div>
      </td>
      <td data-label={heads.label} class="sessions-label">
        {session.label}
      </td>
    </tr>
  );
};

const CompareLink = ({ chosen }: { chosen: readonly string[] }): JSX.Element => {
  const { compareTwo, chooseTwo } = strings.sessions.list;
  const [one, other] = chosen;
  return (
    <p class="sessions-compare">
      {one !== undefined && other !== undefined ? (
        <a class="button button-main" data-testid="compare-two" href={`#/compare/${encodeURIComponent(one)}/${encodeURIComponent(other)}`}>
          {compareTwo}
        </a>
      ) : (
        chooseTwo
      )}
    </p>
  );
};

export const SessionList = ({ link }: { link: Link }): JSX.Element => {
  const { list } = strings.sessions;
  const deleted = useSignal(false);
  const key = sessionsKey(link);
  const asked = useAsked(key === '' ? '' : `${key} ${deleted.value}`, () => askList(link, deleted.value)).value;
  const filters = useSignal(noFilters);
  const chosen = useSignal<readonly string[]>([]);
  const all = asked.answer ?? [];
  const shown = all.filter((session) => passes(session, filters.value));
  // The chosen protocol stays on offer, also if no listed session has it: its filter acts.
  const offered = [...new Set([...all.map(({ protocol }) => protocol), filters.value.protocol])].filter((name) => name !== '').sort();
  // Keeps the two chosen last: a third replaces the first.
  const choose = (id: string): void => {
    const others = chosen.value.filter((one) => one !== id);
    chosen.value = others.length < chosen.value.length ? others : [...others, id].slice(-2);
  };
  return (
    <div class="column">
      <h1>{strings.sessions.title}</h1>
      <FilterBar filters={filters.value} protocols={offered} onChange={(value) => (filters.value = value)}>
        <label class="sessions-deleted">
          <input type="checkbox" data-testid="filter-deleted" checked={deleted.value} onChange={(event) => (deleted.value = event.currentTarget.checked)} />
          {strings.sessions.filters.deleted}
        </label>
      </FilterBar>
      {asked.error !== undefined && <Notice kind="error" what={asked.error.message} hint={asked.error.hint} testId="list-error" />}
      <div class="sessions-count">
        <p role="status" data-testid="session-count">{asked.answer === undefined ? list.asking : list.count(whole(shown.length), whole(all.length))}</p>
        <CompareLink chosen={chosen.value.filter((id) => shown.some(({ sessionId }) => sessionId === id))} />
      </div>
      {all.length >= mostListed && <Notice kind="plain" what={list.limited(whole(mostListed))} hint={list.limitedHint} testId="list-limited" />}
      {asked.answer !== undefined && shown.length === 0 ? (
        <p class="empty" data-testid="no-sessions">
          {all.length > 0 ? list.noneOfFilter : deleted.value ? list.noneDeleted : list.none}
        </p>
      ) : (
        <SessionTable sessions={shown} choosing={{ chosen: chosen.value, choose }} />
      )}
    </div>
  );
};

/** `choosing`: two sessions can be ticked for a comparison. */
export const SessionTable = ({ sessions, choosing }: { sessions: readonly SessionRecord[]; choosing?: Choosing }): JSX.Element => {
  const { heads } = strings.sessions.list;
  return (
    <table class="sessions-table stack" data-testid="session-table">
      <thead>
        <tr>
          {choosing !== undefined && <th>{heads.compare}</th>}
          <th>{heads.session}</th>
          <th>{heads.subject}</th>
          <th>{heads.started}</th>
          <th>{heads.rig}</th>
          <th class="number">{heads.duration}</th>
          <th>{heads.state}</th>
          <th>{heads.label}</th>
        </tr>
      </thead>
      <tbody>
        {sessions.map((session) => (
          <Row key={session.sessionId} session={session} choosing={choosing} />
        ))}
      </tbody>
    </table>
  );
};
