// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { StatusSnapshot } from '../../generated/dts/v1/control_pb';
import { DiskState } from '../../generated/dts/v1/sessions_pb';
import { Notice, Panel } from '../../parts/controls';
import { asSentence } from '../../parts/names';
import { bytes, dateTime, duration, fixed, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { Facts } from './facts';

const Disk = ({ status }: { status: StatusSnapshot }): JSX.Element | null => {
  const { disk } = status;
  const { facts, diskStates } = strings.health;
  if (disk === undefined) return null;
  return (
    <>
      {disk.problem !== '' && <Notice kind="error" what={asSentence(disk.problem)} testId="disk-problem" />}
      <Facts
        facts={[
          { name: facts.disk, value: diskStates[disk.state] ?? DiskState[disk.state], isDoubtful: disk.state !== DiskState.FINE, testId: 'disk-state' },
          { name: facts.free, value: bytes(disk.freeBytes), testId: 'disk-free' },
          { name: facts.recordable, value: `${fixed(disk.recordableS / 3600, 1)} h`, testId: 'disk-hours' },
          { name: facts.directory, value: disk.directory },
        ]}
      />
    </>
  );
};

/** The daemon and its computer. */
export const SystemPanel = ({ status }: { status: StatusSnapshot }): JSX.Element => {
  const { facts, system } = strings.health;
  const rejected = status.rejectedRequestsTotal;
  return (
    <Panel title={system} testId="system">
      <Facts
        facts={[
          { name: facts.version, value: status.version, testId: 'daemon-version' },
          { name: facts.uptime, value: duration(status.uptimeS) },
          { name: facts.hostTime, value: dateTime(status.hostTimeNs + status.utcMinusMonotonicNs) },
          { name: facts.instance, value: status.instanceId.toString(16) },
          { name: facts.rejected, value: whole(rejected), isDoubtful: rejected > 0n },
        ]}
      />
      <Disk status={status} />
      {status.notices.map((notice) => (
        <Notice key={notice} kind="plain" what={asSentence(notice)} testId="daemon-notice" />
      ))}
    </Panel>
  );
};
