// SPDX-License-Identifier: Apache-2.0
// The trials of a session of the reaching task, and their consistency by target.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import type { TrialRecord } from '../../generated/dts/v1/sessions_pb';
import { targetName } from '../../parts/names';
import type { TrialResult, TrunkMovement } from '../../generated/dts/v1/stream_pb';
import { fixed, whole } from '../../parts/numbers';
import { OutcomeMark, outcomeOf } from '../../parts/outcomes';
import { strings } from '../../strings';
import type { TargetSummary } from './consistency';
import { angleOf, byTarget, counts } from './consistency';
import { classWord, doubts } from './words';

const classText = (trial: TrialRecord): string => {
  const { result } = trial;
  if (result === undefined) return strings.common.undefinedValue;
  if (result.hasGap) return strings.common.outcomes.noValues;
  if (result.movement === undefined) return strings.chair.result.noReach;
  const why = result.movement.trunkClass < 0 ? doubts(result.movement, result.reach) : [];
  return classWord(result.movement) + (why.length > 0 ? ` (${why.join(', ')})` : '');
};

const targetText = (protocol: string, condition: string, cm: number): string => {
  const name = targetName(protocol, condition);
  return cm > 0 ? strings.chair.table.target(name, fixed(cm, 0)) : name;
};

const intervalText = ({ trunkLoDeg, trunkHiDeg }: Partial<TrunkMovement>): string =>
  trunkLoDeg === undefined || trunkHiDeg === undefined
    ? strings.common.undefinedValue
    : strings.chair.table.window(fixed(trunkLoDeg, 1), fixed(trunkHiDeg, 1));

const detailHeads = strings.chair.table.heads.details;

/** The interval of the angle, P1, P2, P3, and the probabilities of the classes 1, 2, 3. */
const Details = ({ result }: { result: TrialResult | undefined }): JSX.Element => (
  <>
    <td data-label={detailHeads[0]} class="number">
      {intervalText(result?.movement ?? {})}
    </td>
    {[result?.reach?.p1, result?.reach?.p2, result?.reach?.p3].map((point, index) => (
      <td key={index} data-label={detailHeads[index + 1]} class="number">
        {fixed(point?.valueMm, 2)}
      </td>
    ))}
    <td data-label={detailHeads[4]} class="number">{result?.movement?.probability.map((one) => fixed(one, 2)).join(' / ') ?? strings.common.undefinedValue}</td>
  </>
);

interface TablesProps {
  /** Name of the protocol, for the titles of its conditions. */
  protocol: string;
  trials: readonly TrialRecord[];
}

interface TrialTableProps extends TablesProps {
  /** With everything that is known of each reach. */
  isWhole?: boolean;
  /** Returns how a trial's outcome was corrected, or "". */
  correctionOf?: (trial: TrialRecord) => string;
}

export const TrialTable = ({ protocol, trials, isWhole = false, correctionOf = () => '' }: TrialTableProps): JSX.Element => {
  const { heads } = strings.chair.table;
  return (
    <table class="chair-table stack" data-testid="trial-table">
      <thead>
        <tr>
          <th class="number">{heads.trial}</th>
          <th>{heads.target}</th>
          <th>{heads.outcome}</th>
          <th>{heads.trunk}</th>
          <th class="number">{heads.angle}</th>
          {isWhole && heads.details.map((head) => <th key={head} class="number">{head}</th>)}
        </tr>
      </thead>
      <tbody>
        {[...trials].reverse().map((trial) => (
          <tr key={`${trial.part}/${trial.trial}/${trial.attempt}`} class={counts(trial) ? '' : 'chair-void'}>
            <td data-label={heads.trial} class="number">
              {trial.attempt > 1 ? `${whole(trial.trial)}.${whole(trial.attempt)}` : whole(trial.trial)}
            </td>
            <td data-label={heads.target}>{targetText(protocol, trial.condition, trial.result?.targetCm ?? 0)}</td>
            <td data-label={heads.outcome}>
              <div>
                <OutcomeMark outcome={outcomeOf(trial)} />
                {correctionOf(trial) !== '' && <div class="corrected">{correctionOf(trial)}</div>}
              </div>
            </td>
            <td data-label={heads.trunk}>{classText(trial)}</td>
            <td data-label={heads.angle} class="number">
              {fixed(angleOf(trial), 1)}
            </td>
            {isWhole && <Details result={trial.result} />}
          </tr>
        ))}
      </tbody>
    </table>
  );
};

