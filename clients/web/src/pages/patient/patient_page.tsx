// SPDX-License-Identifier: Apache-2.0
// The patient screen, for a second monitor: nothing but the task. It gives no commands, so every role may open it.
import { useComputed, useSignal } from '@preact/signals';
import type { ComponentChildren, JSX } from 'preact';
import { useEffect, useMemo, useRef } from 'preact/hooks';

import type { RigStatus } from '../../generated/dts/v1/control_pb';
import { Quality } from '../../generated/dts/v1/stream_pb';
import type { Link } from '../../link/types';
import { isActive } from '../../parts/active';
import { Button } from '../../parts/controls';
import { useIsOld } from '../../parts/live';
import { conditionName, useProtocols } from '../../parts/names';
import { clockTime, whole } from '../../parts/numbers';
import { useSinceS } from '../../parts/since';
import { strings } from '../../strings';
import { isRunning, targetPercent } from '../chair/examination';
import { useFollowed } from '../chair/follow';
import { LiveFloor } from '../floor/live_floor';
import { FeedbackMiddle } from './feedback_middle';
import './patient.css';
import { ReachPicture } from './reach_picture';
import type { ScreenState } from './screen_state';
import { patientRigs, sittingState, standingState } from './screen_state';
import { TargetPicture } from './target_picture';
import { ToneRule, Tones } from './tones';

const words = strings.patient;
type Kind = 'floor' | 'chair';

const wordOf = (texts: typeof words.states | typeof words.hints, state: ScreenState, kind: Kind): string => {
  const text = texts[state];
  return typeof text === 'string' ? text : text[kind];
};

const SoundButton = ({ tones }: { tones: Tones }): JSX.Element => {
  const isOn = tones.isOn.value;
  return (
    <div class="patient-sound">
      {!isOn && <span>{words.sound.why}</span>}
      <Button
        label={isOn ? words.sound.turnOff : words.sound.turnOn}
        testId="sound"
        isPressed={isOn}
        onClick={() => void (isOn ? tones.turnOff() : tones.turnOn())}
      />
    </div>
  );
};

interface ScreenProps {
  tones: Tones;
  kind: Kind;
  state: ScreenState;
  /** "Eyes closed": what the trial is about. */
  what: string;
  hint?: string;
  children?: ComponentChildren;
}

/** The frame of every state. Without data it has no picture: a frozen one could look alive. */
const Screen = ({ tones, kind, state, what, hint, children }: ScreenProps): JSX.Element => {
  const rule = useMemo(() => new ToneRule(), []);
  useEffect(() => {
    const tone = rule.next(state);
    if (tone !== undefined) tones.play(tone);
  }, [state]);
  return (
    <main class={`patient patient-${state}`} data-testid="patient" data-state={state} data-kind={kind}>
      <div role="status" aria-live="assertive">
        <h1 data-testid="patient-word">{wordOf(words.states, state, kind)}</h1>
        <p class="patient-what" data-testid="patient-what">
          {what}
        </p>
      </div>
      <div class="patient-picture">{state !== 'noData' && children}</div>
      <p class="patient-hint" data-testid="patient-hint">
        {hint ?? wordOf(words.hints, state, kind)}
      </p>
      <SoundButton tones={tones} />
    </main>
  );
};

const between = new Set<ScreenState>(['wait', 'rest']);
const inTrial = new Set<ScreenState>(['ready', 'settle', 'measure', 'middle', 'go', 'back']);

/** Returns the condition of the trial, or during a pause the next one. */
const whatOf = (state: ScreenState, { session }: RigStatus): string => {
  const { trial, protocol = '' } = session ?? {};
  if (trial === undefined) return '';
  if (inTrial.has(state)) return trial.condition === '' ? '' : conditionName(protocol, trial.condition);
  return between.has(state) && trial.nextCondition !== '' ? words.next(conditionName(protocol, trial.nextCondition)) : '';
};

const withSeconds = (hint: string, seconds: number): string => (seconds > 0 ? `${words.seconds(whole(seconds))} · ${hint}` : hint);

const noDataHint = (link: Link, rig: string): string => {
  const last = link.lastBlockAt(rig);
  return last === undefined ? words.hints.noData : `${words.hints.noData} ${words.hints.noDataSince(clockTime(last.dateMs))}`;
};

const hasTarget = new Set<ScreenState>(['wait', 'ready', 'settle', 'measure', 'middle', 'nobody']);

interface TaskProps {
  link: Link;
  status: RigStatus;
  tones: Tones;
}

