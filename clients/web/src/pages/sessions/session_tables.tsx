// SPDX-License-Identifier: Apache-2.0
// Parts, trials and results of one session.
import type { JSX } from 'preact';

import type { SessionRecord, TrialRecord } from '../../generated/dts/v1/sessions_pb';
import { PartState } from '../../generated/dts/v1/sessions_pb';
import { asSentence, conditionName } from '../../parts/names';
import type { SessionResult } from '../../generated/dts/v1/stream_pb';
import { bytes, duration, fixed, measured, whole } from '../../parts/numbers';
import { OutcomeMark, outcomeOf } from '../../parts/outcomes';
import { strings } from '../../strings';
import { TargetTable, TrialTable } from '../chair/trial_tables';
import { decisionWords } from '../floor/decision_tile';
import { markerCorrection, outcomeCorrection } from './corrections';
import { decisionLimitsOf, keptDecision } from './decisions';
import { lossLine } from './losses';
import { resultName, resultValue, unitText } from './result_names';

export const PartTable = ({ session }: { session: SessionRecord }): JSX.Element => {
  const { heads, states, checksum, lost, lossesUnknown } = strings.sessions.parts;
  return (
    <table class="stack" data-testid="part-table">
      <thead>
        <tr>
          <th class="number">{heads.part}</th>
          <th>{heads.rig}</th>
          <th>{heads.state}</th>
          <th class="number">{heads.duration}</th>
          <th class="number">{heads.scans}</th>
          <th class="number">{heads.size}</th>
          <th>{heads.file}</th>
        </tr>
      </thead>
      <tbody>
        {session.parts.map((part) => (
          <tr key={part.part}>
            <td data-label={heads.part} class="number">
              {whole(part.part)}
            </td>
            <td data-label={heads.rig}>{part.rig}</td>
            <td data-label={heads.state}>
              <div>
                {states[part.state] ?? PartState[part.state]}
                {part.reason !== '' && <div class="sessions-note">{asSentence(part.reason)}</div>}
                {part.lostSAtMost > 0 && <div class="sessions-note">{lost(fixed(part.lostSAtMost, 2))}</div>}
                {part.isLossUnknown && <div class="sessions-note">{lossesUnknown}</div>}
                {part.losses.map((loss) => (
                  <div key={loss.reason} class="sessions-note">
                    {lossLine(loss)}
                  </div>
                ))}
              </div>
            </td>
            <td data-label={heads.duration} class="number">
              {duration(part.durationS)}
            </td>
            <td data-label={heads.scans} class="number">
              {whole(part.scans)}
            </td>
            <td data-label={heads.size} class="number">
              {bytes(part.bytes)}
            </td>
            <td data-label={heads.file} class="sessions-file">
              <div>
                {part.file}
                <div class="sessions-note">{checksum(part.sha256)}</div>
              </div>
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
};

/** Measures of a trial of quiet standing that fit one line; the report has all. */
const shownMeasures = ['MVELO', 'RDIST', 'PEA95_F'] as const;

const measureHeads = { MVELO: 'velocity', RDIST: 'distance', PEA95_F: 'ellipse' } as const;

/** What the steadiness model decided when the trial ended. A trial that does not count has no decision. */
const DecisionCell = ({ trial }: { trial: TrialRecord }): JSX.Element => {
  const { heads } = strings.sessions.trials;
  const decision = keptDecision(trial);
  if (decision === undefined) return <td data-label={heads.decision}>{strings.common.undefinedValue}</td>;
  const { value, note } = decisionWords(decision);
  return (
    <td data-label={heads.decision} data-testid="trial-decision">
      <div>
        {value} <span class="unit">({decision.label})</span>
        <div class="sessions-note">{note}</div>
      </div>
    </td>
  );
};

const SwayRow = ({ session, trial, hasDecisions }: { session: SessionRecord; trial: TrialRecord; hasDecisions: boolean }): JSX.Element => {
  const { sway } = trial;
  const { heads } = strings.sessions.trials;
  const correction = outcomeCorrection(session, trial);
  return (
    <tr>
      <td data-label={heads.trial} class="number">
        {trial.attempt > 1 ? `${whole(trial.trial)}.${whole(trial.attempt)}` : whole(trial.trial)}
      </td>
      <td data-label={heads.condition}>{conditionName(session.protocol, trial.condition)}</td>
      <td data-label={heads.outcome}>
        <div>
          <OutcomeMark outcome={outcomeOf(trial)} />
          {correction !== '' && <div class="corrected">{correction}</div>}
          {sway !== undefined && sway.problem !== '' && <div class="sessions-note">{asSentence(sway.problem)}</div>}
        </div>
      </td>
      <td data-label={heads.duration} class="number">
        {duration(sway?.durationS)}
      </td>
      {shownMeasures.map((symbol) => (
        <td key={symbol} data-label={heads[measureHeads[symbol]]} class="number">
          {measured(sway?.measures.find((one) => one.symbol === symbol)?.value)}
        </td>
      ))}
      {hasDecisions && <DecisionCell trial={trial} />}
    </tr>
  );
};

const SwayTable = ({ session }: { session: SessionRecord }): JSX.Element => {
  const { heads } = strings.sessions.trials;
  const limits = decisionLimitsOf(session);
  const hasDecisions = limits.length > 0;
  const table = (
    <table class="stack" data-testid="trial-table">
      <thead>
        <tr>
          <th class="number">{heads.trial}</th>
          <th>{heads.condition}</th>
          <th>{heads.outcome}</th>
          <th class="number">{heads.duration}</th>
          <th class="number">{heads.velocity}</th>
          <th class="number">{heads.distance}</th>
          <th class="number">{heads.ellipse}</th>
          {hasDecisions && <th>{heads.decision}</th>}
        </tr>
      </thead>
      <tbody>
        {session.trials.map((trial) => (
          <SwayRow key={`${trial.part}/${trial.trial}/${trial.attempt}`} session={session} trial={trial} hasDecisions={hasDecisions} />
        ))}
      </tbody>
    </table>
  );
  if (!hasDecisions) return table;
  return (
    <div class="column">
      {table}
      <ul class="decision-limits" data-testid="decision-limits">
        {limits.map((line) => (
          <li key={line}>{line}</li>
        ))}
      </ul>
    </div>
  );
};

export const TrialsOfSession = ({ session }: { session: SessionRecord }): JSX.Element => {
  const { trials, protocol } = session;
  if (trials.length === 0) return <p>{strings.sessions.trials.none}</p>;
  const isReaching = trials.some((trial) => trial.result !== undefined);
  if (!isReaching) return <SwayTable session={session} />;
  return (
    <div class="column">
      <TargetTable protocol={protocol} trials={trials} />
      <TrialTable protocol={protocol} trials={trials} isWhole correctionOf={(trial) => outcomeCorrection(session, trial)} />
    </div>
  );
};

/** The plain name of a result, with its key in exports ("eyes-open/RANGE_AP") below. */
export const ResultName = ({ name }: { name: string }): JSX.Element => (
  <>
    {resultName(name)}
    <div class="sessions-note">{name}</div>
  </>
);

export const ResultTable = ({ results }: { results: readonly SessionResult[] }): JSX.Element => {
  const { heads, none } = strings.sessions.results;
  if (results.length === 0) return <p>{none}</p>;
  return (
    <table class="stack" data-testid="result-table">
      <thead>
        <tr>
          <th>{heads.result}</th>
          <th class="number">{heads.value}</th>
          <th>{heads.unit}</th>
        </tr>
      </thead>
      <tbody>
        {results.map((result) => (
          <tr key={result.name}>
            <td data-label={heads.result}>
              <div>
                <ResultName name={result.name} />
              </div>
            </td>
            <td data-label={heads.value} class="number" data-testid={`result-${result.name}`}>
              {resultValue(result)}
            </td>
            <td data-label={heads.unit} class="unit-cell">{unitText(result.unit)}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
};

/** All markers; a corrected one says so. */
export const MarkerTable = ({ session }: { session: SessionRecord }): JSX.Element => {
  const { heads } = strings.sessions.markers;
  return (
    <table class="stack" data-testid="marker-table">
      <thead>
        <tr>
          <th class="number">{heads.marker}</th>
          <th>{heads.text}</th>
          <th class="number">{heads.part}</th>
          <th class="number">{heads.scan}</th>
        </tr>
      </thead>
      <tbody>
        {session.markers.map((marker) => {
          const correction = markerCorrection(session, marker);
          return (
            <tr key={marker.number}>
              <td data-label={heads.marker} class="number">
                {whole(marker.number)}
              </td>
              <td data-label={heads.text}>
                <div>
                  {marker.text || strings.sessions.change.removedText}
                  {correction !== '' && <div class="corrected">{correction}</div>}
                </div>
              </td>
              <td data-label={heads.part} class="number">
                {whole(marker.part)}
              </td>
              <td data-label={heads.scan} class="number">
                {whole(Number(marker.scan))}
              </td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
};
