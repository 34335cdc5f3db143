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
import type { Signal } from '@preact/signals';
import { batch, signal } from '@preact/signals';

import { ErrorCode, RequestSchema, StatusSnapshotSchema } from '../generated/dts/v1/control_pb';
import type { StatusSnapshot } from '../generated/dts/v1/control_pb';
import type { Frame, FromGateway, Link as GatewayToDaemon, Welcome } from '../generated/dts/v1/gateway_pb';
import { FromBrowserSchema, FromGatewaySchema } from '../generated/dts/v1/gateway_pb';
import { Role, rules, topic as topicOption } from '../generated/dts/v1/options_pb';
import { EventSchema, StreamBlockSchema } from '../generated/dts/v1/stream_pb';
import { asSentence } from '../parts/names';
import { strings } from '../strings';
import { askWho, logIn, logOut, nobody } from './account';
import { HostClock } from './clock';
import { PendingCommands } from './commands';
import { Drops } from './drops';
import { Handlers } from './handlers';
import type { PaintObserver } from './painter';
import { Painter } from './painter';
import { splitTopic, Streams } from './streams';
import type { Answer, Block, ClosableLink, Command, Instant, LinkState, LiveEvent, Me } from './types';
import { CommandError, instantNow } from './types';

/** What the link needs of the browser; tests replace it. */
export interface Surroundings {
  /** The clinic to watch, at a centre. Without one, a link to a centre opens no socket. */
  readonly clinic?: string | undefined;
  openSocket(): WebSocket;
  fetch: typeof fetch;
  requestFrame(callback: () => void): void;
  isHidden(): boolean;
  /** Returns a function that stops it. */
  onVisibility(handler: () => void): () => void;
}

const tickMs = 250;
const silenceMs = 2000; // the page must show a lost connection within two seconds
const askAfterMs = 1000; // of silence; an answer shows that the gateway is alive
const probeEveryMs = 5000;
const shortestWaitMs = 250;
const longestWaitMs = 2000;
const statusTopic = 'dtsd/status';
const tickTopic = 'tick';
// These events change the status: the link asks for it at once and does not wait for the next one.
const changingNames = new Set(['session', 'trial', 'device']);
// The time that the daemon may take for the command, plus ten seconds for transfer.
const timeoutMs = ({ case: name }: Command): number => {
  const field = RequestSchema.fields.find(({ localName }) => localName === name);
  return 10_000 + 1000 * (field === undefined ? 0 : getOption(field, rules).timeoutS);
};
// Names in "<rig>/..." that carry an Event; all others are streams.
const eventNames = new Set(EventSchema.oneofs[0]?.fields.map((field) => getOption(field, topicOption).name).filter((name) => name !== ''));

interface LastBlock {
  newest: Instant | undefined;
  /** `newest` as of the last tick. */
  readonly shown: Signal<Instant | undefined>;
}

export class GatewayLink implements ClosableLink {
  readonly state = signal<LinkState>('connecting');
  readonly since = signal(Date.now());
  readonly me = signal<Me>(nobody);
  readonly problem = signal('');
  readonly status = signal<StatusSnapshot | undefined>(undefined);
  readonly clockErrorMs = signal(NaN);
  readonly #drops = new Drops();
  readonly dropped = this.#drops.current;

  readonly #around: Surroundings;
  readonly #observer: PaintObserver | undefined;
  readonly #clock = new HostClock();
  readonly #streams = new Streams(this.#clock);
  readonly #commands = new PendingCommands();
  readonly #painter: Painter;
  #blockHandlers = new Handlers<Block>();
  #eventHandlers = new Handlers<LiveEvent>();
  #tickHandlers = new Handlers<number>();
  #wanted = new Set<{ readonly topics: readonly string[] }>();
  #lastBlocks = new Map<string, LastBlock>();

  #socket: WebSocket | undefined;
  #attempt = 0; // results of earlier attempts are ignored
  #waitMs = shortestWaitMs;
  #receivedMs = 0;
  #probedMs = 0;
  #tickedMs = 0;
  #isWelcome = false;
  #isSubscribed = false;
  #isStatusAsked = false;
  #newestFrame = 0n;
  #paintedFrame = 0n;
  readonly #release: () => void;

