// SPDX-License-Identifier: Apache-2.0
import type { Response } from '../generated/dts/v1/control_pb';
import { ErrorCode } from '../generated/dts/v1/control_pb';
import { asSentence } from '../parts/names';
import { whole } from '../parts/numbers';
import { strings } from '../strings';
import type { Answer } from './types';
import { CommandError } from './types';

interface Waiting {
  readonly resolve: (answer: Answer) => void;
  readonly reject: (error: CommandError) => void;
  readonly timer: ReturnType<typeof setTimeout>;
}

const newId = (): string =>
  // Not crypto.randomUUID: it is missing on pages served by plain HTTP from another computer.
  Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, '0')).join('');

/** Commands that wait for their answer. */
export class PendingCommands {
  #waiting = new Map<string, Waiting>();

  /** Sends a command: `post` sends the request with the given id. Fails if no answer arrives within `timeoutMs`. */
  send(post: (requestId: string) => void, timeoutMs: number): Promise<Answer> {
    const requestId = newId();
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => {
        this.#waiting.delete(requestId);
        const { noAnswer, noAnswerHint } = strings.common.command;
        reject(new CommandError(ErrorCode.TIMEOUT, noAnswer(whole(timeoutMs / 1000)), noAnswerHint));
      }, timeoutMs);
      this.#waiting.set(requestId, { resolve, reject, timer });
      post(requestId);
    });
  }

  answered(response: Response): void {
    const waiting = this.#waiting.get(response.requestId);
    if (waiting === undefined) return; // too late
    this.#waiting.delete(response.requestId);
    clearTimeout(waiting.timer);
    const result = response.result;
    if (result.case === 'error') waiting.reject(new CommandError(result.value.code, asSentence(result.value.what), asSentence(result.value.hint)));
    else waiting.resolve(result);
  }

  /** Fails all pending commands. They are not sent again: the daemon may have received them, and the user may have changed their mind. */
  connectionLost(): void {
    const { connectionLost, connectionLostHint } = strings.common.command;
    for (const waiting of this.#waiting.values()) {
      clearTimeout(waiting.timer);
      waiting.reject(new CommandError(ErrorCode.UNREACHABLE, connectionLost, connectionLostHint));
    }
    this.#waiting.clear();
  }
}
