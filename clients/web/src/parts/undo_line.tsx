// SPDX-License-Identifier: Apache-2.0
// The line under the buttons of a session: what was just done, and Undo (U). Its height is reserved, so that it covers nothing and moves nothing.
import type { ComponentChildren, JSX } from 'preact';

import type { TrialStatus } from '../generated/dts/v1/sessions_pb';
import { TrialAction } from '../generated/dts/v1/sessions_pb';
import type { Link } from '../link/types';
import { strings } from '../strings';
import type { Commands } from './controls';
import { Button, whyNotOperate } from './controls';
import type { DelayedStop } from './delayed_stop';
import { useKeys } from './keys';
import { whole } from './numbers';
import { lastOutcome } from './outcomes';
import { useSinceS } from './since';

const words = strings.common.undo;

interface UndoLineProps {
  link: Link;
  rig: string;
  trial: TrialStatus | undefined;
  stop: DelayedStop;
  commands: Commands;
  /** Shown while there is nothing to undo. */
  children: ComponentChildren;
}

interface Undoable {
  readonly text: string;
  readonly leftS: number;
  undo(): void;
}

const useUndoable = ({ link, rig, trial, stop, commands }: UndoLineProps): Undoable | undefined => {
  const sinceS = useSinceS(link).value;
  if (stop.leftS.value > 0) return { text: words.stops, leftS: stop.leftS.value, undo: () => stop.undo() };
  const leftS = Math.ceil((trial?.undoS ?? 0) - sinceS);
  const outcome = trial === undefined ? undefined : lastOutcome(trial);
  if (trial === undefined || leftS <= 0 || (outcome !== 'rejected' && outcome !== 'redone')) return undefined;
  return {
    text: strings.common.trialEnded[outcome](whole(trial.lastTrial)),
    leftS,
    undo: () => void commands.run({ case: 'trial', value: { rig, action: TrialAction.UNDO } }),
  };
};

export const UndoLine = (props: UndoLineProps): JSX.Element => {
  const undoable = useUndoable(props);
  const whyNot = whyNotOperate(props.link);
  useKeys({ u: () => whyNot === '' && undoable?.undo() });
  return (
    <div class="undo-line">
      <div role="status">
        {undoable !== undefined && (
          <span class="undo-text" data-testid="toast">
            {undoable.text}
          </span>
        )}
      </div>
      {undoable === undefined ? (
        props.children
      ) : (
        <>
          <Button label={words.undo} keyName="U" testId="undo" onClick={undoable.undo} whyNot={whyNot} isReasonNearby />
          <span class="undo-left" aria-hidden="true">
            {words.left(whole(undoable.leftS))}
          </span>
        </>
      )}
    </div>
  );
};
