// SPDX-License-Identifier: Apache-2.0
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { Notice, Panel } from '../../parts/controls';
import { asSentence, protocolName, sessionTitle } from '../../parts/names';
import { dateTime, duration } from '../../parts/numbers';
import { strings } from '../../strings';
import { useAsked } from './asking';
import { correctionOf } from './corrections';
import { Exports } from './exports';
import { durationS, rigsOf } from './filters';
import { Report } from './report';
import { CorrectionTable, SessionChange } from './session_change';
import { MarkerTable, PartTable, ResultTable, TrialsOfSession } from './session_tables';
import { LostScans, StateMark } from './state_mark';

export const askSession = async (link: Link, sessionId: string): Promise<SessionRecord> => {
  const answer = await link.send({ case: 'showSession', value: { sessionId } });
  if (answer.case !== 'sessionRecord') throw new Error(strings.sessions.unexpected);
  return answer.value;
};

/** Changes with every trial of a running session, and when the session ends and gets its results. */
const detailKey = (link: Link, sessionId: string): string => {
  if (link.state.value !== 'up') return '';
  const running = link.status.value?.rigs.find((rig) => rig.session?.sessionId === sessionId)?.session;
  return `${sessionId} ${running?.state ?? 0} ${running?.trial?.trial ?? 0} ${running?.trial?.phase ?? 0}`;
};

const Facts = ({ session }: { session: SessionRecord }): JSX.Element => {
  const { heads } = strings.sessions.list;
  const { facts } = strings.sessions;
  const { fields } = strings.sessions.change;
  const entries: readonly (readonly [string, string, string?])[] = [
    [heads.subject, session.subject, correctionOf(session, 'subject')],
    [heads.protocol, protocolName(session.protocol)],
    [heads.rig, rigsOf(session)],
    [heads.started, dateTime(session.startedUtcNs)],
    [facts.ended, dateTime(session.endedUtcNs ?? 0n)],
    [heads.duration, duration(durationS(session))],
    [heads.label, session.label, correctionOf(session, 'label')],
    [fields['notes'] ?? '', session.notes, correctionOf(session, 'notes')],
    [facts.message, session.state === 'aborted' ? session.message : asSentence(session.message)], // a person typed why it was aborted
  ];
  return (
    <dl class="facts" data-testid="session-facts">
      {entries
        .filter(([, value, correction = '']) => value !== '' || correction !== '')
        .map(([name, value, correction = '']) => [
          <dt key={name}>{name}</dt>,
          <dd key={`${name} value`}>
            {value || strings.common.undefinedValue}
            {correction !== '' && <div class="corrected">{correction}</div>}
          </dd>,
        ])}
    </dl>
  );
};

const Finished = ({ session }: { session: SessionRecord }): JSX.Element => (
  <>
    <Panel title={strings.sessions.exports.title} testId="exports">
      <Exports session={session} />
    </Panel>
    <Panel title={strings.sessions.report.head} testId="report-panel">
      <Report sessionId={session.sessionId} testId="report" />
    </Panel>
  </>
);

export const SessionDetail = ({ link, sessionId }: { link: Link; sessionId: string }): JSX.Element => {
  const { back, results, trials, markers, parts, stillRuns, subject, change } = strings.sessions;
  const changes = useSignal(0);
  const key = detailKey(link, sessionId);
  const asked = useAsked(key === '' ? '' : `${key} ${changes.value}`, () => askSession(link, sessionId)).value;
  const session = asked.answer;
  return (
    <div class="column sessions-detail">
      <p>
        <a class="sessions-link" href="#/sessions">
          {back}
        </a>
      </p>
      <div>
        <h1>{session === undefined ? sessionId : sessionTitle(session)}</h1>
        {session !== undefined && (
          <p class="sessions-note" data-testid="session-id">
            {strings.sessions.id} {sessionId}
          </p>
        )}
        {session !== undefined && (
          <div data-testid="session-usefulness">
            <StateMark session={session} />
            <LostScans session={session} />
          </div>
        )}
      </div>
      {asked.error !== undefined && <Notice kind="error" what={asked.error.message} hint={asked.error.hint} testId="session-error" />}
      {session !== undefined && (
        <>
          <Facts session={session} />
          {session.subject !== '' && (
            <p>
              <a class="button" href={`#/subjects/${encodeURIComponent(session.subject)}`} data-testid="subject-page">
                {subject.page(session.subject)}
              </a>
            </p>
          )}
          <SessionChange key={session.isDeleted} link={link} session={session} onChanged={() => (changes.value += 1)} />
          {session.state === 'running' ? <Notice kind="plain" what={stillRuns} testId="still-runs" /> : <Finished key={changes.value} session={session} />}
          <Panel title={trials.head} testId="trials-panel">
            <TrialsOfSession session={session} />
          </Panel>
          <Panel title={results.head} testId="results-panel">
            <ResultTable results={session.results} />
          </Panel>
          {session.markers.length > 0 && (
            <Panel title={markers.head} testId="markers-panel">
              <MarkerTable session={session} />
            </Panel>
          )}
          {session.corrections.length > 0 && (
            <Panel title={change.head} testId="corrections-panel">
              <CorrectionTable session={session} />
            </Panel>
          )}
          <Panel title={parts.head} testId="parts-panel">
            <PartTable session={session} />
          </Panel>
        </>
      )}
    </div>
  );
};
