// SPDX-License-Identifier: Apache-2.0
// The Link over the gateway's WebSocket.
//
//   /api/me --nobody--> login          /--hidden: topics []-- paused
//      |                              v
//   socket --Welcome, ClockAnswer--> subscribed --blocks, events--> handlers --animation frame--> painters --Painted-->
//      ^                              |
//      +--0.25 .. 2 s-- gone <--closed, or 2 s of silence
import { create, fromBinary, getOption, toBinary } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { batch, signal } from '@preact/signals';

import { ErrorCode, RequestSchema, StatusSnapshotSchema } from '../generated/dts/v1/control_pb';
import type { StatusSnapshot } from '../generated/dts/v1/control_pb';
import type { Frame, FromGateway, Welcome } from '../generated/dts/v1/gateway_pb';
import { FromBrowserSchema, FromGatewaySchema } from '../generated/dts/v1/gateway_pb';
import { Role, rules, topic as topicOption } from '../generated/dts/v1/options_pb';
import { EventSchema, StreamBlockSchema } from '../generated/dts/v1/stream_pb';
import { strings } from '../strings';
import { askWho, logIn, logOut, nobody } from './account';
import { HostClock } from './clock';
import { PendingCommands } from './commands';
import { Drops } from './drops';
import { Handlers } from './handlers';
import type { PaintObserver } from './painter';
import { Painter } from './painter';
import { splitTopic, Streams } from './streams';
import type { Answer, Block, Command, Link, LinkState, LiveEvent, Me } from './types';
import { CommandError } from './types';

/** The browser, as far as the link needs it; tests have another one. */
export interface Surroundings {
  openSocket(): WebSocket;
  fetch: typeof fetch;
  requestFrame(callback: () => void): void;
  isHidden(): boolean;
  onVisibility(handler: () => void): void;
}

const tickMs = 250;
const silenceMs = 2000; // the promise of the screens: gone is told within two seconds
const askAfterMs = 1000; // of silence; the answer shows that somebody is there
const probeEveryMs = 5000;
const shortestWaitMs = 250;
const longestWaitMs = 2000;
const statusTopic = 'dtsd/status';
const tickTopic = 'tick';
// After these the status is another one: it is asked for at once, instead of waiting for the next second.
const changingNames = new Set(['session', 'trial', 'device']);
// The daemon's time for the command, and ten seconds for the way.
const timeoutMs = ({ case: name }: Command): number => {
  const field = RequestSchema.fields.find(({ localName }) => localName === name);
  return 10_000 + 1000 * (field === undefined ? 0 : getOption(field, rules).timeoutS);
};
// Topics "<rig>/..." that carry an Event; everything else is a stream.
const eventNames = new Set(EventSchema.oneofs[0]?.fields.map((field) => getOption(field, topicOption).name).filter((name) => name !== ''));

export class GatewayLink implements Link {
  readonly state = signal<LinkState>('connecting');
  readonly since = signal(Date.now());
  readonly me = signal<Me>(nobody);
  readonly status = signal<StatusSnapshot | undefined>(undefined);
  readonly clockErrorMs = signal(NaN);
  readonly #drops = new Drops();
  readonly dropped = this.#drops.told;

  readonly #around: Surroundings;
  readonly #observer: PaintObserver | undefined;
  readonly #clock = new HostClock();
  readonly #streams = new Streams(this.#clock);
  readonly #commands = new PendingCommands();
  readonly #painter: Painter;
  #blockHandlers = new Handlers<Block>();
  #eventHandlers = new Handlers<LiveEvent>();
  #tickHandlers = new Handlers<number>();
  #wishes = new Set<{ readonly topics: readonly string[] }>();
  #lastBlocks = new Map<string, { atMs: number; readonly shown: ReturnType<typeof signal<number>> }>();

  #socket: WebSocket | undefined;
  #attempt = 0; // whatever belongs to an earlier one is ignored
  #waitMs = shortestWaitMs;
  #heardMs = 0;
  #probedMs = 0;
  #tickedMs = 0;
  #isWelcome = false;
  #isWishSent = false;
  #isStatusAsked = false;
  #newestFrame = 0n;
  #paintedFrame = 0n;