const FloorScreen = ({ link, status, tones }: TaskProps): JSX.Element => {
  const { name, plateAMm, plateBMm } = status.rig!;
  const floor = useMemo(() => new LiveFloor(link, name), [link, name]);
  useEffect(() => () => floor.close(), [floor]);
  const { mlMm, apMm, quality } = floor.now.value;
  const { session } = status;
  const trial = session?.trial;
  const state = standingState({
    isOld: useIsOld(link, name).value,
    session,
    isSomebody: (quality & Quality.NO_CONTACT) === 0,
    isOffCentre: Math.hypot(mlMm, apMm) > Math.min(plateAMm, plateBMm) / 6,
  });
  const sinceS = useSinceS(link).value;
  const middle = useMemo(
    () => (trial?.hasFeedback === true ? new FeedbackMiddle(floor, session?.sessionId ?? '', trial.trial, trial.attempt) : undefined),
    [floor, session?.sessionId, trial?.trial, trial?.attempt, trial?.hasFeedback],
  );
  const hasFeedback = middle !== undefined && state === 'measure';
  const hint =
    state === 'noData'
      ? noDataHint(link, name)
      : hasFeedback
        ? words.hints.feedback
        : state === 'rest'
          ? withSeconds(words.hints.rest.floor, Math.ceil((trial?.remainingS ?? 0) - sinceS))
          : undefined;
  return (
    <Screen tones={tones} kind="floor" state={state} what={whatOf(state, status)} {...(hint === undefined ? {} : { hint })}>
      {hasTarget.has(state) && (
        <TargetPicture
          key={`${session?.sessionId}.${trial?.trial}.${trial?.attempt}`}
          link={link}
          floor={floor}
          middle={middle}
          hasFeedback={hasFeedback}
        />
      )}
    </Screen>
  );
};

const hasPerson = new Set<ScreenState>(['wait', 'ready', 'go', 'nobody']);
const hasResult = new Set<ScreenState>(['wait', 'back', 'rest', 'done']);

/** Returns whether somebody sits on the chair. */
const useIsSomebody = (link: Link, rig: string): boolean => {
  const isSomebody = useSignal(true);
  useEffect(() => link.onBlock(`${rig}/transient`, ({ quality }) => (isSomebody.value = ((quality[0] ?? 0) & Quality.NO_CONTACT) === 0)), [link, rig]);
  return isSomebody.value;
};

const ChairScreen = ({ link, status, tones }: TaskProps): JSX.Element => {
  const rig = status.rig!.name;
  const { examination, trials, restS } = useFollowed(link, rig);
  const isOld = useIsOld(link, rig).value;
  const isSomebody = useIsSomebody(link, rig);
  const shown = examination.value;
  const state = sittingState({ isOld, isRunning: isRunning(status), isSomebody, step: shown.step, trial: shown.trial });
  // A screen that was opened between two trials has not seen the reach: the catalogue has it.
  const last = useComputed(() => trials.value.at(-1)).value;
  const isSeen = shown.movement !== undefined || shown.isWithoutReach || state === 'back';
  const result = isSeen ? shown : { movement: last?.result?.movement, isWithoutReach: last?.result !== undefined && last.result.reach === undefined };
  const isPause = state === 'rest' || state === 'done';
  const movement = hasResult.has(state) && (isSeen || isPause) ? result.movement : undefined;
  const { trial } = status.session ?? {};
  const hint = state === 'noData' ? noDataHint(link, rig) : state === 'rest' ? withSeconds(words.hints.rest.chair, restS.value) : undefined;
  return (
    <Screen tones={tones} kind="chair" state={state} what={whatOf(state, status)} {...(hint === undefined ? {} : { hint })}>
      {(hasPerson.has(state) || hasResult.has(state)) && isActive(status.session) && (
        <ReachPicture
          percent={trial?.targetPercent ?? targetPercent(shown, shown.targetCm)}
          movement={movement}
          isWithoutReach={isPause && result.isWithoutReach}
        />
      )}
    </Screen>
  );
};

/** `rigName`: of the address "#/patient/NAME"; without it, the screen follows the rig with a session, if there is one only. */
export const PatientPage = ({ link, rigName }: { link: Link; rigName: string | undefined }): JSX.Element => {
  useProtocols(link);
  useEffect(() => void (document.title = words.title), []);
  const tones = useMemo(() => new Tones(), []); // the press for sound holds also for another rig
  useEffect(() => () => tones.close(), [tones]);
  const followed = useRef<string>();
  const rigs = patientRigs(link.status.value, rigName, followed.current);
  const shown = rigs.length === 1 ? rigs[0] : undefined;
  if (isActive(shown?.session)) followed.current = shown!.rig!.name; // also after a crash of dtsd, when both sessions resume
  if (shown === undefined) {
    const isUnknown = link.status.value !== undefined && rigName !== undefined;
    const hint = rigs.length > 1 ? words.severalRigs(rigs.map(({ rig }) => rig!.name).join(', ')) : isUnknown ? words.noRig(rigName) : '';
    return <Screen tones={tones} kind="floor" state="wait" what="" hint={hint} />;
  }
  const Task = shown.rig!.kind === 'chair' ? ChairScreen : FloorScreen;
  return <Task key={shown.rig!.name} link={link} status={shown} tones={tones} />;
};