  constructor(around: Surroundings, observer?: PaintObserver) {
    this.#around = around;
    this.#observer = observer;
    this.#painter = new Painter(around.requestFrame, (startedMs) => this.#painted(startedMs));
    const stopVisibility = around.onVisibility(() => this.#visibilityChanged());
    const timer = setInterval(() => this.#tick(), tickMs);
    this.#release = () => {
      stopVisibility();
      clearInterval(timer);
    };
    void this.#connect();
  }

  lastBlockAt(rig: string): Instant | undefined {
    return this.#lastBlockOf(rig).shown.value;
  }

  subscribe(topics: readonly string[]): () => void {
    const entry = { topics: [...topics] };
    this.#wanted.add(entry);
    this.#topicsChanged();
    return () => {
      if (this.#wanted.delete(entry)) this.#topicsChanged();
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

  checkLogin(): void {
    void this.#connect();
  }

  close(): void {
    this.#drop();
    this.#release();
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
    else if (me.isFleet && this.#around.clinic === undefined) this.#enter('fleet');
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
    socket.onmessage = (message) => ifPresent(() => this.#receive(message.data))();
    this.#receivedMs = performance.now();
    this.#socket = socket;
  }

  /** Closes the connection without changing the state that pages see. */
  #drop(): void {
    this.#attempt += 1;
    this.#socket?.close();
    this.#socket = undefined;
    this.#isWelcome = false;
    this.#isSubscribed = false;
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
    if (this.#socket?.readyState !== WebSocket.OPEN) return; // onclose reports the end
    this.#socket.send(toBinary(FromBrowserSchema, create(FromBrowserSchema, { body })));
  }

  #probe(): void {
    this.#probedMs = performance.now();
    this.#post({ case: 'clockProbe', value: { browserMs: this.#probedMs } });
  }

  #tick(): void {
    const nowMs = performance.now();
    // If this tab itself was stopped, messages wait behind this tick: the silence came from the tab.
    const isLate = nowMs - this.#tickedMs > 2 * tickMs;
    if (isLate) this.#receivedMs = Math.max(this.#receivedMs, nowMs - askAfterMs);
    this.#tickedMs = nowMs;
    if (isLate) setTimeout(() => this.#runTick()); // after those messages, so that ages are right
    else this.#runTick();
    // The browser delays timers and frames of a hidden tab: they say nothing about the connection.
    if (this.#around.isHidden()) return;
    this.#painter.ask();
    if (this.#socket === undefined) return;
    const isQuiet = nowMs - this.#receivedMs >= askAfterMs;
    if (nowMs - this.#receivedMs >= silenceMs) this.#gone();
    else if (nowMs - this.#probedMs >= (!this.#clock.isKnown ? 0 : isQuiet ? askAfterMs : probeEveryMs)) this.#probe();
  }

  #runTick(): void {
    const nowMs = performance.now();
    for (const { newest, shown } of this.#lastBlocks.values()) shown.value = newest;
    this.#drops.tick(nowMs);
    if (!this.#around.isHidden()) this.#tickHandlers.deliver(tickTopic, nowMs);
  }

  // Subscriptions.

  #topicsChanged(): void {
    if (!this.#isSubscribed) return;
    this.#isSubscribed = false;
    queueMicrotask(() => this.#subscribe()); // several changes of one or two pages become one message
  }

  /** Subscribes once the clock offset is known, so that every block has a time. */
  #subscribe(): void {
    if (!this.#isWelcome || !this.#clock.isKnown || this.#isSubscribed) return;
    this.#isSubscribed = true;
    const topics = this.#around.isHidden() ? [] : [...new Set([...this.#wanted].flatMap((one) => one.topics))];
    this.#post({ case: 'subscribe', value: { topics } });
  }

  #visibilityChanged(): void {
    this.#streams.forget();
    this.#isSubscribed = false;
    this.#subscribe();
    if (this.#around.isHidden()) return;
    this.#receivedMs = performance.now();
    this.#probe();
    this.#painter.ask();
  }

  // Messages.

  #receive(data: unknown): void {
    const startedMs = performance.now();
    this.#receivedMs = startedMs;
    let message: FromGateway;
    try {
      if (!(data instanceof ArrayBuffer)) throw new TypeError('a text message');
      message = fromBinary(FromGatewaySchema, new Uint8Array(data));
      this.#read(message, startedMs);
    } catch (problem) {
      reportError(problem); // not a message of the protocol: reconnect
      this.#gone();
      return;
    }
    this.#observer?.onWork(performance.now() - startedMs);
  }

  #read({ body }: FromGateway, nowMs: number): void {
    switch (body.case) {
      case 'welcome':
        return this.#welcomed(body.value);
      case 'frame':
        return this.#readFrame(body.value);
      case 'clockAnswer':
        if (this.#clock.answered(body.value.browserMs, body.value.hostTimeNs, nowMs)) this.clockErrorMs.value = this.#clock.errorMs;
        return this.#subscribe();
      case 'response':
        return this.#commands.answered(body.value);
      case 'link':
        return this.#daemonIs(body.value);
    }
  }

  #welcomed(welcome: Welcome): void {
    this.#isWelcome = true;
    this.#waitMs = shortestWaitMs;
    this.me.value = { ...this.me.value, user: welcome.user, role: welcome.role };
    this.#drops.forget();
    this.#daemonIs(welcome.link);
    this.#subscribe();
  }

  #daemonIs(link: GatewayToDaemon | undefined): void {
    const isUp = link?.isUp ?? false;
    if (!isUp) this.#streams.forget();
    if (!isUp && this.#around.clinic !== undefined) this.#clock.forget(); // the clinic's computer may have started again
    this.problem.value = asSentence(link?.problem ?? '');
    this.#enter(isUp ? 'up' : 'no-daemon');
  }

  #readFrame(frame: Frame): void {
    this.#newestFrame = frame.number;
    this.#drops.count(Number(frame.droppedBlocksTotal), Number(frame.droppedScansTotal), Number(frame.droppedEventsTotal), performance.now());
    for (const { topic, message } of frame.messages) this.#readMessage(topic, message);
    this.#painter.ask();
  }

  #readMessage(topic: string, bytes: Uint8Array): void {
    if (topic === statusTopic) return this.#learn(fromBinary(StatusSnapshotSchema, bytes));
    const parts = splitTopic(topic);
    if (parts === undefined) return;
    if (eventNames.has(parts.name)) {
      const event = fromBinary(EventSchema, bytes);
      const timeMs = this.#clock.toBrowserMs(event.hostTimeNs ?? 0n);
      this.#eventHandlers.deliver(topic, { topic, rig: parts.rig, kind: parts.name, timeMs, event });
      if (changingNames.has(parts.name)) void this.#askStatus();
      return;
    }
    if (this.#around.isHidden()) return; // painted when the tab is shown again, the block would be old
    const block = this.#streams.check(topic, fromBinary(StreamBlockSchema, bytes));
    if (block === undefined) return;
    this.#lastBlockOf(block.rig).newest = instantNow();
    this.#blockHandlers.deliver(topic, block);
  }

  /** Takes a status unless it is older than the present one: an answer to a command may arrive before an older snapshot. */
  #learn(status: StatusSnapshot): void {
    const known = this.status.peek();
    if (known?.instanceId === status.instanceId && status.hostTimeNs < known.hostTimeNs) return;
    this.#streams.learn(status);
    this.status.value = status;
    if (!this.#clock.isKnown) this.#probe(); // a centre knows the clock of a clinic from its first status on
  }

  async #askStatus(): Promise<void> {
    if (this.#isStatusAsked) return;
    this.#isStatusAsked = true;
    const answer = await this.send({ case: 'status', value: {} }).catch(() => undefined); // the next status arrives within a second
    this.#isStatusAsked = false;
    if (answer?.case === 'status') this.#learn(answer.value);
  }

  #lastBlockOf(rig: string): LastBlock {
    const known = this.#lastBlocks.get(rig);
    if (known !== undefined) return known;
    const made: LastBlock = { newest: undefined, shown: signal(undefined) };
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
