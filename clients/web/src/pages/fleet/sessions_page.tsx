// SPDX-License-Identifier: Apache-2.0
// Sessions of all clinics, newest first, in pages.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useEffect } from 'preact/hooks';

import type { Link } from '../../link/types';
import { Button, Field, Notice } from '../../parts/controls';
import { protocolName } from '../../parts/names';
import { dateTime, duration, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { useAsked } from '../sessions/asking';
import type { Clinics, Measures, Session } from './asking';
import { askCentre, queryOf } from './asking';
import { Choice } from './choice';
import type { SessionFilters } from './filters';
import { parametersOf } from './filters';
import { useSessionPages } from './session_pages';

const words = strings.fleet.sessions;
const pause = 300; // ms after the last key, before the centre is asked

const recordingText = ({ parts, stored_parts: stored }: Session): string => {
  if (parts === 0) return words.noRecording;
  if (stored === parts) return words.stored;
  return stored === 0 ? words.notStored : words.partlyStored(whole(stored), whole(parts));
};

const Row = ({ session }: { session: Session }): JSX.Element => {
  const { heads } = words;
  const { states, validTrials } = strings.sessions;
  return (
    <tr data-testid="session-row" data-session={session.id}>
      <th scope="row">
        {protocolName(session.protocol)}
        <div class="sessions-note">{session.id}</div>
        {session.label !== null && session.label !== '' && <div class="sessions-note">{session.label}</div>}
      </th>
      <td data-label={heads.clinic}>
        <a class="sessions-link" href={`#/clinics/${session.clinic}`}>
          {session.clinic}
        </a>
      </td>
      <td data-label={heads.subject}>{session.subject ?? strings.common.undefinedValue}</td>
      <td data-label={heads.started}>{dateTime(BigInt(session.started_ms) * 1_000_000n)}</td>
      <td data-label={heads.rig}>{session.rig}</td>
      <td data-label={heads.duration} class="number">
        {duration(session.duration_s ?? undefined)}
      </td>
      <td data-label={heads.state}>
        {states[session.state] ?? session.state}
        {session.planned_trials > 0 && session.valid_trials !== null && (
          <div class="sessions-note">{validTrials(whole(session.valid_trials), whole(session.planned_trials))}</div>
        )}
      </td>
      <td data-label={heads.recording}>{recordingText(session)}</td>
    </tr>
  );
};

const Table = ({ sessions }: { sessions: readonly Session[] }): JSX.Element => {
  const { heads } = words;
  return (
    <table class="sessions-table stack" data-testid="session-table">
      <thead>
        <tr>
          <th>{heads.session}</th>
          <th>{heads.clinic}</th>
          <th>{heads.subject}</th>
          <th>{heads.started}</th>
          <th>{heads.rig}</th>
          <th class="number">{heads.duration}</th>
          <th>{heads.state}</th>
          <th>{heads.recording}</th>
        </tr>
      </thead>
      <tbody>
        {sessions.map((session) => (
          <Row key={`${session.clinic} ${session.id}`} session={session} />
        ))}
      </tbody>
    </table>
  );
};

interface BarProps {
  link: Link;
  filters: SessionFilters;
  onChange: (filters: SessionFilters) => void;
}

const FilterBar = ({ link, filters, onChange }: BarProps): JSX.Element => {
  const { filters: names } = words;
  const clinics = useAsked('clinics', (signal) => askCentre<Clinics>(link, 'clinics', signal)).value.answer?.clinics ?? [];
  const protocols = useAsked('measures', (signal) => askCentre<Measures>(link, 'measures', signal)).value.answer?.protocols ?? [];
  const input = (name: 'rig' | 'subject' | 'since', type: string): JSX.Element => (
    <Field label={names[name]}>
      {(links) => (
        <input {...links} type={type} value={filters[name]} data-testid={`filter-${name}`} onInput={(event) => onChange({ ...filters, [name]: event.currentTarget.value })} />
      )}
    </Field>
  );
  const all = ['', names.all] as const;
  return (
    <div class="row" role="search">
      <Choice
        label={names.clinic}
        value={filters.clinic}
        options={[all, ...clinics.map(({ name, title }) => [name, title] as const).sort(([, one], [, other]) => one.localeCompare(other))]}
        testId="filter-clinic"
        onChange={(clinic) => onChange({ ...filters, clinic })}
      />
      <Choice
        label={names.protocol}
        value={filters.protocol}
        options={[all, ...protocols.map((name) => [name, protocolName(name)] as const)]}
        testId="filter-protocol"
        onChange={(protocol) => onChange({ ...filters, protocol })}
      />
      {input('rig', 'search')}
      {input('subject', 'search')}
      {input('since', 'date')}
    </div>
  );
};

/** `clinic`: that the address names. */
export const FleetSessionsPage = ({ link, clinic }: { link: Link; clinic: string }): JSX.Element => {
  const filters = useSignal<SessionFilters>({ clinic, rig: '', protocol: '', subject: '', since: '' });
  const asked = useSignal(queryOf(parametersOf(filters.value))); // follows the filters after a pause
  const query = queryOf(parametersOf(filters.value));
  useEffect(() => {
    const timer = setTimeout(() => (asked.value = query), pause);
    return () => clearTimeout(timer);
  }, [query]);
  const { sessions: shown, error, hasOlder, loadOlder } = useSessionPages(link, asked.value);
  return (
    <div class="column">
      <h1>{words.title}</h1>
      <FilterBar link={link} filters={filters.value} onChange={(changed) => (filters.value = changed)} />
      {error !== undefined && <Notice kind="error" what={error.message} hint={error.hint} testId="fleet-error" />}
      <p role="status" data-testid="session-count">
        {shown === undefined ? words.asking : shown.length === 0 ? '' : words.count(whole(shown.length), hasOlder)}
      </p>
      {shown?.length === 0 && (
        <p class="empty" data-testid="no-sessions">
          {asked.value === '' ? words.none : words.noneOfFilter}
        </p>
      )}
      {shown !== undefined && shown.length > 0 && <Table sessions={shown} />}
      {hasOlder && (
        <div>
          <Button label={words.older} testId="older" onClick={loadOlder} />
        </div>
      )}
    </div>
  );
};