const isInside = ({ meanDeg, window }: TargetSummary): boolean | undefined =>
  window === undefined || !Number.isFinite(meanDeg) ? undefined : meanDeg >= window.lowDeg && meanDeg <= window.highDeg;

const WindowCell = ({ summary }: { summary: TargetSummary }): JSX.Element => {
  const inside = isInside(summary);
  const head = strings.chair.table.heads.window;
  if (summary.window === undefined) return <td data-label={head}>{strings.common.undefinedValue}</td>;
  const range = strings.chair.table.window(fixed(summary.window.lowDeg, 1), fixed(summary.window.highDeg, 1));
  const word = inside === undefined ? '' : inside ? strings.chair.table.inside : strings.chair.table.outside;
  return (
    <td data-label={head}>
      {range}
      {word !== '' && <strong class={inside ? 'chair-inside' : 'chair-outside'}> {word}</strong>}
    </td>
  );
};

export const TargetTable = ({ protocol, trials }: TablesProps): JSX.Element => {
  const { heads, source } = strings.chair.table;
  return (
    <>
      <table class="chair-table stack" data-testid="target-table">
        <thead>
          <tr>
            <th>{heads.target}</th>
            <th class="number">{heads.count}</th>
            <th class="number">{heads.angle}</th>
            <th class="number">{heads.sd}</th>
            <th>{heads.window}</th>
          </tr>
        </thead>
        <tbody>
          {byTarget(trials).map((summary) => (
            <tr key={summary.condition}>
              <td data-label={heads.target}>{targetText(protocol, summary.condition, summary.targetCm)}</td>
              <td data-label={heads.count} class="number">
                {whole(summary.trials)}
              </td>
              <td data-label={heads.angle} class="number">
                {fixed(summary.meanDeg, 1)}
              </td>
              <td data-label={heads.sd} class="number">
                {fixed(summary.sdDeg, 1)}
              </td>
              <WindowCell summary={summary} />
            </tr>
          ))}
        </tbody>
      </table>
      <p class="chair-source">{source}</p>
    </>
  );
};

type View = 'trials' | 'targets';

/** Shows the trials during a session and the targets after it, unless the user chose one. */
export const Trials = ({ protocol, trials, isOver }: TablesProps & { isOver: boolean }): JSX.Element => {
  const chosen = useSignal<View | undefined>(undefined);
  const view = chosen.value ?? (isOver ? 'targets' : 'trials');
  const { title, byTrial, byTargets, none } = strings.chair.table;
  const choice = (name: View, label: string): JSX.Element => (
    <button type="button" class="button" aria-pressed={view === name} data-testid={`trials-${name}`} onClick={() => (chosen.value = name)}>
      {label}
    </button>
  );
  return (
    <section class="chair-trials" aria-labelledby="chair-trials-head">
      <header>
        <h2 id="chair-trials-head">{title}</h2>
        <span class="row">
          {choice('trials', byTrial)}
          {choice('targets', byTargets)}
        </span>
      </header>
      {/* This part scrolls, also by keyboard; the page must not. */}
      <div class="chair-trials-body" tabIndex={0} role="group" aria-labelledby="chair-trials-head">
        {trials.length === 0 ? <p class="empty">{none}</p> : view === 'trials' ? <TrialTable protocol={protocol} trials={trials} /> : <TargetTable protocol={protocol} trials={trials} />}
      </div>
    </section>
  );
};
