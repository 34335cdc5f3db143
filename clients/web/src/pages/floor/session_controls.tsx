// SPDX-License-Identifier: Apache-2.0
// Tare, start, stop, the steps of trials, and markers. Everybody sees the buttons; a user without the role reads why they are disabled.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import type { RigStatus, SessionInfo } from '../../generated/dts/v1/control_pb';
import { TrialAction, TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { DeviceState, SessionState } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import type { Commands } from '../../parts/controls';
import { Button, Notice, whyNotOperate } from '../../parts/controls';
import { useKeys } from '../../parts/keys';
import { whole } from '../../parts/numbers';
import { strings } from '../../strings';

const words = strings.floor.controls;

const atRest = new Set([SessionState.UNSPECIFIED, SessionState.IDLE, SessionState.FAILED]);

/** Returns whether a session runs. A failed one does not: there is nothing to stop, and another can be started. */
export const isActive = (session: SessionInfo | undefined): session is SessionInfo => session !== undefined && !atRest.has(session.state);

const Marking = ({ rig, commands, whyNot }: { rig: string; commands: Commands; whyNot: string }): JSX.Element => {
  const text = useSignal<string>(words.markDefault);
  const done = useSignal('');
  const mark = async (): Promise<void> => {
    if (whyNot !== '') return;
    const marked = text.value.trim() || words.markDefault;
    const answer = await commands.run({ case: 'mark', value: { text: marked, rig } });
    if (answer?.case === 'mark') done.value = words.marked(marked, whole(answer.value.marks[0]?.scan));
  };
  useKeys({ ' ': () => void mark() });
  return (
    <div class="column">
      <div class="marking">
        <input
          aria-label={words.markText}
          data-testid="mark-text"
          maxLength={50}
          value={text.value}
          onInput={(event) => (text.value = event.currentTarget.value)}
        />
        <Button label={words.mark} keyName={words.spaceKey} testId="mark" onClick={() => void mark()} whyNot={whyNot} isReasonNearby />
      </div>
      <span role="status" class="marked" data-testid="marked">
        {done.value}
      </span>
    </div>
  );
};

const TrialButtons = (props: { session: SessionInfo; whyNot: string; act: (action: TrialAction) => void }): JSX.Element => {
  const trial = props.session.trial!;
  const isWaiting = trial.phase === TrialPhase.WAITING || trial.phase === TrialPhase.RESTING;
  const whyNotNext = props.whyNot || (isWaiting ? '' : trial.phase === TrialPhase.FINISHED ? words.allDone : words.duringTrial);
  const whyNotVoid = props.whyNot || (trial.trial === 0 ? words.noTrialYet : '');
  const next = (): void => props.act(TrialAction.NEXT);
  const redo = (): void => props.act(TrialAction.REDO);
  const reject = (): void => props.act(TrialAction.REJECT);
  useKeys({
    a: () => whyNotNext === '' && next(),
    r: () => whyNotVoid === '' && redo(),
    x: () => whyNotVoid === '' && reject(),
  });
  const isReasonNearby = props.whyNot !== '';
  const start = trial.trial === 0 ? words.startTrial : words.accept;
  return (
    <>
      <Button label={start} keyName="A" kind="main" testId="trial-next" onClick={next} whyNot={whyNotNext} isReasonNearby={isReasonNearby} />
      <Button label={words.redo} keyName="R" testId="trial-redo" onClick={redo} whyNot={whyNotVoid} isReasonNearby={isReasonNearby} />
      <Button label={words.reject} keyName="X" testId="trial-reject" onClick={reject} whyNot={whyNotVoid} isReasonNearby={isReasonNearby} />
    </>
  );
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
  const stop = (): void => void commands.run({ case: 'stopSession', value: { rig } });
  const act = (action: TrialAction): void => void commands.run({ case: 'trial', value: { rig, action } });
  return (
    <>
      <div class="row">
        {session.trial !== undefined && <TrialButtons session={session} whyNot={whyNot} act={act} />}
        <Button label={words.stop} kind="danger" testId="stop-session" onClick={stop} whyNot={whyNot} isReasonNearby />
      </div>
      {whyNot !== '' && <p class="why-not">{whyNot}</p>}
      <Marking rig={rig} commands={marking} whyNot={whyNot} />
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
        <DuringSession link={link} rig={status.rig?.name ?? ''} session={session} commands={commands} marking={marking} />
      ) : (
        <BetweenSessions link={link} status={status} commands={commands} onStart={onStart} />
      )}
    </section>
  );
};
