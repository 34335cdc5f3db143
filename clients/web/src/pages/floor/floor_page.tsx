// SPDX-License-Identifier: Apache-2.0
// Live floor: the plate with the centre of pressure, what to do now, and steadiness.
import type { JSX } from 'preact';
import { useEffect, useMemo } from 'preact/hooks';

import type { RigStatus, SessionInfo } from '../../generated/dts/v1/control_pb';
import type { TrialRecord, TrialStatus } from '../../generated/dts/v1/sessions_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { SessionState } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { isActive, isOpenEnded } from '../../parts/active';
import type { Commands } from '../../parts/controls';
import { CommandNotice, Tile, useCommands } from '../../parts/controls';
import { Live, useIsOld } from '../../parts/live';
import { conditionName, protocolName } from '../../parts/names';
import { fixed, whole } from '../../parts/numbers';
import { lastOutcome } from '../../parts/outcomes';
import { RigPage } from '../../parts/rig_page';
import type { StartForm } from '../../parts/start_form';
import { useStartForm } from '../../parts/start_form';
import { StartSession, StartTaken } from '../../parts/start_session';
import { strings } from '../../strings';
import { Countdown } from './countdown';
import './floor.css';
import type { GuidanceState } from './guidance';
import { guidanceOf, isEnded } from './guidance';
import { LiveFloor } from './live_floor';
import { Plate } from './plate';
import { useRecord } from './recall';
import { Remarks } from './remarks';
import { Series } from './series';
import { SessionControls } from './session_controls';
import { SwayTiles } from './sway_tiles';
import { TrialStrip } from './trial_strip';

const words = strings.floor;

/** Returns title and hint of a state. */
const guidanceWords = (state: GuidanceState, protocol: string, trial: TrialStatus | undefined): readonly [string, string] => {
  if (state === 'first') return words.firstTrial(conditionName(protocol, trial?.nextCondition ?? ''));
  if (state === 'measuring' && trial !== undefined && isOpenEnded(trial)) return [words.guidance.measuring[0]!, words.measuringOpen];
  if (!isEnded(state)) return words.guidance[state] as [string, string];
  const isLast = trial?.phase === TrialPhase.FINISHED;
  const hint = !isLast ? words.ended[state] : state === 'rejected' ? strings.common.endedLast : `${words.ended[state]} ${strings.common.endedLast}`;
  return [strings.common.trialEnded[state](whole(trial?.lastTrial)), hint];
};

/** Returns what follows: the next condition after a trial, or which trial is repeated. */
const remarkOf = (state: GuidanceState, protocol: string, trial: TrialStatus | undefined): string => {
  if (trial === undefined) return '';
  if (isEnded(state) && trial.nextCondition !== '') return words.next(conditionName(protocol, trial.nextCondition));
  return trial.attempt > 1 && (state === 'ready' || state === 'settling') ? words.again(whole(trial.trial), whole(trial.attempt)) : '';
};

const Guidance = ({ link, status, floor }: { link: Link; status: RigStatus; floor: LiveFloor }): JSX.Element => {
  const rig = status.rig!;
  const isOld = useIsOld(link, rig.name).value;
  const { mlMm, apMm, quality } = floor.now.value;
  const protocol = status.session?.protocol ?? '';
  const trial = status.session?.trial;
  const outcome = trial === undefined ? undefined : lastOutcome(trial);
  const state = guidanceOf({
    isOld,
    quality,
    distanceMm: Math.hypot(mlMm, apMm),
    plateMm: Math.min(rig.plateAMm, rig.plateBMm),
    session: status.session?.state ?? SessionState.IDLE,
    phase: trial?.phase ?? TrialPhase.UNSPECIFIED,
    outcome,
  });
  const [what, hint] = guidanceWords(state, protocol, trial);
  return (
    <div class={`guidance guidance-${state}`} role="status" aria-live="polite" data-testid="guidance" data-state={state} data-outcome={outcome}>
      <strong>{what}</strong> <span>{link.me.value.isFleet ? '' : hint}</span> <span>{remarkOf(state, protocol, trial)}</span>
    </div>
  );
};

/** Returns the heading of a session with trials: the trial, or which one is next, or else the protocol. */
const trialTitle = (protocol: string, { trial, nextTrial, of, condition }: TrialStatus): string => {
  if (trial > 0) return words.trialOf(conditionName(protocol, condition), whole(trial), whole(of));
  return nextTrial > 0 ? words.readyForTrial(whole(nextTrial), whole(of)) : protocolName(protocol);
};

