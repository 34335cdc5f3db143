// SPDX-License-Identifier: Apache-2.0
// What pages see of the daemon. All live data come through this interface; no other part of the dashboard uses a socket.
import type { MessageInitShape } from '@bufbuild/protobuf';
import type { ReadonlySignal } from '@preact/signals';

import type { RequestSchema, Response, StatusSnapshot } from '../generated/dts/v1/control_pb';
import type { Role } from '../generated/dts/v1/options_pb';
import type { Event, StreamFormat } from '../generated/dts/v1/stream_pb';

/** Consecutive scans of one stream. Checked: `columns.length === quality.length`, and every column has `scanCount` values (NaN: undefined). */
export interface Block {
  readonly topic: string; // "floor/cop"
  readonly rig: string;
  readonly stream: string;
  readonly format: StreamFormat; // names and units of the channels
  readonly segment: number;
  readonly firstScan: number;
  readonly scanCount: number;
  readonly rateHz: number;
  /** Time of the first scan in ms of this browser's performance.now(); exact to Link.clockErrorMs. */
  readonly timeMs: number;
  /** Time of the newest scan. */
  readonly newestMs: number;
  readonly columns: readonly Float32Array[];
  readonly quality: Uint8Array; // bits of Quality per channel
  /** Scans missing before this block; 0 for the first block after a subscription. */
  readonly missingScans: number;
  /** A new segment of the device began, or the daemon restarted. */
  readonly isNewSegment: boolean;
}

export interface LiveEvent {
  readonly topic: string; // "floor/marker"
  readonly rig: string;
  readonly kind: string; // "marker"
  readonly timeMs: number; // as in Block
  readonly event: Event;
}

/** 'fleet': the gateway serves a centre, and this link is to no clinic; there are no live data. */
export type LinkState = 'connecting' | 'login' | 'fleet' | 'up' | 'no-daemon' | 'no-gateway';

export interface Me {
  readonly user: string;
  readonly role: Role;
  readonly canLogIn: boolean;
  /** The gateway serves a centre, which can only look. */
  readonly isFleet: boolean;
}

/** A moment by both clocks of this browser. */
export interface Instant {
  readonly atMs: number; // performance.now(), for ages: it never steps
  readonly dateMs: number; // Date.now(), only to show the time of day: somebody may set the computer's clock
}

export const instantNow = (): Instant => ({ atMs: performance.now(), dateMs: Date.now() });

/** What was dropped because the tab was too slow, since it connected. */
export interface Dropped {
  readonly blocks: number;
  readonly scans: number;
  readonly events: number;
  /** Scans of the present slow period, or of one that ended within the last seconds; else 0. */
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

/** The command of a Request in the form that `create` accepts: { case: 'mark', value: { text, rig } }. */
export type Command = NonNullable<MessageInitShape<typeof RequestSchema>['command']>;
export type Answer = Response['result'];

export interface Link {
  readonly state: ReadonlySignal<LinkState>;
  /** When the state began, in ms of Date.now(). */
  readonly since: ReadonlySignal<number>;
  readonly me: ReadonlySignal<Me>;
  /** Why the gateway receives nothing from the daemon; empty: it does, or the reason is not known. */
  readonly problem: ReadonlySignal<string>;
  readonly status: ReadonlySignal<StatusSnapshot | undefined>;
  readonly dropped: ReadonlySignal<Dropped>;
  /** Half the round trip of the best clock probe: the error of all ages. */
  readonly clockErrorMs: ReadonlySignal<number>;
  /** When a block of that rig last arrived; undefined if never. Changes at most 4 times a second. */
  lastBlockAt(rig: string): Instant | undefined;

  /** Subscribes to topic prefixes until the returned function is called. Prefixes of all pages add up; the status always arrives. */
  subscribe(topics: readonly string[]): () => void;
  /** Calls `handler` for every block of a topic (exact) or a prefix that ends in '/'. Returns a function that stops it. */
  onBlock(topic: string, handler: (block: Block) => void): () => void;
  onEvent(topic: string, handler: (event: LiveEvent) => void): () => void;
  /** Calls `handler` once per animation frame with new data, and at least 4 times a second while the browser paints frames. Paint only here. */
  onPaint(handler: (nowMs: number) => void): () => void;
  /** Calls `handler` 4 times a second while the tab is shown, even if no frame is painted. Check ages here. */
  onTick(handler: (nowMs: number) => void): () => void;

  /** Sends a command. Fails with CommandError: the error of daemon or gateway, or no answer in time. */
  send(command: Command): Promise<Answer>;
  logIn(user: string, password: string): Promise<void>; // fails with CommandError
  logOut(): Promise<void>;
  /** Asks again who the user is: the login may have ended. */
  checkLogin(): void;
}

export interface ClosableLink extends Link {
  /** Ends the link for good. */
  close(): void;
}
