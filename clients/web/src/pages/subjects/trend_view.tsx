// SPDX-License-Identifier: Apache-2.0
// The trend of a measure over the visits of a subject, and the results in plain words.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';
import { useMemo } from 'preact/hooks';

import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import { conditionName, protocolName } from '../../parts/names';
import { dateTime, day, fixed, measured, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { Choice } from '../fleet/choice';
import '../fleet/fleet.css';
import { LinePlot, mostLines } from '../fleet/line_plot';
import { resultName, unitText } from '../sessions/result_names';
import type { SubjectTrend, TrendSeries } from './trend_data';
import { groupOf, measuresOf, measureText, plotOf, valueText } from './trend_data';

const words = strings.subjects;

const conditionText = ({ protocol, condition }: TrendSeries): string => {
  if (condition === '') return words.trend.whole;
  return condition.startsWith('romberg') ? resultName(`${condition}/`).replace(/[:\s]+$/, '') : conditionName(protocol, condition);
};

const TrendTable = ({ series }: { series: readonly TrendSeries[] }): JSX.Element => {
  const { heads, notComparable } = words.trend;
  const unit = unitText(series[0]?.unit ?? '');
  const value = unit === '' ? heads.value : `${heads.value} (${unit})`;
  const rows = series.flatMap((one) => one.points.map((point) => ({ one, point }))).sort((one, other) => Number(BigInt(other.point.utc_ns) - BigInt(one.point.utc_ns)));
  return (
    <table class="sessions-table stack" data-testid="subject-trend-table">
      <thead>
        <tr>
          <th>{heads.visit}</th>
          <th>{heads.condition}</th>
          <th class="number">{value}</th>
          <th class="number">{heads.sd}</th>
          <th class="number">{heads.trials}</th>
          <th>{heads.note}</th>
        </tr>
      </thead>
      <tbody>
        {rows.map(({ one, point }) => (
          <tr key={`${one.condition} ${point.session}`} data-value={point.value}>
            <th scope="row">
              <a class="sessions-link" href={`#/sessions/${encodeURIComponent(point.session)}`}>
                {dateTime(BigInt(point.utc_ns))}
              </a>
            </th>
            <td data-label={heads.condition}>{conditionText(one)}</td>
            <td data-label={value} class="number">
              {valueText(one, point.value)}
            </td>
            <td data-label={heads.sd} class="number">
              {point.sd === undefined ? '' : measured(point.sd)}
            </td>
            <td data-label={heads.trials} class="number">
              {point.trials === undefined ? '' : whole(point.trials)}
            </td>
            <td data-label={heads.note}>{point.is_comparable ? '' : notComparable}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
};

const Bands = ({ series }: { series: readonly TrendSeries[] }): JSX.Element => {
  const known = series.filter(({ retest }) => retest !== undefined);
  if (known.length === 0) return <p data-testid="no-band">{words.trend.noBand}</p>;
  return (
    <>
      {known.map((one) => (
        <p key={one.condition} data-testid="band">
          {words.trend.band(fixed(one.retest!.percent, 0), conditionText(one))}
        </p>
      ))}
      <p class="sessions-note">{words.trend.source(known[0]!.retest!.source)}</p>
    </>
  );
};

export const TrendView = ({ trend }: { trend: SubjectTrend }): JSX.Element => {
  const chosenGroup = useSignal('');
  const chosenMeasure = useSignal('');
  const groups = [...new Map(trend.series.map((one) => [groupOf(one), one])).entries()];
  const newest = [...trend.series].sort((one, other) => Number(BigInt(other.points.at(-1)!.utc_ns) - BigInt(one.points.at(-1)!.utc_ns)))[0];
  const group = groups.some(([key]) => key === chosenGroup.value) ? chosenGroup.value : newest === undefined ? '' : groupOf(newest);
  const measures = measuresOf(trend.series, group);
  const measure = measures.includes(chosenMeasure.value) ? chosenMeasure.value : (measures[0] ?? '');
  const shown = useMemo(() => trend.series.filter((one) => groupOf(one) === group && one.measure === measure), [trend, group, measure]);
  const { timesMs, lines } = useMemo(() => plotOf(shown, conditionText), [shown]);
  if (newest === undefined) return <p data-testid="no-trend">{words.trend.none}</p>;
  return (
    <>
      <div class="row">
        <Choice
          label={words.trend.series}
          value={group}
          options={groups.map(([key, { rig, protocol }]) => [key, words.trend.condition(rig, protocolName(protocol))] as const)}
          testId="subject-trend-group"
          onChange={(key) => (chosenGroup.value = key)}
        />
        <Choice
          label={words.trend.measure}
          value={measure}
          options={measures.map((one) => [one, measureText(one)] as const)}
          testId="subject-trend-measure"
          onChange={(one) => (chosenMeasure.value = one)}
        />
      </div>
      <LinePlot
        timesMs={timesMs}
        lines={lines.slice(0, mostLines)}
        unit={unitText(shown[0]?.unit ?? '')}
        label={words.trend.plot(measureText(measure), whole(timesMs.length))}
        testId="subject-trend-plot"
      />
      <Bands series={shown} />
      <TrendTable series={shown} />
    </>
  );
};

/** Sentences of the newest session of each rig and protocol; `sessions` names them. */
export const PlainWords = ({ trend, sessions }: { trend: SubjectTrend; sessions: readonly SessionRecord[] }): JSX.Element => {
  const known = new Map(sessions.map((session) => [session.sessionId, session]));
  const kindOf = (id: string): string => `${known.get(id)?.rig} ${known.get(id)?.protocol}`;
  const all = trend.words.sessions; // newest first
  const shown = all.filter(({ session }, index) => all.findIndex((one) => kindOf(one.session) === kindOf(session)) === index);
  if (shown.length === 0) return <p>{words.words.none}</p>;
  return (
    <div class="column" data-testid="plain-words">
      {shown.map(({ session, sentences }) => (
        <section key={session}>
          <h3>{words.words.session(protocolName(known.get(session)?.protocol ?? ''), day(known.get(session)?.startedUtcNs ?? 0n))}</h3>
          <ul>
            {sentences.map((sentence) => (
              <li key={sentence}>{sentence}</li>
            ))}
          </ul>
        </section>
      ))}
      {trend.words.changes.length > 0 && (
        <section>
          <h3>{words.words.changes}</h3>
          <ul data-testid="change-words">
            {trend.words.changes.map((sentence) => (
              <li key={sentence}>{sentence}</li>
            ))}
          </ul>
        </section>
      )}
      <p class="sessions-note">{words.words.note}</p>
    </div>
  );
};
