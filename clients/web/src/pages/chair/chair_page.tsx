// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { RigStatus } from '../../generated/dts/v1/control_pb';
import type { Link } from '../../link/types';
import { Live, useIsOld } from '../../parts/live';
import { PatientButton } from '../../parts/patient_button';
import { RigPage } from '../../parts/rig_page';
import { useStartForm } from '../../parts/start_form';
import { StartSession, StartTaken } from '../../parts/start_session';
import { strings } from '../../strings';
import './chair.css';
import { isRunning } from './examination';
import { useFollowed } from './follow';
import { Prompt } from './prompt';
import { Legend, TransientView } from './transient_view';
import { StartControls, TrialControls } from './trial_controls';
import { Trials } from './trial_tables';
import { AngleGauge, ClassResult } from './trunk_result';

const Chair = ({ link, status }: { link: Link; status: RigStatus }): JSX.Element => {
  const rig = status.rig!.name;
  const { session } = status;
  const { ring, ghosts, examination, trials, restS } = useFollowed(link, rig);
  const running = isRunning(status);
  const form = useStartForm(running);
  const isOld = useIsOld(link, rig).value;
  const shown = examination.value;
  const isGuiding = !link.me.value.isFleet; // nobody at a centre can follow a hint
  if (form.isShown) {
    return (
      <div class="chair-start">
        <StartSession link={link} rig={rig} form={form} />
      </div>
    );
  }
  return (
    <div class="chair">
      <h1 class="visually-hidden">{strings.chair.title}</h1>
      <div class="chair-transient">
        <div class="chair-head">
          <Legend />
          {isGuiding && <PatientButton rig={rig} />}
        </div>
        <Live link={link} rig={rig}>
          <TransientView link={link} ring={ring} ghosts={ghosts} examination={examination} isOld={isOld} />
        </Live>
      </div>
      <div class="chair-below">
        <Prompt examination={shown} session={session} restS={restS} isGuiding={isGuiding} isOld={isOld} />
        <ClassResult
          movement={shown.movement}
          reach={shown.reach}
          expectedClass={shown.expectedClass}
          isWithoutReach={shown.isWithoutReach}
          hasGap={shown.hasGap}
          isOfLastTrial={shown.step === 'ready'}
          isGuiding={isGuiding}
        />
        <AngleGauge movement={shown.movement} isOfLastTrial={shown.step === 'ready'} />
        <Trials protocol={session?.protocol ?? ''} trials={trials.value} isOver={shown.step === 'finished' || shown.step === 'free'} />
      </div>
      {!isGuiding ? null : session !== undefined && running ? (
        <TrialControls key={session.sessionId} link={link} rig={rig} session={session} examination={shown}>
          <StartTaken form={form} protocol={session.protocol} />
        </TrialControls>
      ) : (
        <StartControls link={link} rig={rig} session={session} onStart={form.open} />
      )}
    </div>
  );
};

/** `rigName`: of the address "#/chair/NAME". */
export const ChairPage = ({ link, rigName }: { link: Link; rigName: string | undefined }): JSX.Element => (
  <RigPage link={link} kind="chair" rigName={rigName}>
    {(status) => <Chair key={status.rig!.name} link={link} status={status} />}
  </RigPage>
);
