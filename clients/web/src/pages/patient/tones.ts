// SPDX-License-Identifier: Apache-2.0
// The tones of the patient screen: a high one when a trial begins, a low one when it ends. A browser plays no sound before a press, so turnOn() must
// be called by a click.
import { signal } from '@preact/signals';

import type { ScreenState } from './screen_state';

export type Tone = 'start' | 'end';

const hertz: Readonly<Record<Tone, number>> = { start: 880, end: 440 };
const lengthS = 0.35;
const fadeS = 0.02; // without it a tone begins and ends with a click
const loudness = 0.4;

const pausing = new Set<ScreenState>(['idle', 'wait', 'ready', 'rest', 'done']);
const running = new Set<ScreenState>(['settle', 'measure', 'go', 'back']);

/** Decides which change of the state has a tone. The first state has none: a screen that is opened or that lost its data missed the moment. */
export class ToneRule {
  #last: ScreenState | undefined;

  next(state: ScreenState): Tone | undefined {
    const before = this.#last;
    if (state === 'noData') this.#last = undefined;
    else if (pausing.has(state) || running.has(state)) this.#last = state;
    if (before === undefined) return undefined;
    if (pausing.has(before) && running.has(state)) return 'start';
    return running.has(before) && pausing.has(state) && state !== 'ready' ? 'end' : undefined; // 'ready': the trial is repeated
  }
}

export class Tones {
  readonly isOn = signal(false);
  #context: AudioContext | undefined;

  /** Call it in the handler of a click. Plays a tone, as a test of the loudspeaker. */
  async turnOn(): Promise<void> {
    this.#context ??= new AudioContext();
    await this.#context.resume();
    this.isOn.value = this.#context.state === 'running';
    this.play('start');
  }

  turnOff(): void {
    this.isOn.value = false;
  }

  play(tone: Tone): void {
    if (!this.isOn.peek() || this.#context === undefined) return;
    const { currentTime: fromS, destination } = this.#context;
    const [source, volume] = [this.#context.createOscillator(), this.#context.createGain()];
    source.frequency.value = hertz[tone];
    volume.gain.setValueAtTime(0, fromS);
    volume.gain.linearRampToValueAtTime(loudness, fromS + fadeS);
    volume.gain.setValueAtTime(loudness, fromS + lengthS - fadeS);
    volume.gain.linearRampToValueAtTime(0, fromS + lengthS);
    source.connect(volume).connect(destination);
    source.start(fromS);
    source.stop(fromS + lengthS);
  }

  close(): void {
    void this.#context?.close();
    this.#context = undefined;
    this.isOn.value = false;
  }
}
