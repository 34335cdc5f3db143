// SPDX-License-Identifier: Apache-2.0
// What the subject should do now, readable from two metres, and the target.
import type { ReadonlySignal } from '@preact/signals';
import type { JSX } from 'preact';

import { fixed, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Examination } from './examination';
import { targetPercent } from './examination';

interface Target {
  condition: string;
  cm: number;
}

/** Returns the target to show: during a wait or rest it is the next one, which has to be placed. */
const targetOf = (examination: Examination): Target => {
  const isNext = examination.step === 'waiting' || examination.step === 'resting';
  return isNext && examination.nextCondition !== ''
    ? { condition: examination.nextCondition, cm: examination.nextTargetCm }
    : { condition: examination.condition, cm: examination.targetCm };
};

const TargetLine = ({ examination }: { examination: Examination }): JSX.Element => {
  const { target, nextTarget, ofArm } = strings.chair.prompt;
  const { condition, cm } = targetOf(examination);
  const share = targetPercent(examination, cm);
  const isNext = examination.step === 'waiting' || examination.step === 'resting';
  const isNamed = share === undefined || whole(share) !== condition;
  return (
    <div class="chair-target">
      <span class="chair-label">{isNext ? nextTarget : target}</span>
      <span class="chair-target-value" data-testid="target">
        {isNamed && condition !== '' && <span>{condition}</span>}
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

/** `restS`: whole seconds of rest left. */
export const Prompt = ({ examination, restS }: { examination: Examination; restS: ReadonlySignal<number> }): JSX.Element => {
  const { words, hints, readyForTrial, trialOf, attempt, rest } = strings.chair.prompt;
  const { step, trial, of } = examination;
  return (
    <section class={`chair-prompt chair-prompt-${step}`} aria-labelledby="chair-prompt-head">
      <h2 id="chair-prompt-head" class="visually-hidden">
        {strings.chair.prompt.head}
      </h2>
      <div class="chair-prompt-word" data-testid="prompt" data-step={step} aria-live="assertive">
        {words[step]}
      </div>
      {step === 'free' ? (
        <p>{hints.free}</p>
      ) : (
        <>
          <TargetLine examination={examination} />
          <div class="chair-counter" data-testid="trial-counter">
            {trial === 0 ? readyForTrial(whole(1), whole(of)) : trialOf(whole(trial), whole(of))}
            {examination.attempt > 1 && `, ${attempt(whole(examination.attempt))}`}
          </div>
          <p class="chair-sentence" data-testid="prompt-hint">
            {step === 'resting' && restS.value > 0 ? rest(whole(restS.value)) : hints[step]}
          </p>
        </>
      )}
    </section>
  );
};
