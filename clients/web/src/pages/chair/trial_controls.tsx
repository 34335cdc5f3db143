// SPDX-License-Identifier: Apache-2.0
// Buttons and keys of the therapist: start and tare between sessions, one key per step during a session.
import { useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';

import { TrialAction } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import type { Commands } from '../../parts/controls';
import { Button, CommandNotice, useCommands, whyNotOperate } from '../../parts/controls';
import { useKeys } from '../../parts/keys';
import { clockTime } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Examination } from './examination';

const words = strings.chair.controls;

interface ControlsProps {
  link: Link;
  rig: string;
  examination: Examination;
  /** More notices. */
  children: ComponentChildren;
}

/** A marker belongs to this instant, so it has its own commands and never waits for another one. */
const Marking = ({ link, rig, commands }: { link: Link; rig: string; commands: Commands }): JSX.Element => {
  const markedAt = useSignal(0);
  const whyNot = whyNotOperate(link);
  const mark = async (): Promise<void> => {
    if (whyNot !== '') return;
    const done = await commands.run({ case: 'mark', value: { rig, text: words.markText } });
    if (done !== undefined) markedAt.value = Date.now();
  };
  useKeys({ ' ': () => void mark() });
  return (
    <>
      <Button label={words.mark} keyName={words.spaceKey} onClick={() => void mark()} whyNot={whyNot} testId="mark" />
      <span class="chair-marked" role="status" data-testid="marked">
        {markedAt.value > 0 && words.marked(clockTime(markedAt.value))}
      </span>
    </>
  );
};

/** During a session. */
export const TrialControls = ({ link, rig, examination, children }: ControlsProps): JSX.Element => {
  const commands = useCommands(link);
  const marking = useCommands(link);
  const { step, trial } = examination;
  const isDuringTrial = step === 'ready' || step === 'go' || step === 'back';
  const whyNot = whyNotOperate(link) || (step === 'free' ? words.noTrials : '');
  const whyNotNext = whyNot || (step === 'finished' ? words.allDone : isDuringTrial ? words.duringTrial : '');
  const whyNotVoid = whyNot || (trial === 0 ? words.needsTrial : '');
  const act = (action: TrialAction): void => void commands.run({ case: 'trial', value: { rig, action } });
  const next = (): void => act(TrialAction.NEXT);
  const redo = (): void => act(TrialAction.REDO);
  const reject = (): void => act(TrialAction.REJECT);
  const stop = (): void => void commands.run({ case: 'stopSession', value: { rig } });
  useKeys({
    a: () => whyNotNext === '' && next(),
    r: () => whyNotVoid === '' && redo(),
    x: () => whyNotVoid === '' && reject(),
  });
  return (
    <div class="chair-controls">
      <div class="row">
        <Button label={trial === 0 ? words.first : words.next} keyName="A" kind="main" onClick={next} whyNot={whyNotNext} testId="trial-next" />
        <Button label={words.redo} keyName="R" onClick={redo} whyNot={whyNotVoid} testId="trial-redo" />
        <Button label={words.reject} keyName="X" onClick={reject} whyNot={whyNotVoid} testId="trial-reject" />
        <Button label={words.stop} kind="danger" onClick={stop} whyNot={whyNotOperate(link)} testId="stop-session" />
        <Marking link={link} rig={rig} commands={marking} />
      </div>
      <div class="chair-notices">
        {children}
        <CommandNotice commands={commands} testId="command-error" />
        <CommandNotice commands={marking} testId="mark-error" />
      </div>
    </div>
  );
};

/** Between sessions: start a session, or tare the empty chair. */
export const StartControls = ({ link, rig, onStart }: { link: Link; rig: string; onStart: () => void }): JSX.Element => {
  const commands = useCommands(link);
  const isTared = useSignal(false);
  const whyNot = whyNotOperate(link);
  const tare = async (): Promise<void> => {
    isTared.value = (await commands.run({ case: 'tare', value: { rig } })) !== undefined;
  };
  return (
    <div class="chair-controls">
      <div class="row">
        <Button label={words.start} kind="main" onClick={onStart} whyNot={whyNot} testId="open-start" />
        <Button label={words.tare} onClick={() => void tare()} whyNot={whyNot} testId="tare" />
        <span class="chair-marked" role="status" data-testid="tared">
          {isTared.value && words.tared}
        </span>
      </div>
      <div class="chair-notices">
        <CommandNotice commands={commands} testId="command-error" />
      </div>
    </div>
  );
};
