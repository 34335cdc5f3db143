// SPDX-License-Identifier: Apache-2.0
// The test of a device, for engineers: statistics of every channel, also of streams that are not published, and the start checks.
import { useSignal } from '@preact/signals';
import type { JSX } from 'preact';

import type { TestDeviceResponse } from '../../generated/dts/v1/control_pb';
import { CheckOutcome } from '../../generated/dts/v1/control_pb';
import { Role } from '../../generated/dts/v1/options_pb';
import type { Link } from '../../link/types';
import { Button, CommandNotice, Notice, useCommands, whyNotOperate } from '../../parts/controls';
import { asSentence } from '../../parts/names';
import { fixed, measured } from '../../parts/numbers';
import { strings } from '../../strings';
import { inReadersLanguage } from '../../strings/messages';
import { QualityText } from './sensor_table';

const Channels = ({ test }: { test: TestDeviceResponse }): JSX.Element => {
  const { heads } = strings.health.test;
  return (
    <table class="stack" data-testid="device-channels">
      <thead>
        <tr>
          <th>{heads.channel}</th>
          <th class="number">{heads.mean}</th>
          <th class="number">{heads.noise}</th>
          <th class="number">{heads.minimum}</th>
          <th class="number">{heads.maximum}</th>
          <th>{heads.unit}</th>
          <th class="number">{heads.distance}</th>
          <th>{heads.quality}</th>
        </tr>
      </thead>
      <tbody>
        {test.channels.map((channel) => (
          <tr key={channel.name}>
            <th scope="row">{channel.name}</th>
            <td data-label={heads.mean} class="number">
              {fixed(channel.mean, 4)}
            </td>
            <td data-label={heads.noise} class="number">
              {measured(channel.noiseRms)}
            </td>
            <td data-label={heads.minimum} class="number">
              {fixed(channel.minimum, 4)}
            </td>
            <td data-label={heads.maximum} class="number">
              {fixed(channel.maximum, 4)}
            </td>
            <td data-label={heads.unit}>{channel.unit}</td>
            <td data-label={heads.distance} class="number">
              {channel.isSensor ? fixed(channel.gapMm, 2) : ''}
            </td>
            <td data-label={heads.quality}>
              <QualityText bits={channel.quality} />
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
};

const Checks = ({ test }: { test: TestDeviceResponse }): JSX.Element => (
  <ul class="health-checks">
    {test.checks.map((check) => (
      <li key={check.name}>
        <strong>{asSentence(check.name)}</strong>: {strings.health.test.outcomes[check.outcome] ?? CheckOutcome[check.outcome]}
        {check.detail !== '' && `, ${inReadersLanguage(check.detail)}`}
      </li>
    ))}
  </ul>
);

export const DeviceTest = ({ link, rig }: { link: Link; rig: string }): JSX.Element => {
  const commands = useCommands(link);
  const test = useSignal<TestDeviceResponse | undefined>(undefined);
  const isTared = useSignal(false);
  const words = strings.health.test;
  const whyNotTest = link.state.value !== 'up' ? whyNotOperate(link) : link.me.value.role < Role.ENGINEER ? words.needsEngineer : '';
  const run = async (): Promise<void> => {
    test.value = undefined; // else it looks like the result of this test
    const answer = await commands.run({ case: 'testDevice', value: { rig } });
    if (answer?.case === 'deviceTest') test.value = answer.value;
  };
  const tare = async (): Promise<void> => {
    const answer = await commands.run({ case: 'tare', value: { rig } });
    isTared.value = answer !== undefined;
  };
  return (
    <div class="column">
      <div class="row">
        <Button label={words.run} onClick={() => void run()} whyNot={whyNotTest} testId={`test-device-${rig}`} />
        <Button label={words.tare} onClick={() => void tare()} whyNot={whyNotOperate(link)} testId={`tare-${rig}`} />
      </div>
      <CommandNotice commands={commands} testId={`device-error-${rig}`} />
      {isTared.value && <Notice kind="good" what={words.tared} testId={`tared-${rig}`} onDismiss={() => (isTared.value = false)} />}
      {test.value !== undefined && test.value.problem !== '' && <Notice kind="warning" what={asSentence(test.value.problem)} testId={`device-problem-${rig}`} />}
      {test.value !== undefined && test.value.channels.length > 0 && <Channels test={test.value} />}
      {test.value !== undefined && <Checks test={test.value} />}
    </div>
  );
};
