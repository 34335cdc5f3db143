// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { RigStatus } from '../../generated/dts/v1/control_pb';
import { DeviceState } from '../../generated/dts/v1/stream_pb';
import { PassingNotice } from '../../parts/controls';
import { asSentence } from '../../parts/names';
import { clockTime, duration } from '../../parts/numbers';
import { strings } from '../../strings';
import { inReadersLanguage } from '../../strings/messages';
import type { LiveFloor } from './live_floor';

const words = strings.floor;
const absenceShownMs = 15_000;

/** Problems of the sensors, of the session or of its last result, and the length of a gap that just ended. */
export const Remarks = ({ floor, status, canRedo }: { floor: LiveFloor; status: RigStatus; canRedo: boolean }): JSX.Element => {
  const sway = floor.sway.value?.sway;
  const absence = floor.absence.value;
  const isFresh = absence !== undefined && performance.now() - absence.back.atMs < absenceShownMs;
  void floor.now.value; // renders four times a second, so that the notice of a gap goes away in time
  return (
    <>
      {status.session?.message !== undefined && status.session.message !== '' && (
        <PassingNotice kind="error" what={asSentence(status.session.message)} testId="session-message" />
      )}
      {status.device === DeviceState.STREAMING && status.deviceMessage !== '' && (
        <PassingNotice kind="warning" what={words.doubtful} hint={asSentence(status.deviceMessage)} testId="device-message" />
      )}
      {sway !== undefined && sway.problem !== '' && (
        <PassingNotice kind="warning" what={words.noResult(inReadersLanguage(sway.problem))} hint={canRedo ? words.noResultHint : ''} testId="no-result" />
      )}
      {isFresh && (
        <PassingNotice
          kind="warning"
          what={words.gapAfter(clockTime(absence.back.dateMs), duration(absence.seconds))}
          hint={canRedo ? words.gapHint : ''}
          testId="gap"
        />
      )}
    </>
  );
};
