// SPDX-License-Identifier: Apache-2.0
import type { SessionInfo } from '../generated/dts/v1/control_pb';
import type { TrialStatus } from '../generated/dts/v1/sessions_pb';
import { TrialPhase } from '../generated/dts/v1/sessions_pb';
import { SessionState } from '../generated/dts/v1/stream_pb';

const atRest = new Set([SessionState.UNSPECIFIED, SessionState.IDLE, SessionState.FAILED]);

/** Returns whether a session runs. A failed one does not: there is nothing to stop, and another can be started. */
export const isActive = (session: SessionInfo | undefined): session is SessionInfo => session !== undefined && !atRest.has(session.state);

/** Returns whether a trial is measured until the operator ends it: its protocol has no duration. */
export const isOpenEnded = ({ phase, durationS }: TrialStatus): boolean => phase === TrialPhase.MEASURING && durationS === undefined;
