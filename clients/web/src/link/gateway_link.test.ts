// SPDX-License-Identifier: Apache-2.0
import { create, fromBinary, toBinary } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';

import { ErrorCode, StatusSnapshotSchema } from '../generated/dts/v1/control_pb';
import type { FromBrowser } from '../generated/dts/v1/gateway_pb';
import { FromBrowserSchema, FromGatewaySchema } from '../generated/dts/v1/gateway_pb';
import { Role } from '../generated/dts/v1/options_pb';
import { EventSchema, StreamBlockSchema } from '../generated/dts/v1/stream_pb';
import { GatewayLink } from './gateway_link';
import type { Block } from './types';

type Body = NonNullable<MessageInitShape<typeof FromGatewaySchema>['body']>;

/** The gateway's side of a connection. */
class FakeSocket {
  binaryType = '';
  readyState = 0;
  onopen?: () => void;
  onclose?: () => void;
  onmessage?: (message: { data: unknown }) => void;
  readonly received: FromBrowser['body'][] = [];
  send(bytes: Uint8Array): void {
    const { body } = fromBinary(FromBrowserSchema, bytes);
    this.received.push(body);
    if (body.case === 'clockProbe' && answersProbes) this.deliver({ case: 'clockAnswer', value: { browserMs: body.value.browserMs, hostTimeNs: isClockKnown ? hostNs() : 0n } });
  }
  close(): void {
    this.readyState = 3;
  }
  deliver(body: Body): void {
    const bytes = toBinary(FromGatewaySchema, create(FromGatewaySchema, { body }));
    this.onmessage?.({ data: bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength) });
  }
  open(isUp = true): void {
    this.readyState = 1;
    this.onopen?.();
    this.deliver({ case: 'welcome', value: { user: 'local', role: Role.OPERATOR, version: '1', link: { isUp } } });
  }
  all<Case extends NonNullable<FromBrowser['body']['case']>>(name: Case) {
    return this.received.filter((body) => body.case === name).map((body) => body.value) as Extract<FromBrowser['body'], { case: Case }>['value'][];
  }
}

const hostNs = (): bigint => BigInt(Math.round((performance.now() + 1e6) * 1e6));
let sockets: FakeSocket[];
let answersProbes: boolean;
let isClockKnown: boolean; // of the clinic
let role: string;
let isFleet: boolean;
let isHidden: boolean;
let reportVisibility: () => void;
let frames: (() => void)[];

const makeLink = (clinic?: string): GatewayLink =>
  new GatewayLink({
    clinic,
    openSocket: () => {
      const socket = new FakeSocket();
      sockets.push(socket);
      return socket as unknown as WebSocket;
    },
    fetch: async () => ({ ok: true, status: 200, json: async () => ({ user: 'local', role, can_log_in: true, fleet: isFleet }) }) as unknown as Response,
    requestFrame: (callback) => void frames.push(callback),
    isHidden: () => isHidden,
    onVisibility: (handler) => {
      reportVisibility = handler;
      return () => undefined;
    },
  });

const paint = (): void => frames.splice(0).forEach((frame) => frame());
const settle = (): Promise<unknown> => vi.advanceTimersByTimeAsync(0);
const connected = async (): Promise<{ link: GatewayLink; socket: FakeSocket }> => {
  const link = makeLink();
  await settle();
  const socket = sockets.at(-1)!;
  socket.open();
  await settle();
  return { link, socket };
};

const status = toBinary(
  StatusSnapshotSchema,
  create(StatusSnapshotSchema, { instanceId: 1n, rigs: [{ rig: { name: 'floor', streams: [{ name: 'cop', channels: [{ name: 'ml_mm' }] }] } }] }),
);
const copBlock = (firstScan: bigint): Uint8Array =>
  toBinary(
    StreamBlockSchema,
    create(StreamBlockSchema, {
      instanceId: 1n,
      firstScan,
      scanCount: 1,
      channelCount: 1,
      rate: { numerator: 100n, denominator: 1n },
      hostTimeNs: hostNs(),
      values: [4.5],
      quality: new Uint8Array(1),
    }),
  );

