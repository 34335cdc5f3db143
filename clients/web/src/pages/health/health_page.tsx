// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { DeviceInfo, StatusSnapshot } from '../../generated/dts/v1/control_pb';
import type { Link } from '../../link/types';
import { Notice } from '../../parts/controls';
import { strings } from '../../strings';
import { useAsked } from '../sessions/asking';
import './health.css';
import { LatencyPanel } from './latency_panel';
import { RigPanel } from './rig_panel';
import { SystemPanel } from './system_panel';

const askDevices = async (link: Link): Promise<readonly DeviceInfo[]> => {
  const answer = await link.send({ case: 'getDevices', value: {} });
  return answer.case === 'devices' ? answer.value.devices : [];
};

/** Changes when a device or the daemon was gone: models and serial numbers may then be others. */
const deviceKey = (link: Link, status: StatusSnapshot): string =>
  link.state.value !== 'up' ? '' : `${status.instanceId} ${status.rigs.map((rig) => `${rig.device} ${rig.reconnectsTotal}`).join()}`;

const Health = ({ link, status }: { link: Link; status: StatusSnapshot }): JSX.Element => {
  const devices = useAsked(deviceKey(link, status), () => askDevices(link)).value;
  return (
    <div class="column">
      <h1 class="visually-hidden">{strings.health.title}</h1>
      {devices.error !== undefined && <Notice kind="warning" what={devices.error.message} hint={devices.error.hint} testId="devices-error" />}
      {status.rigs.length === 0 && <Notice kind="plain" what={strings.health.noRig} hint={strings.health.noRigHint} testId="no-rig" />}
      <div class="health-top">
        <SystemPanel status={status} />
        <LatencyPanel link={link} />
      </div>
      {status.rigs.map((rig) => (
        <RigPanel key={rig.rig?.name} link={link} status={rig} device={devices.answer?.find((one) => one.rig === rig.rig?.name)} />
      ))}
    </div>
  );
};

export const HealthPage = ({ link }: { link: Link }): JSX.Element => {
  const status = link.status.value;
  return status === undefined ? (
    <div class="empty" data-testid="no-status">
      <h1>{strings.health.title}</h1>
      <p>{strings.health.noStatus}</p>
    </div>
  ) : (
    <Health link={link} status={status} />
  );
};
