// SPDX-License-Identifier: Apache-2.0
// Stop session waits 5 s, so that it can be undone: the daemon cannot take a stop back.
import type { ReadonlySignal } from '@preact/signals';
import { signal } from '@preact/signals';
import { useEffect, useMemo, useRef } from 'preact/hooks';

export const waitS = 5;

export class DelayedStop {
  readonly #leftS = signal(0);
  readonly #send: () => void;
  #timer: ReturnType<typeof setInterval> | undefined;

  constructor(send: () => void) {
    this.#send = send;
  }

  /** Whole seconds until the command is sent; 0: no stop is wanted. */
  get leftS(): ReadonlySignal<number> {
    return this.#leftS;
  }

  /** Begins to wait. If it waits already, sends at once. */
  press(): void {
    if (this.flush()) return;
    this.#leftS.value = waitS;
    this.#timer = setInterval(() => {
      if (this.#leftS.peek() > 1) this.#leftS.value -= 1;
      else this.flush();
    }, 1000);
  }

  /** Sends at once if a stop is wanted. Returns whether one was. */
  flush(): boolean {
    const isWanted = this.#leftS.peek() > 0;
    this.undo();
    if (isWanted) this.#send();
    return isWanted;
  }

  undo(): void {
    clearInterval(this.#timer);
    this.#leftS.value = 0;
  }
}

/** A stop for as long as a session is shown. Leaving the page sends a wanted stop at once, unless the session has ended (`isOver`) meanwhile. */
export const useDelayedStop = (send: () => void, isOver: () => boolean): DelayedStop => {
  const latest = useRef({ send, isOver });
  latest.current = { send, isOver };
  const stop = useMemo(() => new DelayedStop(() => latest.current.send()), []);
  useEffect(() => {
    const leave = (): void => void (latest.current.isOver() ? stop.undo() : stop.flush());
    addEventListener('pagehide', leave);
    return () => {
      removeEventListener('pagehide', leave);
      leave();
    };
  }, [stop]);
  return stop;
};