const TrialHead = ({ session, records }: { session: SessionInfo | undefined; records: readonly TrialRecord[] }): JSX.Element => {
  if (!isActive(session)) return <h1 data-testid="trial-head">{words.noSession}</h1>;
  const { trial } = session;
  const protocol = protocolName(session.protocol);
  const title = trial === undefined ? protocol : trialTitle(session.protocol, trial);
  const attempt = trial !== undefined && trial.attempt > 1 ? words.attempt(whole(trial.attempt)) : '';
  return (
    <div>
      <h1 data-testid="trial-head">{title}</h1>
      <p class="session-line" data-testid="session-id">
        {[title === protocol ? '' : protocol, session.subject, session.label, attempt].filter((part) => part !== '').join(' · ')}
      </p>
      {trial !== undefined && <TrialStrip trial={trial} records={records} />}
    </div>
  );
};

/** The load, to check that a person stands on the plate. Of a person on two feet it is exact only if the stance width is known. */
const Load = ({ floor, session }: { floor: LiveFloor; session: SessionInfo | undefined }): JSX.Element => {
  const isExact = isActive(session) && 'stance_width_mm' in session.fields;
  return <Tile label={isExact ? words.load : words.loadAbout} value={fixed(floor.now.value.loadKg, 0)} unit="kg" testId="load-kg" />;
};

interface SideProps {
  link: Link;
  status: RigStatus;
  floor: LiveFloor;
  form: StartForm;
  commands: Commands;
  marking: Commands;
}

const Side = ({ link, status, floor, form, commands, marking }: SideProps): JSX.Element => {
  const isOld = useIsOld(link, status.rig!.name).value;
  const { session } = status;
  const record = useRecord(link, floor, session).value.answer;
  if (form.isShown) {
    return (
      <div class="floor-side">
        <StartSession link={link} rig={status.rig!.name} form={form} />
      </div>
    );
  }
  return (
    <div class={`floor-side${isOld ? ' floor-side-old' : ''}`}>
      <div class={`floor-head${isActive(session) ? ' floor-head-session' : ''}`}>
        <TrialHead session={session} records={record?.sessionId === session?.sessionId ? (record?.trials ?? []) : []} />
        {isActive(session) && <Countdown link={link} session={session} />}
      </div>
      <SwayTiles floor={floor}>
        <Load floor={floor} session={session} />
      </SwayTiles>
      {!link.me.value.isFleet && <SessionControls link={link} status={status} commands={commands} marking={marking} onStart={form.open} />}
    </div>
  );
};

const Floor = ({ link, status }: { link: Link; status: RigStatus }): JSX.Element | null => {
  const rig = status.rig!;
  const { session } = status;
  const floor = useMemo(() => new LiveFloor(link, rig.name), [link, rig.name]);
  useEffect(() => () => floor.close(), [floor]);
  const form = useStartForm(isActive(session));
  const commands = useCommands(link);
  const marking = useCommands(link, true);
  return (
    <div class="floor">
      <div class="floor-pictures">
        <Guidance link={link} status={status} floor={floor} />
        <div class="floor-notices">
          <Remarks floor={floor} status={status} canRedo={!link.me.value.isFleet} />
          <StartTaken form={form} protocol={session?.protocol ?? ''} />
          <CommandNotice commands={commands} testId="command-error" />
          <CommandNotice commands={marking} testId="mark-error" />
        </div>
        <Live link={link} rig={rig.name}>
          <div class="floor-live">
            <Plate link={link} rig={rig} floor={floor} hasFeedback={isActive(session) && session.trial?.hasFeedback === true} />
            <Series link={link} floor={floor} />
          </div>
        </Live>
      </div>
      <Side link={link} status={status} floor={floor} form={form} commands={commands} marking={marking} />
    </div>
  );
};

/** `rigName`: of the address "#/floor/NAME". */
export const FloorPage = ({ link, rigName }: { link: Link; rigName: string | undefined }): JSX.Element => (
  <RigPage link={link} kind="floor" rigName={rigName}>
    {(status) => <Floor key={status.rig!.name} link={link} status={status} />}
  </RigPage>
);
