// SPDX-License-Identifier: Apache-2.0
// How a measure changes from week to week, in each clinic.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useMemo } from 'preact/hooks';

import type { Link } from '../../link/types';
import { Notice } from '../../parts/controls';
import { protocolName } from '../../parts/names';
import { dayUtc, measured, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { useAsked } from '../sessions/asking';
import { resultName, unitText } from '../sessions/result_names';
import type { Clinics, Measure, Measures, Trend } from './asking';
import { askCentre, queryOf } from './asking';
import { Choice } from './choice';
import { trendSince } from './filters';
import { LinePlot, mostLines } from './line_plot';
import { linesOf, tableOf } from './trend';

const words = strings.fleet.trends;

const measureKey = ({ name, analysis }: Measure): string => `${analysis} ${name}`;
const measureText = ({ name, analysis }: Measure): string => (analysis === 'clinic' ? resultName(name) : words.ofCentre(resultName(name), analysis));

const TrendTable = ({ trend, unit }: { trend: Trend; unit: string }): JSX.Element => {
  const rows = useMemo(() => tableOf(trend.points), [trend]);
  const { heads } = words;
  const withUnit = (text: string): string => (unit === '' ? text : `${text} (${unit})`);
  const isOneClinic = new Set(rows.map(({ clinic }) => clinic)).size === 1;
  return (
    <>
      <h2>{isOneClinic ? words.weeks(rows[0]!.clinic) : words.newest}</h2>
      <table class="sessions-table stack" data-testid="trend-table">
        <thead>
          <tr>
            <th>{heads.clinic}</th>
            <th>{heads.week}</th>
            <th class="number">{heads.count}</th>
            <th class="number">{withUnit(heads.median)}</th>
            <th class="number">{withUnit(heads.quartiles)}</th>
          </tr>
        </thead>
        <tbody>
          {rows.map((row) => (
            <tr key={`${row.clinic} ${row.weekMs}`}>
              <th scope="row">
                <a class="sessions-link" href={`#/clinics/${row.clinic}`}>
                  {row.clinic}
                </a>
              </th>
              <td data-label={heads.week}>{dayUtc(row.weekMs)}</td>
              <td data-label={heads.count} class="number">
                {whole(row.count)}
              </td>
              <td data-label={withUnit(heads.median)} class="number">
                {measured(row.median)}
              </td>
              <td data-label={withUnit(heads.quartiles)} class="number">
                {words.range(measured(row.low), measured(row.high))}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </>
  );
};

const TrendPicture = ({ trend, measure }: { trend: Trend; measure: Measure }): JSX.Element => {
  const { timesMs, lines, clinics } = useMemo(() => linesOf(trend.points, mostLines), [trend]);
  const unit = unitText(measure.unit);
  return (
    <>
      <p>{words.sentence}</p>
      {clinics > lines.length && <Notice kind="plain" what={words.limited(whole(lines.length), whole(clinics))} testId="trend-limited" />}
      <LinePlot timesMs={timesMs} lines={lines} unit={unit} label={words.label(measureText(measure), whole(lines.length))} testId="trend-plot" />
      <TrendTable trend={trend} unit={unit} />
    </>
  );
};

interface TrendChoice {
  readonly clinic: string;
  readonly protocol: string;
  readonly since: string;
}

export const TrendsPage = ({ link }: { link: Link }): JSX.Element => {
  const chosenKey = useSignal('');
  const choice = useSignal<TrendChoice>({ clinic: '', protocol: '', since: 'year' });
  const measures = useAsked('measures', (signal) => askCentre<Measures>(link, 'measures', signal)).value;
  const clinics = useAsked('clinics', (signal) => askCentre<Clinics>(link, 'clinics', signal)).value.answer?.clinics ?? [];
  const all = measures.answer?.measures ?? [];
  const measure = all.find((one) => measureKey(one) === chosenKey.value) ?? [...all].sort((one, other) => other.count - one.count)[0];
  const { clinic, protocol, since } = choice.value;
  const query =
    measure === undefined ? '' : queryOf({ measure: measure.name, analysis: measure.analysis, clinic, protocol, since: trendSince(since, Date.now()) });
  const asked = useAsked(query, async (signal) => ({ query, trend: await askCentre<Trend>(link, `trend${query}`, signal) })).value;
  const { error, isBusy } = asked;
  const answer = asked.answer?.query === query ? asked.answer.trend : undefined; // else it is that of another measure
  const set = (change: Partial<TrendChoice>): void => void (choice.value = { ...choice.value, ...change });
  const { filters } = words;
  const failed = measures.error ?? error;
  return (
    <div class="column">
      <h1>{words.title}</h1>
      {all.length > 0 && (
        <div class="row" role="search">
          <Choice
            label={filters.measure}
            value={measure === undefined ? '' : measureKey(measure)}
            options={all.map((one) => [measureKey(one), measureText(one)] as const)}
            testId="trend-measure"
            onChange={(key) => (chosenKey.value = key)}
          />
          <Choice
            label={filters.clinic}
            value={clinic}
            options={[['', filters.all], ...clinics.map(({ name, title }) => [name, title] as const)]}
            testId="trend-clinic"
            onChange={(value) => set({ clinic: value })}
          />
          <Choice
            label={filters.protocol}
            value={protocol}
            options={[['', filters.all], ...(measures.answer?.protocols ?? []).map((name) => [name, protocolName(name)] as const)]}
            testId="trend-protocol"
            onChange={(value) => set({ protocol: value })}
          />
          <Choice
            label={filters.since}
            value={since}
            options={Object.entries(words.since)}
            testId="trend-since"
            onChange={(value) => set({ since: value })}
          />
        </div>
      )}
      {failed !== undefined && <Notice kind="error" what={failed.message} hint={failed.hint} testId="fleet-error" />}
      {(measures.isBusy || isBusy) && <p role="status">{words.asking}</p>}
      {measures.answer !== undefined && all.length === 0 && (
        <p class="empty" data-testid="no-measures">
          {words.noMeasures}
        </p>
      )}
      {answer?.points.length === 0 && (
        <p class="empty" data-testid="no-trend">
          {words.none}
        </p>
      )}
      {measure !== undefined && answer !== undefined && answer.points.length > 0 && <TrendPicture trend={answer} measure={measure} />}
    </div>
  );
};
