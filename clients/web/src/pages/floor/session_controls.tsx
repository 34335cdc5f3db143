// SPDX-License-Identifier: Apache-2.0
// Tare, start, stop, the steps of trials, and markers. Everybody sees the buttons; a user without the role reads why they are disabled.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import type { RigStatus, SessionInfo } from '../../generated/dts/v1/control_pb';
import type { TrialStatus } from '../../generated/dts/v1/sessions_pb';
import { TrialAction, TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { DeviceState } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { isActive, isOpenEnded } from '../../parts/active';
import type { Commands } from '../../parts/controls';
import { Button, CommandNotice, Notice, useCommands, whyNotOperate } from '../../parts/controls';
import { useKeys } from '../../parts/keys';
import { LastSession } from '../../parts/last_session';
import { whole } from '../../parts/numbers';
import { lastOutcome } from '../../parts/outcomes';
import { StopButton, useSessionStop } from '../../parts/stop_button';
import { UndoLine } from '../../parts/undo_line';
import { strings } from '../../strings';

const words = strings.floor.controls;

interface MarkingProps {
  rig: string;
  commands: Commands;
  whyNot: string;
  onMarked: (text: string) => void;
}

const Marking = ({ rig, commands, whyNot, onMarked }: MarkingProps): JSX.Element => {
  const text = useSignal<string>(words.markDefault);
  const mark = async (): Promise<void> => {
    if (whyNot !== '') return;
    const marked = text.value.trim() || words.markDefault;
    const answer = await commands.run({ case: 'mark', value: { text: marked, rig } });
    if (answer?.case === 'mark') onMarked(words.marked(marked, whole(answer.value.marks[0]?.scan)));
  };
  useKeys({ ' ': () => void mark() });
  return (
    <div class="marking">
      <input
        aria-label={words.markText}
        title={strings.common.markHint}
        data-testid="mark-text"
        maxLength={50}
        value={text.value}
        onInput={(event) => (text.value = event.currentTarget.value)}
      />
      <Button label={words.mark} keyName={words.spaceKey} testId="mark" onClick={() => void mark()} whyNot={whyNot} isReasonNearby mayRepeat />
    </div>
  );
};

const TrialButtons = (props: { trial: TrialStatus; whyNot: string; act: (action: TrialAction) => void }): JSX.Element => {
  const { trial } = props;
  const outcome = lastOutcome(trial);
  const isWaiting = trial.phase === TrialPhase.WAITING || trial.phase === TrialPhase.RESTING;
  const isOver = isWaiting || trial.phase === TrialPhase.FINISHED;
  const canEnd = isOpenEnded(trial);
  const whyNotNext = props.whyNot || (isWaiting || canEnd ? '' : isOver ? words.allDone : words.duringTrial);
  const isVoid = isOver && outcome === 'rejected';
  const whyNotVoid = props.whyNot || (trial.trial === 0 ? words.noTrialYet : isVoid ? words.alreadyVoid : '');
  const next = (): void => props.act(TrialAction.NEXT);
  const redo = (): void => props.act(TrialAction.REDO);
  const reject = (): void => props.act(TrialAction.REJECT);
  useKeys({
    a: () => whyNotNext === '' && next(),
    r: () => whyNotVoid === '' && redo(),
    x: () => whyNotVoid === '' && reject(),
  });
  const isReasonNearby = true; // one line below the buttons: nothing moves when a reason appears
  const start = canEnd ? strings.common.endTrial : outcome === undefined ? words.startTrial : outcome === 'done' ? words.accept : words.startNext;
  return (
    <>
      <Button label={start} keyName="A" kind="main" testId="trial-next" onClick={next} whyNot={whyNotNext} isReasonNearby={isReasonNearby} />
      <Button label={words.redo} keyName="R" testId="trial-redo" onClick={redo} whyNot={whyNotVoid} isReasonNearby={isReasonNearby} />
      <Button label={words.reject} keyName="X" testId="trial-reject" onClick={reject} whyNot={whyNotVoid} isReasonNearby={isReasonNearby} />
    </>
  );
};

/** Returns why the main button is disabled, for the line below the buttons. */
const reasonOf = (trial: TrialStatus | undefined): string => {
  if (trial === undefined || trial.phase === TrialPhase.WAITING || trial.phase === TrialPhase.RESTING || isOpenEnded(trial)) return '';
  return trial.phase === TrialPhase.FINISHED ? words.allDone : words.duringTrial;
};

interface DuringProps {
  link: Link;
  rig: string;
  session: SessionInfo;
  commands: Commands;
  marking: Commands;
}

const DuringSession = ({ link, rig, session, commands, marking }: DuringProps): JSX.Element => {
  const whyNot = whyNotOperate(link);
  const marked = useSignal('');
  const stopping = useCommands(link); // its own, so that a stop never waits for another command
  const stop = useSessionStop(link, rig, session.sessionId, stopping);
  const { trial } = session;
  const act = (action: TrialAction): void => {
    if (!stop.flush()) void commands.run({ case: 'trial', value: { rig, action } });
  };
  const reason = whyNot || reasonOf(trial);
  return (
    <>
      <div class="row">
        {trial !== undefined && <TrialButtons trial={trial} whyNot={whyNot} act={act} />}
        <StopButton stop={stop} label={words.stop} whyNot={whyNot} />
      </div>
      <UndoLine link={link} rig={rig} trial={trial} stop={stop} commands={commands}>
        <span class="why-not">{reason}</span>
        <span role="status" class="marked" data-testid="marked">
          {marked.value || (reason === '' ? strings.common.markHint : '')}
        </span>
      </UndoLine>
      <Marking rig={rig} commands={marking} whyNot={whyNot} onMarked={(text) => (marked.value = text)} />
      <CommandNotice commands={stopping} testId="stop-error" />
    </>
  );
};

const BetweenSessions = (props: { link: Link; status: RigStatus; commands: Commands; onStart: () => void }): JSX.Element => {
  const tared = useSignal('');
  const rig = props.status.rig?.name ?? '';
  const whyNot = whyNotOperate(props.link) || (props.status.device === DeviceState.STREAMING ? '' : words.needsDevice);
  const tare = async (): Promise<void> => {
    tared.value = '';
    if ((await props.commands.run({ case: 'tare', value: { rig } })) !== undefined) tared.value = words.tareDone;
  };
  return (
    <>
      <div class="row">
        <Button label={words.start} kind="main" testId="open-start" onClick={props.onStart} whyNot={whyNot} isReasonNearby />
        <Button label={words.tare} testId="tare" onClick={() => void tare()} whyNot={whyNot} isReasonNearby />
        <LastSession session={props.status.session} />
      </div>
      {whyNot !== '' && <p class="why-not">{whyNot}</p>}
      {tared.value !== '' && <Notice kind="good" what={tared.value} testId="tared" onDismiss={() => (tared.value = '')} />}
    </>
  );
};

interface SessionControlsProps {
  link: Link;
  status: RigStatus;
  commands: Commands;
  /** Separate from `commands`: a marker belongs to this instant and must not wait for another command. */
  marking: Commands;
  onStart: () => void;
}

/** The page that uses these controls shows the errors of `commands` and `marking`. */
export const SessionControls = ({ link, status, commands, marking, onStart }: SessionControlsProps): JSX.Element => {
  const { session } = status;
  return (
    <section class="column" data-testid="controls" aria-busy={commands.isBusy.value}>
      {isActive(session) ? (
        <DuringSession key={session.sessionId} link={link} rig={status.rig?.name ?? ''} session={session} commands={commands} marking={marking} />
      ) : (
        <BetweenSessions link={link} status={status} commands={commands} onStart={onStart} />
      )}
    </section>
  );
};
