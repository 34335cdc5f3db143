// SPDX-License-Identifier: Apache-2.0
// Buttons and keys of the therapist: start and tare between sessions, one key per step during a session.
import type { Signal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';

import type { SessionInfo } from '../../generated/dts/v1/control_pb';
import { TrialAction } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { isOpenEnded } from '../../parts/active';
import type { Commands } from '../../parts/controls';
import { Button, CommandNotice, useCommands, whyNotOperate } from '../../parts/controls';
import { useKeys } from '../../parts/keys';
import { LastSession } from '../../parts/last_session';
import { clockTime } from '../../parts/numbers';
import { lastOutcome } from '../../parts/outcomes';
import { StopButton, useSessionStop } from '../../parts/stop_button';
import { UndoLine } from '../../parts/undo_line';
import { strings } from '../../strings';
import type { Examination } from './examination';

const words = strings.chair.controls;

interface ControlsProps {
  link: Link;
  rig: string;
  session: SessionInfo;
  examination: Examination;
  /** More notices. */
  children: ComponentChildren;
}

/** A marker belongs to this instant, so it has its own commands and never waits for another one. */
const Marking = ({ link, rig, commands, markedAt }: { link: Link; rig: string; commands: Commands; markedAt: Signal<number> }): JSX.Element => {
  const whyNot = whyNotOperate(link);
  const mark = async (): Promise<void> => {
    if (whyNot !== '') return;
    const done = await commands.run({ case: 'mark', value: { rig, text: words.markText } });
    if (done !== undefined) markedAt.value = Date.now();
  };
  useKeys({ ' ': () => void mark() });
  return <Button label={words.mark} keyName={words.spaceKey} onClick={() => void mark()} whyNot={whyNot} testId="mark" isReasonNearby mayRepeat />;
};

/** During a session. */
export const TrialControls = ({ link, rig, session, examination, children }: ControlsProps): JSX.Element => {
  const commands = useCommands(link);
  const marking = useCommands(link, true);
  const stopping = useCommands(link); // its own, so that a stop never waits for another command
  const stop = useSessionStop(link, rig, session.sessionId, stopping);
  const markedAt = useSignal(0);
  const { step, trial } = examination;
  const outcome = session.trial === undefined ? undefined : lastOutcome(session.trial);
  const isDuringTrial = step === 'ready' || step === 'go' || step === 'back';
  const whyNot = whyNotOperate(link) || (step === 'free' ? words.noTrials : '');
  const canEnd = session.trial !== undefined && isOpenEnded(session.trial);
  const whyNotNext = whyNot || (step === 'finished' ? words.allDone : isDuringTrial && !canEnd ? words.duringTrial : '');
  const isVoid = !isDuringTrial && outcome === 'rejected';
  const whyNotVoid = whyNot || (trial === 0 ? words.needsTrial : isVoid ? words.alreadyVoid : '');
  const act = (action: TrialAction): void => {
    if (!stop.flush()) void commands.run({ case: 'trial', value: { rig, action } });
  };
  const next = (): void => act(TrialAction.NEXT);
  const redo = (): void => act(TrialAction.REDO);
  const reject = (): void => act(TrialAction.REJECT);
  useKeys({
    a: () => whyNotNext === '' && next(),
    r: () => whyNotVoid === '' && redo(),
    x: () => whyNotVoid === '' && reject(),
  });
  const start = canEnd ? strings.common.endTrial : trial === 0 ? words.first : outcome === undefined || outcome === 'done' ? words.next : words.startNext;
  return (
    <div class="chair-controls">
      <div class="row">
        <Button label={start} keyName="A" kind="main" onClick={next} whyNot={whyNotNext} testId="trial-next" isReasonNearby />
        <Button label={words.redo} keyName="R" onClick={redo} whyNot={whyNotVoid} testId="trial-redo" isReasonNearby />
        <Button label={words.reject} keyName="X" onClick={reject} whyNot={whyNotVoid} testId="trial-reject" isReasonNearby />
        <StopButton stop={stop} label={words.stop} whyNot={whyNotOperate(link)} />
        <Marking link={link} rig={rig} commands={marking} markedAt={markedAt} />
        <UndoLine link={link} rig={rig} trial={session.trial} stop={stop} commands={commands}>
          <span class="chair-marked" role="status" data-testid="marked">
            {markedAt.value > 0 && words.marked(clockTime(markedAt.value))}
          </span>
        </UndoLine>
      </div>
      <p class="why-not why-not-line">{whyNotNext}</p>
      {children}
      <CommandNotice commands={commands} testId="command-error" />
      <CommandNotice commands={marking} testId="mark-error" />
      <CommandNotice commands={stopping} testId="stop-error" />
    </div>
  );
};

interface StartProps {
  link: Link;
  rig: string;
  session: SessionInfo | undefined;
  onStart: () => void;
}

/** Between sessions: start a session, or tare the empty chair. */
export const StartControls = ({ link, rig, session, onStart }: StartProps): JSX.Element => {
  const commands = useCommands(link);
  const isTared = useSignal(false);
  const whyNot = whyNotOperate(link);
  const tare = async (): Promise<void> => {
    isTared.value = (await commands.run({ case: 'tare', value: { rig } })) !== undefined;
  };
  return (
    <div class="chair-controls">
      <div class="row">
        <Button label={words.start} kind="main" onClick={onStart} whyNot={whyNot} testId="open-start" isReasonNearby />
        <Button label={words.tare} onClick={() => void tare()} whyNot={whyNot} testId="tare" isReasonNearby />
        <LastSession session={session} />
        <span class="chair-marked" role="status" data-testid="tared">
          {isTared.value && words.tared}
        </span>
      </div>
      <p class="why-not why-not-line">{whyNot}</p>
      <CommandNotice commands={commands} testId="command-error" />
    </div>
  );
};
