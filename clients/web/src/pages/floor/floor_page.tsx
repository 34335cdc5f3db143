// SPDX-License-Identifier: Apache-2.0
// Live floor: the plate with the centre of pressure, what to do now, and steadiness.
import type { JSX } from 'preact';
import { useEffect, useMemo } from 'preact/hooks';

import type { RigStatus } from '../../generated/dts/v1/control_pb';
import type { ProtocolInfo, TrialStatus } from '../../generated/dts/v1/sessions_pb';
import { TrialPhase } from '../../generated/dts/v1/sessions_pb';
import { SessionState } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { CommandNotice, Notice, Tile, useCommands } from '../../parts/controls';
import { Live, useIsOld } from '../../parts/live';
import { capitalised, protocolName, spoken } from '../../parts/names';
import { fixed, whole } from '../../parts/numbers';
import { useStartForm } from '../../parts/start_form';
import { StartSession, StartTaken, useProtocols } from '../../parts/start_session';
import { strings } from '../../strings';
import { Countdown } from './countdown';
import './floor.css';
import { guidanceOf } from './guidance';
import { LiveFloor } from './live_floor';
import { Plate } from './plate';
import { useRecalled } from './recall';
import { Remarks } from './remarks';
import { Series } from './series';
import { isActive, SessionControls } from './session_controls';
import { SwayTiles } from './sway_tiles';

const words = strings.floor;

const Guidance = ({ link, status, floor }: { link: Link; status: RigStatus; floor: LiveFloor }): JSX.Element => {
  const rig = status.rig!;
  const isOld = useIsOld(link, rig.name).value;
  const { mlMm, apMm, quality } = floor.now.value;
  const trial = status.session?.trial;
  const state = guidanceOf({
    isOld,
    quality,
    distanceMm: Math.hypot(mlMm, apMm),
    plateMm: Math.min(rig.plateAMm, rig.plateBMm),
    session: status.session?.state ?? SessionState.IDLE,
    phase: trial?.phase ?? TrialPhase.UNSPECIFIED,
    trial: trial?.trial ?? 0,
  });
  const [what, hint] = state === 'first' ? words.firstTrial(spoken(trial?.nextCondition ?? '')) : words.guidance[state];
  const next = state === 'done' && trial?.nextCondition ? words.next(spoken(trial.nextCondition)) : '';
  return (
    <div class={`guidance guidance-${state}`} role="status" aria-live="polite" data-testid="guidance" data-state={state}>
      <strong>{what}</strong> <span>{hint}</span> <span>{next}</span>
    </div>
  );
};

const trialTitle = ({ trial, of, condition }: TrialStatus): string =>
  trial === 0 ? words.readyForTrial(whole(1), whole(of)) : words.trialOf(capitalised(spoken(condition)), whole(trial), whole(of));

const TrialHead = ({ status }: { status: RigStatus }): JSX.Element => {
  const { session } = status;
  if (!isActive(session)) return <h1 data-testid="trial-head">{words.noSession}</h1>;
  const { trial } = session;
  const protocol = protocolName(session.protocol);
  const title = trial === undefined ? protocol : trialTitle(trial);
  const attempt = trial !== undefined && trial.attempt > 1 ? words.attempt(whole(trial.attempt)) : '';
  return (
    <div>
      <h1 data-testid="trial-head">{title}</h1>
      <p class="session-line" data-testid="session-id">
        {[title === protocol ? '' : protocol, session.subject, session.label, attempt].filter((part) => part !== '').join(' · ')}
      </p>
    </div>
  );
};

/** The load, to check that a person stands on the plate. */
const Load = ({ floor }: { floor: LiveFloor }): JSX.Element => (
  <Tile label={words.load} value={fixed(floor.now.value.loadKg, 0)} unit="kg" testId="load-kg" />
);

interface SideProps {
  link: Link;
  status: RigStatus;
  floor: LiveFloor;
  protocols: readonly ProtocolInfo[];
}

const Side = ({ link, status, floor, protocols }: SideProps): JSX.Element => {
  const isOld = useIsOld(link, status.rig!.name).value;
  const { session } = status;
  const form = useStartForm(isActive(session));
  const commands = useCommands(link);
  const marking = useCommands(link);
  useRecalled(link, floor, session);
  if (form.isShown) {
    return (
      <div class="floor-side">
        <StartSession link={link} rig={status.rig!.name} protocols={protocols} form={form} />
      </div>
    );
  }
  return (
    <div class={`floor-side${isOld ? ' floor-side-old' : ''}`}>
      <div class={`floor-head${isActive(session) ? ' floor-head-session' : ''}`}>
        <TrialHead status={status} />
        {isActive(session) && <Countdown link={link} session={session} />}
      </div>
      <SwayTiles floor={floor}>
        <Load floor={floor} />
      </SwayTiles>
      <SessionControls link={link} status={status} commands={commands} marking={marking} onStart={form.open} />
      <div class="floor-notices">
        <Remarks floor={floor} status={status} />
        <StartTaken form={form} protocol={session?.protocol ?? ''} />
        <CommandNotice commands={commands} testId="command-error" />
        <CommandNotice commands={marking} testId="mark-error" />
      </div>
    </div>
  );
};

const Floor = ({ link, status }: { link: Link; status: RigStatus }): JSX.Element | null => {
  const rig = status.rig!;
  const floor = useMemo(() => new LiveFloor(link, rig.name), [link, rig.name]);
  useEffect(() => () => floor.close(), [floor]);
  const protocols = useProtocols(link).value;
  return (
    <div class="floor">
      <div class="floor-pictures">
        <Guidance link={link} status={status} floor={floor} />
        <Live link={link} rig={rig.name}>
          <div class="floor-live">
            <Plate link={link} rig={rig} floor={floor} />
            <Series link={link} floor={floor} />
          </div>
        </Live>
      </div>
      <Side link={link} status={status} floor={floor} protocols={protocols} />
    </div>
  );
};

/** `rigName`: the platform that the address "#/floor/NAME" names, if there are several. */
export const FloorPage = ({ link, rigName }: { link: Link; rigName: string | undefined }): JSX.Element => {
  const status = link.status.value;
  if (status === undefined) return <p class="empty">{words.waiting}</p>;
  const platforms = status.rigs.filter(({ rig }) => rig?.kind === 'floor');
  const shown = platforms.find(({ rig }) => rig!.name === rigName) ?? platforms[0];
  if (shown === undefined) return <Notice kind="plain" what={words.noRig} hint={words.noRigHint} testId="no-rig" />;
  return (
    <>
      {platforms.length > 1 && (
        <nav class="row" aria-label={words.rigs}>
          {platforms.map(({ rig }) => (
            <a key={rig!.name} class="tab" href={`#/floor/${encodeURIComponent(rig!.name)}`} aria-current={rig === shown.rig ? 'page' : undefined}>
              {rig!.name}
            </a>
          ))}
        </nav>
      )}
      <Floor key={shown.rig!.name} link={link} status={shown} />
    </>
  );
};
