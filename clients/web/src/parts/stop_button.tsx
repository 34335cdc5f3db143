// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import { SessionState } from '../generated/dts/v1/stream_pb';
import type { Link } from '../link/types';
import { strings } from '../strings';
import type { Commands } from './controls';
import { Button } from './controls';
import type { DelayedStop } from './delayed_stop';
import { useDelayedStop } from './delayed_stop';

const stoppable = new Set([SessionState.STARTING, SessionState.SETTLING, SessionState.RUNNING]);

/** The delayed stop of one session: if another session has begun meanwhile, it is not the one to stop. */
export const useSessionStop = (link: Link, rig: string, sessionId: string, commands: Commands): DelayedStop => {
  const isOver = (): boolean => {
    const session = link.status.peek()?.rigs.find((one) => one.rig?.name === rig)?.session;
    return session?.sessionId !== sessionId || !stoppable.has(session.state);
  };
  const send = (): void => {
    if (!isOver()) void commands.run({ case: 'stopSession', value: { rig } });
  };
  return useDelayedStop(send, isOver);
};

/** Stop session; during the wait it says "Stop now". */
export const StopButton = ({ stop, label, whyNot }: { stop: DelayedStop; label: string; whyNot: string }): JSX.Element => (
  <Button
    label={stop.leftS.value > 0 ? strings.common.undo.stopNow : label}
    kind="danger"
    testId="stop-session"
    onClick={() => stop.press()}
    whyNot={whyNot}
    isReasonNearby
  />
);
