// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { DeviceInfo, RigStatus } from '../../generated/dts/v1/control_pb';
import { TareState } from '../../generated/dts/v1/control_pb';
import { DeviceState, GapReason } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { Notice, Panel } from '../../parts/controls';
import { Live } from '../../parts/live';
import { asSentence } from '../../parts/names';
import { clockTime, fixed, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import { DeviceTest } from './device_test';
import type { Fact } from './facts';
import { Facts } from './facts';
import { SensorTable } from './sensor_table';
import { sensorRows, workingRange } from './sensors';
import type { SeenGap } from './watch';
import { useWatched } from './watch';

const deviceFacts = (status: RigStatus, device: DeviceInfo | undefined): Fact[] => {
  const { facts, deviceStates, tareStates } = strings.health;
  const drift = status.clockDriftPpm === undefined ? facts.unknown : `${fixed(status.clockDriftPpm, 1)} ppm`;
  return [
    {
      name: facts.device,
      value: deviceStates[status.device] ?? DeviceState[status.device],
      isDoubtful: status.device !== DeviceState.STREAMING,
      testId: `device-state-${status.rig?.name ?? ''}`,
    },
    { name: facts.model, value: device?.model || facts.unknown },
    { name: facts.serial, value: device?.serial || facts.none },
    { name: facts.address, value: status.rig?.deviceUri ?? '' },
    {
      name: facts.tare,
      value: tareStates[status.tare] ?? TareState[status.tare],
      isDoubtful: status.tare !== TareState.DONE && status.tare !== TareState.RUNNING,
    },
    ...(status.zeroDriftNPerMin === undefined ? [] : [{ name: facts.zeroDrift, value: `${fixed(status.zeroDriftNPerMin, 2)} N/min` }]),
    { name: facts.drift, value: drift },
    { name: facts.uncertainty, value: `${fixed(Number(status.hostTimeUncertaintyNs) / 1e6, 3)} ms` },
  ];
};

const flowFacts = (status: RigStatus): Fact[] => {
  const { facts } = strings.health;
  const rig = status.rig?.name ?? '';
  const count = (name: string, value: bigint, testId?: string): Fact => ({
    name,
    value: whole(value),
    isDoubtful: value > 0n,
    ...(testId === undefined ? {} : { testId }),
  });
  return [
    { name: facts.rate, value: `${fixed(status.measuredRateHz, 2)} / ${fixed(status.nominalRateHz, 2)} Hz`, testId: `rate-${rig}` },
    { name: facts.scans, value: whole(status.scansTotal), testId: `scans-${rig}` },
    { name: facts.pipeline, value: `${fixed(status.pipelineUsPerScan, 1)} µs` },
    count(facts.lost, status.lostScansTotal, `lost-${rig}`),
    count(facts.gaps, status.gapsTotal),
    count(facts.reconnects, status.reconnectsTotal),
    count(facts.restarts, status.restartsTotal),
    count(facts.droppedBlocks, status.droppedBlocksTotal),
    count(facts.lostEvents, status.lostEventsTotal),
  ];
};

const Gaps = ({ gaps }: { gaps: readonly SeenGap[] }): JSX.Element | null => {
  const { gap, gapReasons } = strings.health;
  if (gaps.length === 0) return null;
  return (
    <ul class="health-gaps" data-testid="gaps">
      {gaps.map(({ atMs, gap: one }, index) => (
        <li key={`${atMs} ${index}`}>{gap(clockTime(atMs), gapReasons[one.reason] ?? GapReason[one.reason], whole(one.missingScans), one.isExact)}</li>
      ))}
    </ul>
  );
};

export const RigPanel = ({ link, status, device }: { link: Link; status: RigStatus; device: DeviceInfo | undefined }): JSX.Element => {
  const rig = status.rig?.name ?? '';
  const { seconds, gaps } = useWatched(link, rig);
  const sensors = status.rig?.sensors ?? [];
  const published = status.rig?.published ?? [];
  const { rigTitle, notPublished, notPublishedHint, pipeline } = strings.health;
  const rows = sensorRows(sensors, seconds.value.raw, seconds.value.deflection);
  return (
    <Panel title={rigTitle(rig, status.rig?.kind ?? '')} testId={`rig-${rig}`}>
      {status.deviceMessage !== '' && <Notice kind="warning" what={asSentence(status.deviceMessage)} testId={`device-message-${rig}`} />}
      <Facts facts={deviceFacts(status, device)} />
      <Facts facts={flowFacts(status)} />
      <Gaps gaps={gaps.value} />
      {sensors.length > 0 && published.includes('raw') && (
        <Live link={link} rig={rig}>
          <SensorTable rows={rows} range={workingRange(status.rig?.kind ?? '')} rig={rig} />
        </Live>
      )}
      {sensors.length > 0 && !published.includes('raw') && (
        <Notice kind="plain" what={notPublished(whole(sensors.length))} hint={notPublishedHint} testId={`not-published-${rig}`} />
      )}
      <DeviceTest link={link} rig={rig} />
      <details>
        <summary>{pipeline}</summary>
        <ol>
          {(status.rig?.stages ?? []).map((stage) => (
            <li key={stage}>{stage}</li>
          ))}
        </ol>
      </details>
    </Panel>
  );
};
