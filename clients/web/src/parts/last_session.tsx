// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { SessionInfo } from '../generated/dts/v1/control_pb';
import { strings } from '../strings';
import { protocolName } from './names';

/** Leads to the result of the rig's last session; shown when it has stopped. */
export const LastSession = ({ session }: { session: SessionInfo | undefined }): JSX.Element | null => {
  if (session === undefined || session.sessionId === '') return null;
  const { resultOf } = strings.common.lastSession;
  return (
    <a class="button" href={`#/sessions/${encodeURIComponent(session.sessionId)}`} data-testid="last-session">
      {resultOf(session.subject === '' ? strings.sessions.noSubject : session.subject, protocolName(session.protocol))}
    </a>
  );
};
