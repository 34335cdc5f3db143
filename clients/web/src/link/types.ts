// SPDX-License-Identifier: Apache-2.0
// What pages see of the daemon. Everything live comes from here; nothing else in the dashboard knows a socket.
import type { MessageInitShape } from '@bufbuild/protobuf';
import type { ReadonlySignal } from '@preact/signals';

import type { RequestSchema, Response, RigStatus, StatusSnapshot } from '../generated/dts/v1/control_pb';
import type { Role } from '../generated/dts/v1/options_pb';
import type { Event, StreamFormat } from '../generated/dts/v1/stream_pb';

/** Consecutive scans of one stream, checked: `columns.length === quality.length`, every column has `scanCount` values (NaN: undefined). */
export interface Block {
  readonly topic: string; // "floor/cop"
  readonly rig: string;
  readonly stream: string;
  readonly format: StreamFormat; // names and units of the channels
  readonly segment: number;
  readonly firstScan: number;
  readonly scanCount: number;
  readonly rateHz: number;
  /** Of the first scan, in ms of this browser's performance.now(); the offset is measured, see Link.clockErrorMs. */
  readonly timeMs: number;
  /** Of the newest scan. */
  readonly newestMs: number;
  readonly columns: readonly Float32Array[];
  readonly quality: Uint8Array; // bits of Quality per channel
  /** Scans of this stream missing before this block; 0 for the first one after a subscription. A gap is drawn as a gap. */
  readonly missingScans: number;
  /** A new segment of the device began, or the daemon was restarted. */
  readonly isNewSegment: boolean;
}

export interface LiveEvent {
  readonly topic: string; // "floor/marker"
  readonly rig: string;
  readonly kind: string; // "marker"
  readonly timeMs: number; // as in Block
  readonly event: Event;
}

export type LinkState = 'connecting' | 'login' | 'up' | 'no-daemon' | 'no-gateway';

export interface Me {
  readonly user: string;
  readonly role: Role;
  readonly canLogIn: boolean;
}

/** What a tab did not get because it was too slow, since it connected. */
export interface Dropped {
  readonly blocks: number;
  readonly scans: number;
  readonly events: number;
  /** Of the scans, those of the slowness that goes on or just ended; 0: it is over. */
  readonly scansLately: number;
}

export class CommandError extends Error {
  constructor(
    readonly code: number, // ErrorCode
    what: string,
    readonly hint: string,
  ) {
    super(what);
  }
}

/** The command of a Request, as `create` takes it: { case: 'mark', value: { text, rig } } with init-shaped values. */
export type Command = NonNullable<MessageInitShape<typeof RequestSchema>['command']>;
export type Answer = Response['result'];

export interface Link {
  readonly state: ReadonlySignal<LinkState>;
  /** When the state was entered, Date.now() ms. */
  readonly since: ReadonlySignal<number>;
  readonly me: ReadonlySignal<Me>;
  readonly status: ReadonlySignal<StatusSnapshot | undefined>;
  readonly dropped: ReadonlySignal<Dropped>;
  /** Half the round trip of the best clock probe: ages are exact to this. */
  readonly clockErrorMs: ReadonlySignal<number>;
  /** When anything of that rig's streams last came, Date.now() ms; 0: never. Changes at most 4 times a second. */
  lastBlockAt(rig: string): number;

  /** Topic prefixes this page wants, until the returned function is called. Prefixes of all pages add up; status always comes. */
  subscribe(topics: readonly string[]): () => void;
  /** Called for every block or event of a topic (exact) or topic prefix ending in '/', as it arrives. Returns how to stop. */
  onBlock(topic: string, handler: (block: Block) => void): () => void;
  onEvent(topic: string, handler: (event: LiveEvent) => void): () => void;
  /** Called once per animation frame in which something new came (and at least 4 times a second, while frames come): the only place to paint. */
  onPaint(handler: (nowMs: number) => void): () => void;
  /** Called 4 times a second while the tab is shown, also when no frame is painted: the place to judge ages. */
  onTick(handler: (nowMs: number) => void): () => void;

  /** Sends a command; rejects with CommandError: what the daemon or gateway says, or that no answer came within the time that the protocol allows. */
  send(command: Command): Promise<Answer>;
  logIn(user: string, password: string): Promise<void>; // rejects with CommandError
  logOut(): Promise<void>;
}

export const rigOf = (status: StatusSnapshot | undefined, kind: string): RigStatus | undefined =>
  status?.rigs.find((rig) => rig.rig?.kind === kind);