beforeEach(() => {
  vi.useFakeTimers({ toFake: ['setTimeout', 'clearTimeout', 'setInterval', 'clearInterval', 'performance', 'Date'] });
  vi.stubGlobal('WebSocket', { OPEN: 1 });
  vi.stubGlobal('reportError', () => undefined);
  [sockets, frames, answersProbes, role, isHidden, isFleet, isClockKnown] = [[], [], true, 'operator', false, false, true];
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test('GatewayLink.Centre has no socket without a clinic', async () => {
  isFleet = true;
  const link = makeLink();
  await settle();

  expect(link.state.value).toBe('fleet');
  expect(sockets).toHaveLength(0);
});

test('GatewayLink.Centre with a clinic is live, until it is closed', async () => {
  isFleet = true;
  const link = makeLink('kent');
  await settle();
  sockets.at(-1)!.open();
  await settle();

  expect(link.state.value).toBe('up');
  link.close();
  expect(sockets.at(-1)!.readyState).toBe(3);
  await vi.advanceTimersByTimeAsync(10_000);
  expect(sockets).toHaveLength(1); // it does not connect again
});

test('GatewayLink.Clinic: subscribes as soon as the first status makes its clock known', async () => {
  [isFleet, isClockKnown] = [true, false];
  const link = makeLink('kent');
  await settle();
  const socket = sockets.at(-1)!;
  socket.open();
  link.subscribe(['floor/cop']);
  await vi.advanceTimersByTimeAsync(1500);
  expect(socket.all('subscribe')).toHaveLength(0);
  expect(socket.all('clockProbe').length).toBeGreaterThan(4); // four times a second

  isClockKnown = true;
  socket.deliver({ case: 'frame', value: { number: 1n, messages: [{ topic: 'dtsd/status', message: status }] } });
  await settle();
  expect(socket.all('subscribe').at(-1)!.topics).toEqual(['floor/cop']);
});

test('GatewayLink.Clinic that is away: the reason, as a sentence', async () => {
  isFleet = true;
  const link = makeLink('kent');
  await settle();
  sockets.at(-1)!.open();
  sockets.at(-1)!.deliver({ case: 'link', value: { isUp: false, problem: 'the clinic is not connected to the centre' } });

  expect(link.state.value).toBe('no-daemon');
  expect(link.problem.value).toBe('The clinic is not connected to the centre');
  sockets.at(-1)!.deliver({ case: 'link', value: { isUp: true } });
  expect(link.problem.value).toBe('');
});

test('GatewayLink.WithoutRole asks for a login and opens no socket', async () => {
  role = 'none';

  const link = makeLink();
  await settle();

  expect(link.state.value).toBe('login');
  expect(sockets).toHaveLength(0);
});

test('GatewayLink.Subscribes once the clock is known, to all topics together', async () => {
  answersProbes = false;
  const link = makeLink();
  link.subscribe(['floor/cop']);
  link.subscribe(['floor/cop', 'floor/sway']);
  await settle();
  const socket = sockets[0]!;
  socket.open();
  await settle();
  const before = socket.all('subscribe').length;

  socket.deliver({ case: 'clockAnswer', value: { browserMs: performance.now(), hostTimeNs: hostNs() } });

  expect(before).toBe(0);
  expect(socket.all('subscribe').map(({ topics }) => topics)).toEqual([['floor/cop', 'floor/sway']]);
});

test('GatewayLink.Block arrives with its time and is painted once', async () => {
  const { link, socket } = await connected();
  const blocks: Block[] = [];
  let paintings = 0;
  link.onBlock('floor/cop', (block) => blocks.push(block));
  link.onPaint(() => (paintings += 1));
  paint();
  paintings = 0;

  const messages = [status, copBlock(0n), copBlock(1n)].map((message, index) => ({ topic: index === 0 ? 'dtsd/status' : 'floor/cop', message }));
  socket.deliver({ case: 'frame', value: { number: 1n, messages } });
  const paintedBefore = socket.all('painted').length;
  paint();

  expect(blocks.map((block) => block.columns[0]![0])).toEqual([4.5, 4.5]);
  expect(blocks[0]!.timeMs).toBeCloseTo(performance.now(), 3);
  expect(paintings).toBe(1);
  expect(paintedBefore).toBe(0);
  expect(socket.all('painted').map(({ frame }) => frame)).toEqual([1n]);
});

test('GatewayLink.HandlerThatFails disturbs neither other handlers nor the connection', async () => {
  const { link, socket } = await connected();
  let received = 0;
  link.onEvent('floor/', () => {
    throw new Error('of a page');
  });
  link.onEvent('floor/', () => (received += 1));

  const message = toBinary(EventSchema, create(EventSchema, { body: { case: 'marker', value: { text: 'x' } } }));
  socket.deliver({ case: 'frame', value: { number: 1n, messages: [{ topic: 'floor/marker', message }] } });

  expect(received).toBe(1);
  expect(link.state.value).toBe('up');
});

test('GatewayLink.SilenceOfTwoSeconds is reported, and a new connection made', async () => {
  const { link, socket } = await connected();
  answersProbes = false;

  await vi.advanceTimersByTimeAsync(2250);
  const reported = link.state.value;
  await vi.advanceTimersByTimeAsync(500);

  expect(reported).toBe('no-gateway');
  expect(socket.readyState).toBe(3);
  expect(sockets).toHaveLength(2);
});

test('GatewayLink.QuietGatewayThatAnswersProbes stays connected', async () => {
  const { link } = await connected();

  await vi.advanceTimersByTimeAsync(60_000);

  expect(link.state.value).toBe('up');
  expect(sockets).toHaveLength(1);
});

test('GatewayLink.Retries slow down to two seconds', async () => {
  makeLink();
  await settle();
  const openedAt: number[] = [];

  for (let attempt = 0; attempt < 6; attempt += 1) {
    openedAt.push(performance.now());
    const before = sockets.length;
    sockets.at(-1)!.onclose?.();
    while (sockets.length === before) await vi.advanceTimersByTimeAsync(50);
  }

  const waits = openedAt.slice(1).map((time, index) => time - openedAt[index]!);
  expect(waits).toEqual([250, 500, 1000, 2000, 2000]);
});

test('GatewayLink.DaemonGone differs from gateway gone', async () => {
  const { link, socket } = await connected();

  socket.deliver({ case: 'link', value: { isUp: false } });
  const down = link.state.value;
  socket.deliver({ case: 'link', value: { isUp: true } });

  expect([down, link.state.value]).toEqual(['no-daemon', 'up']);
});

test('GatewayLink.HiddenTab subscribes to no streams; shown again it subscribes to them again', async () => {
  const { link, socket } = await connected();
  link.subscribe(['floor/cop']);
  await settle();
  const subscriptions = (): string[][] => socket.all('subscribe').map(({ topics }) => topics);

  isHidden = true;
  reportVisibility();
  await vi.advanceTimersByTimeAsync(600_000);
  const whileHidden = [subscriptions().at(-1), sockets.length];
  isHidden = false;
  reportVisibility();

  expect(whileHidden).toEqual([[], 1]);
  expect(subscriptions().at(-1)).toEqual(['floor/cop']);
  expect(link.state.value).toBe('up');
});

test('GatewayLink.Blocks that arrive when the tab is hidden are skipped', async () => {
  const { link, socket } = await connected();
  socket.deliver({ case: 'frame', value: { number: 1n, messages: [{ topic: 'dtsd/status', message: status }] } });
  const scans: number[] = [];
  link.onBlock('floor/cop', (block) => scans.push(block.firstScan));
  const deliverBlock = (scan: bigint): void => socket.deliver({ case: 'frame', value: { number: scan, messages: [{ topic: 'floor/cop', message: copBlock(scan) }] } });

  isHidden = true;
  deliverBlock(5n);
  isHidden = false;
  deliverBlock(9n);

  expect(scans).toEqual([9]);
});

test('GatewayLink.Ticks come without a frame, after what waited behind them, and not in a hidden tab', async () => {
  const { link, socket } = await connected();
  socket.deliver({ case: 'frame', value: { number: 1n, messages: [{ topic: 'dtsd/status', message: status }] } });
  const ages: number[] = [];
  link.onTick((nowMs) => ages.push(nowMs - link.lastBlockAt('floor')!.atMs));
  const deliverBlock = (scan: bigint): void => socket.deliver({ case: 'frame', value: { number: scan, messages: [{ topic: 'floor/cop', message: copBlock(scan) }] } });

  deliverBlock(0n);
  await vi.advanceTimersByTimeAsync(2000);
  const unpainted = [...ages];
  const now = performance.now.bind(performance);
  vi.spyOn(performance, 'now').mockImplementation(() => now() + 5000); // the tab stands still ...
  vi.advanceTimersToNextTimer();
  const beforeMessages = ages.length;
  deliverBlock(1n); // ... and this block waited behind the tick
  await vi.advanceTimersByTimeAsync(1);
  const afterStandstill = ages.slice(beforeMessages);
  vi.restoreAllMocks();
  isHidden = true;
  ages.length = 0;
  await vi.advanceTimersByTimeAsync(2000);

  expect(unpainted).toEqual([250, 500, 750, 1000, 1250, 1500, 1750, 2000]);
  expect(beforeMessages).toBe(unpainted.length);
  expect(afterStandstill).toEqual([1]);
  expect(ages).toEqual([]);
});

test('GatewayLink.Command gets its own answer, or its error with a hint', async () => {
  const { link, socket } = await connected();

  const good = link.send({ case: 'tare', value: { rig: 'floor' } });
  const bad = link.send({ case: 'mark', value: { text: 'x', rig: '' } });
  const [first, second] = socket.all('request').map(({ requestId }) => requestId);
  socket.deliver({ case: 'response', value: { requestId: second!, result: { case: 'error', value: { code: ErrorCode.WRONG_STATE, what: 'no', hint: 'so' } } } });
  socket.deliver({ case: 'response', value: { requestId: first!, result: { case: 'tare', value: { baseline: [1], unit: 'mm' } } } });

  await expect(bad).rejects.toMatchObject({ code: ErrorCode.WRONG_STATE, message: 'No', hint: 'So' });
  expect((await good).case).toBe('tare');
});

test('GatewayLink.CommandWithoutAnswer fails by time or with the connection', async () => {
  const { link, socket } = await connected();
  const late = link.send({ case: 'status', value: {} }).catch((error: unknown) => error);
  const lost = link.send({ case: 'tare', value: { rig: 'floor' } }).catch((error: unknown) => error); // may take 15 s more

  for (let second = 0; second < 10; second += 1) {
    await vi.advanceTimersByTimeAsync(1000);
    socket.deliver({ case: 'link', value: { isUp: true } }); // the gateway is alive
  }
  socket.onclose?.();

  expect(await late).toMatchObject({ code: ErrorCode.TIMEOUT });
  expect(await lost).toMatchObject({ code: ErrorCode.UNREACHABLE });
  await expect(link.send({ case: 'status', value: {} })).rejects.toMatchObject({ code: ErrorCode.UNREACHABLE });
});

test('GatewayLink.InvalidMessage ends the connection', async () => {
  const { link, socket } = await connected();

  socket.onmessage?.({ data: new Uint8Array([255, 255, 255]).buffer });

  expect(link.state.value).toBe('no-gateway');
});

test('GatewayLink.OlderSnapshot does not replace a newer answer; one of another daemon does', async () => {
  const { link, socket } = await connected();
  const deliverStatus = (number: bigint, instanceId: bigint, hostTimeNs: bigint): void => {
    const message = toBinary(StatusSnapshotSchema, create(StatusSnapshotSchema, { instanceId, hostTimeNs }));
    socket.deliver({ case: 'frame', value: { number, messages: [{ topic: 'dtsd/status', message }] } });
  };
  deliverStatus(1n, 1n, 2000n);

  deliverStatus(2n, 1n, 1000n);
  const afterOlder = link.status.value?.hostTimeNs;
  deliverStatus(3n, 2n, 500n);

  expect(afterOlder).toBe(2000n);
  expect(link.status.value?.hostTimeNs).toBe(500n);
});
