// SPDX-License-Identifier: Apache-2.0
// What the subject should do now, readable from two metres, and the target.
import type { ReadonlySignal } from '@preact/signals';
import type { JSX } from 'preact';

import type { SessionInfo } from '../../generated/dts/v1/control_pb';
import type { TrialStatus } from '../../generated/dts/v1/sessions_pb';
import { conditionName } from '../../parts/names';
import { fixed, whole } from '../../parts/numbers';
import { lastOutcome, outcomeShape } from '../../parts/outcomes';
import { strings } from '../../strings';
import type { Examination } from './examination';
import { targetPercent } from './examination';

interface Target {
  condition: string;
  cm: number;
  percent: number | undefined;
}

const between = new Set(['waiting', 'resting', 'finished']);

/** Returns the target to show: during a wait or rest it is the next one, which has to be placed. */
const targetOf = (examination: Examination, present: TrialStatus | undefined): Target => {
  const isNext = examination.step === 'waiting' || examination.step === 'resting';
  if (isNext && examination.nextCondition !== '') {
    const { nextCondition: condition, nextTargetCm: cm } = examination;
    return { condition, cm, percent: (present?.nextTargetCm === cm ? present.nextTargetPercent : undefined) ?? targetPercent(examination, cm) };
  }
  const { condition, targetCm: cm } = examination;
  const isPresent = present?.trial === examination.trial && present.attempt === examination.attempt;
  return { condition, cm, percent: (isPresent ? present.targetPercent : undefined) ?? targetPercent(examination, cm) };
};

const TargetLine = ({ examination, session }: { examination: Examination; session: SessionInfo | undefined }): JSX.Element => {
  const { target, nextTarget, ofArm } = strings.chair.prompt;
  const { condition, cm, percent: share } = targetOf(examination, session?.trial);
  const isNext = examination.step === 'waiting' || examination.step === 'resting';
  const isNamed = share === undefined || whole(Math.round(share)) !== condition;
  return (
    <div class="chair-target">
      <span class="chair-label">{isNext ? nextTarget : target}</span>
      <span class="chair-target-value" data-testid="target">
        {isNamed && condition !== '' && <span class="chair-target-name">{conditionName(session?.protocol ?? '', condition)}</span>}
        {share !== undefined && (
          <span>
            {whole(Math.round(share))}
            <span class="unit"> {ofArm}</span>
          </span>
        )}
        {cm > 0 && (
          <span>
            {fixed(cm, 1)}
            <span class="unit"> cm</span>
          </span>
        )}
      </span>
    </div>
  );
};

interface PromptProps {
  examination: Examination;
  session: SessionInfo | undefined;
  /** Whole seconds of rest left. */
  restS: ReadonlySignal<number>;
  /** False at a centre: nobody there can follow a hint. */
  isGuiding: boolean;
  /** No data: what the subject should do is not known. */
  isOld: boolean;
}

export const Prompt = ({ examination, session, restS, isGuiding, isOld }: PromptProps): JSX.Element => {
  const { words, hints, readyForTrial, trialOf, attempt, rest } = strings.chair.prompt;
  const { step, trial, of } = examination;
  const next = session?.trial?.nextTrial ?? 0;
  const outcome = session?.trial === undefined || !between.has(step) ? undefined : lastOutcome(session.trial);
  return (
    <section class={`chair-prompt chair-prompt-${step}`} aria-labelledby="chair-prompt-head">
      <h2 id="chair-prompt-head" class="visually-hidden">
        {strings.chair.prompt.head}
      </h2>
      <div class="chair-prompt-word" data-testid="prompt" data-step={step} aria-live="assertive">
        {isOld ? strings.common.data.noData : words[step]}
      </div>
      {step === 'free' ? (
        <p>{isGuiding ? hints.free : hints.freeElsewhere}</p>
      ) : (
        <>
          <TargetLine examination={examination} session={session} />
          <div class="chair-counter" data-testid="trial-counter">
            {trial > 0 ? trialOf(whole(trial), whole(of)) : next > 0 && readyForTrial(whole(next), whole(of))}
            {examination.attempt > 1 && `, ${attempt(whole(examination.attempt))}`}
          </div>
          {outcome !== undefined && (
            <p class={`outcome outcome-${outcome}`} role="status" data-testid="trial-outcome" data-outcome={outcome}>
              <span aria-hidden="true">{outcomeShape(outcome)}</span> {strings.common.trialEnded[outcome](whole(session?.trial?.lastTrial))}
            </p>
          )}
          {isGuiding && !isOld && (
            <p class="chair-sentence" data-testid="prompt-hint">
              {step === 'resting' && restS.value > 0
                ? rest(whole(restS.value))
                : step === 'finished' && outcome === 'rejected'
                  ? strings.common.endedLast
                  : hints[step]}
            </p>
          )}
        </>
      )}
    </section>
  );
};
