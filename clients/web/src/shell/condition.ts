// SPDX-License-Identifier: Apache-2.0
// The status line: "2 rigs OK", or the worst problem.
import type { RigStatus, StatusSnapshot } from '../generated/dts/v1/control_pb';
import { DiskState, TrialPhase } from '../generated/dts/v1/sessions_pb';
import { DeviceState } from '../generated/dts/v1/stream_pb';
import type { Dropped, LinkState } from '../link/types';
import { isActive } from '../parts/active';
import { asSentence } from '../parts/names';
import { clockTime, fixed, whole } from '../parts/numbers';
import { lastOutcome } from '../parts/outcomes';
import { strings } from '../strings';

export interface Condition {
  readonly kind: 'good' | 'plain' | 'warning' | 'error';
  readonly text: string;
  readonly hint: string;
}

const words = strings.common.link;

const ofRig = (status: RigStatus): Condition | undefined => {
  const rig = status.rig?.name ?? '';
  const hint = asSentence(status.deviceMessage);
  if (status.device === DeviceState.GONE) return { kind: 'error', text: words.deviceLost(rig), hint };
  if (status.device === DeviceState.WAITING) return { kind: 'warning', text: words.deviceWaiting(rig), hint };
  if (status.device !== DeviceState.STREAMING) return { kind: 'warning', text: words.deviceStopped(rig), hint };
  const problem = status.session?.recording?.problem ?? '';
  return problem === '' ? undefined : { kind: 'error', text: words.recordingProblem(rig), hint: asSentence(problem) };
};

const duringTrial = new Set([TrialPhase.READY, TrialPhase.SETTLING, TrialPhase.MEASURING]);

/** "floor: trial 2 of 4" or how the last trial ended; nothing without a session. */
const ofSession = ({ rig, session }: RigStatus): string => {
  if (!isActive(session)) return '';
  const { trial } = session;
  const outcome = trial === undefined ? undefined : lastOutcome(trial);
  const isDuring = trial !== undefined && duringTrial.has(trial.phase);
  const what = isDuring
    ? words.inTrial(whole(trial.trial), whole(trial.of))
    : outcome === undefined
      ? words.running
      : words.withinLine(strings.common.trialEnded[outcome](whole(trial?.lastTrial)));
  return words.session(rig?.name ?? '', what);
};

const ofDisk = (status: StatusSnapshot): Condition | undefined => {
  const hint = asSentence(status.disk?.problem ?? '');
  switch (status.disk?.state) {
    case DiskState.UNUSABLE:
      return { kind: 'error', text: words.diskUnusable, hint };
    case DiskState.FULL:
      return { kind: 'error', text: words.diskFull, hint };
    case DiskState.LOW:
      return { kind: 'warning', text: words.diskLow(fixed(status.disk.recordableS / 3600, 1)), hint };
    default:
      return undefined;
  }
};

const ofStatus = (status: StatusSnapshot, dropped: Dropped): Condition => {
  const found = [...status.rigs.map(ofRig), ofDisk(status)].filter((one) => one !== undefined);
  const worst = found.find(({ kind }) => kind === 'error') ?? found[0];
  if (worst !== undefined) return worst;
  if (dropped.scansLately > 0) return { kind: 'warning', text: words.tabSlow(whole(dropped.scansLately)), hint: words.tabSlowHint };
  if (status.rigs.length === 0) return { kind: 'warning', text: words.noRig, hint: '' };
  const good = status.rigs.length === 1 ? words.oneRigOk : words.rigsOk(whole(status.rigs.length));
  return { kind: 'good', text: [good, ...status.rigs.map(ofSession)].filter((part) => part !== '').join(' · '), hint: '' };
};

export const conditionOf = (state: LinkState, since: number, status: StatusSnapshot | undefined, dropped: Dropped): Condition => {
  switch (state) {
    case 'connecting':
      return { kind: 'plain', text: words.connecting, hint: '' };
    case 'login':
      return { kind: 'plain', text: words.login, hint: '' };
    case 'fleet':
      return { kind: 'plain', text: words.fleet, hint: '' };
    case 'no-gateway':
      return { kind: 'error', text: words.noGateway(clockTime(since)), hint: words.noGatewayHint };
    case 'no-daemon':
      return { kind: 'error', text: words.noDaemon(clockTime(since)), hint: words.noDaemonHint };
    case 'up':
      return status === undefined ? { kind: 'plain', text: words.connecting, hint: '' } : ofStatus(status, dropped);
  }
};