  constructor(around: Surroundings, observer?: PaintObserver) {
    this.#around = around;
    this.#observer = observer;
    this.#painter = new Painter(around.requestFrame, (startedMs) => this.#painted(startedMs));
    around.onVisibility(() => this.#visibilityChanged());
    setInterval(() => this.#tick(), tickMs);
    void this.#connect();
  }

  lastBlockAt(rig: string): number {
    return this.#lastBlockOf(rig).shown.value ?? 0;
  }

  subscribe(topics: readonly string[]): () => void {
    const wish = { topics: [...topics] };
    this.#wishes.add(wish);
    this.#wishChanged();
    return () => {
      if (this.#wishes.delete(wish)) this.#wishChanged();
    };
  }

  onBlock(topic: string, handler: (block: Block) => void): () => void {
    return this.#blockHandlers.add(topic, handler);
  }

  onEvent(topic: string, handler: (event: LiveEvent) => void): () => void {
    return this.#eventHandlers.add(topic, handler);
  }

  onPaint(handler: (nowMs: number) => void): () => void {
    return this.#painter.add(handler);
  }

  onTick(handler: (nowMs: number) => void): () => void {
    return this.#tickHandlers.add(tickTopic, handler);
  }

  send(command: Command): Promise<Answer> {
    if (!this.#isWelcome) {
      const { notConnected, notConnectedHint } = strings.common.command;
      return Promise.reject(new CommandError(ErrorCode.UNREACHABLE, notConnected, notConnectedHint));
    }
    return this.#commands.send((requestId) => this.#post({ case: 'request', value: { requestId, command } }), timeoutMs(command));
  }

  async logIn(user: string, password: string): Promise<void> {
    await logIn(this.#around.fetch, user, password);
    await this.#connect();
  }

  async logOut(): Promise<void> {
    await logOut(this.#around.fetch);
    await this.#connect();
  }

  // The connection.

  async #connect(): Promise<void> {
    this.#drop();
    const attempt = ++this.#attempt;
    let me: Me;
    try {
      me = await askWho(this.#around.fetch);
    } catch {
      if (attempt === this.#attempt) this.#gone();
      return;
    }
    if (attempt !== this.#attempt) return;
    this.me.value = me;
    if (me.role < Role.VIEWER) this.#enter('login');
    else this.#openSocket(attempt);
  }

  #openSocket(attempt: number): void {
    const socket = this.#around.openSocket();
    const ifPresent = (react: () => void) => (): void => {
      if (attempt === this.#attempt) react();
    };
    socket.binaryType = 'arraybuffer';
    socket.onopen = ifPresent(() => this.#probe());
    socket.onclose = ifPresent(() => this.#gone());
    socket.onmessage = (message) => ifPresent(() => this.#hear(message.data))();
    this.#heardMs = performance.now();
    this.#socket = socket;
  }

  /** Lets go of a connection, without a word to the pages. */
  #drop(): void {
    this.#attempt += 1;
    this.#socket?.close();
    this.#socket = undefined;
    this.#isWelcome = false;
    this.#isWishSent = false;
    this.#newestFrame = 0n;
    this.#paintedFrame = 0n;
    this.#clock.forget();
    this.#streams.forget();
    this.#commands.connectionLost();
  }

  #gone(): void {
    this.#drop();
    this.#enter('no-gateway');
    const attempt = this.#attempt;
    setTimeout(() => {
      if (attempt === this.#attempt) void this.#connect();
    }, this.#waitMs);
    this.#waitMs = Math.min(2 * this.#waitMs, longestWaitMs);
  }

  #enter(state: LinkState): void {
    if (this.state.value === state) return;
    batch(() => {
      this.state.value = state;
      this.since.value = Date.now();
    });
    this.#painter.ask();
  }

  #post(body: NonNullable<MessageInitShape<typeof FromBrowserSchema>['body']>): void {
    if (this.#socket?.readyState !== WebSocket.OPEN) return; // its end is told by onclose
    this.#socket.send(toBinary(FromBrowserSchema, create(FromBrowserSchema, { body })));
  }

  #probe(): void {
    this.#probedMs = performance.now();
    this.#post({ case: 'clockProbe', value: { browserMs: this.#probedMs } });
  }

  #tick(): void {
    const nowMs = performance.now();
    // When this tab itself stood still, messages wait behind this tick: the silence was ours.
    const isLate = nowMs - this.#tickedMs > 2 * tickMs;
    if (isLate) this.#heardMs = Math.max(this.#heardMs, nowMs - askAfterMs);
    this.#tickedMs = nowMs;
    if (isLate) setTimeout(() => this.#tellTick()); // whoever judges ages hears them first
    else this.#tellTick();
    // A hidden tab's timers and frames run when the browser likes: there is nothing to be judged from them.
    if (this.#around.isHidden()) return;
    this.#painter.ask();
    if (this.#socket === undefined) return;
    const isQuiet = nowMs - this.#heardMs >= askAfterMs;
    if (nowMs - this.#heardMs >= silenceMs) this.#gone();
    else if (nowMs - this.#probedMs >= (isQuiet ? askAfterMs : probeEveryMs)) this.#probe();
  }

  #tellTick(): void {
    const nowMs = performance.now();
    for (const { atMs, shown } of this.#lastBlocks.values()) shown.value = atMs;
    this.#drops.tick(nowMs);
    if (!this.#around.isHidden()) this.#tickHandlers.tell(tickTopic, nowMs);
  }

  // What is wanted.

  #wishChanged(): void {
    if (!this.#isWishSent) return;
    this.#isWishSent = false;
    queueMicrotask(() => this.#sendWish()); // a page's several wishes, or one page's after another's, in one message
  }

  /** Not before the clock is known: every block has a time then. */
  #sendWish(): void {
    if (!this.#isWelcome || !this.#clock.isKnown || this.#isWishSent) return;
    this.#isWishSent = true;
    const topics = this.#around.isHidden() ? [] : [...new Set([...this.#wishes].flatMap((wish) => wish.topics))];
    this.#post({ case: 'subscribe', value: { topics } });
  }

  #visibilityChanged(): void {
    this.#streams.forget();
    this.#isWishSent = false;
    this.#sendWish();
    if (this.#around.isHidden()) return;
    this.#heardMs = performance.now();
    this.#probe();
    this.#painter.ask();
  }

  // What comes.

  #hear(data: unknown): void {
    const startedMs = performance.now();
    this.#heardMs = startedMs;
    let message: FromGateway;
    try {
      if (!(data instanceof ArrayBuffer)) throw new TypeError('a text message');
      message = fromBinary(FromGatewaySchema, new Uint8Array(data));
      this.#take(message, startedMs);
    } catch (problem) {
      reportError(problem); // not of our protocol: begin anew rather than guess
      this.#gone();
      return;
    }
    this.#observer?.onWork(performance.now() - startedMs);
  }

  #take({ body }: FromGateway, nowMs: number): void {
    switch (body.case) {
      case 'welcome':
        return this.#welcomed(body.value);
      case 'frame':
        return this.#takeFrame(body.value);
      case 'clockAnswer':
        if (this.#clock.answered(body.value.browserMs, body.value.hostTimeNs, nowMs)) this.clockErrorMs.value = this.#clock.errorMs;
        return this.#sendWish();
      case 'response':
        return this.#commands.answered(body.value);
      case 'link':
        return this.#daemonIs(body.value.isUp);
    }
  }

  #welcomed(welcome: Welcome): void {
    this.#isWelcome = true;
    this.#waitMs = shortestWaitMs;
    this.me.value = { ...this.me.value, user: welcome.user, role: welcome.role };
    this.#drops.forget();
    this.#daemonIs(welcome.link?.isUp ?? false);
    this.#sendWish();
  }

  #daemonIs(isUp: boolean): void {
    if (!isUp) this.#streams.forget();
    this.#enter(isUp ? 'up' : 'no-daemon');
  }

  #takeFrame(frame: Frame): void {
    this.#newestFrame = frame.number;
    this.#drops.count(Number(frame.droppedBlocksTotal), Number(frame.droppedScansTotal), Number(frame.droppedEventsTotal), performance.now());
    for (const { topic, message } of frame.messages) this.#takeMessage(topic, message);
    this.#painter.ask();
  }

  #takeMessage(topic: string, bytes: Uint8Array): void {
    if (topic === statusTopic) return this.#learn(fromBinary(StatusSnapshotSchema, bytes));
    const parts = splitTopic(topic);
    if (parts === undefined) return;
    if (eventNames.has(parts.name)) {
      const event = fromBinary(EventSchema, bytes);
      const timeMs = this.#clock.toBrowserMs(event.hostTimeNs ?? 0n);
      this.#eventHandlers.tell(topic, { topic, rig: parts.rig, kind: parts.name, timeMs, event });
      if (changingNames.has(parts.name)) void this.#askStatus();
      return;
    }
    if (this.#around.isHidden()) return; // on its way when the tab was hidden; painted when it is seen again, it would be old
    const block = this.#streams.take(topic, fromBinary(StreamBlockSchema, bytes));
    if (block === undefined) return;
    this.#lastBlockOf(block.rig).atMs = Date.now();
    this.#blockHandlers.tell(topic, block);
  }

  /** The answer to a command may overtake a snapshot that waits in a frame: what is older does not replace it. */
  #learn(status: StatusSnapshot): void {
    const known = this.status.peek();
    if (known?.instanceId === status.instanceId && status.hostTimeNs < known.hostTimeNs) return;
    this.#streams.learn(status);
    this.status.value = status;
  }

  async #askStatus(): Promise<void> {
    if (this.#isStatusAsked) return;
    this.#isStatusAsked = true;
    const answer = await this.send({ case: 'status', value: {} }).catch(() => undefined); // else the next second brings it
    this.#isStatusAsked = false;
    if (answer?.case === 'status') this.#learn(answer.value);
  }

  #lastBlockOf(rig: string): { atMs: number; readonly shown: ReturnType<typeof signal<number>> } {
    const known = this.#lastBlocks.get(rig);
    if (known !== undefined) return known;
    const made = { atMs: 0, shown: signal<number>(0) };
    this.#lastBlocks.set(rig, made);
    return made;
  }

  #painted(startedMs: number): void {
    if (this.#newestFrame > this.#paintedFrame) {
      this.#paintedFrame = this.#newestFrame;
      this.#post({ case: 'painted', value: { frame: this.#paintedFrame } });
    }
    this.#observer?.onPainted(startedMs);
  }
}
