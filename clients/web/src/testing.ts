// SPDX-License-Identifier: Apache-2.0
// For tests: a link that delivers what a test gives it, and hooks without a document.
import { create } from '@bufbuild/protobuf';
import type { MessageInitShape } from '@bufbuild/protobuf';
import { signal } from '@preact/signals';
import { h, options, render } from 'preact';
import { vi } from 'vitest';

import { StatusSnapshotSchema } from './generated/dts/v1/control_pb';
import { EventSchema } from './generated/dts/v1/stream_pb';
import type { Block, Link, LiveEvent } from './link/types';

const liveEvent = (event: MessageInitShape<typeof EventSchema>, timeMs = 0): LiveEvent =>
  ({ timeMs, event: create(EventSchema, event) }) as LiveEvent;

export const fakeLink = (rigs: MessageInitShape<typeof StatusSnapshotSchema>['rigs'] = []) => {
  const handlers = new Set<{ kind: string; topic: string; handler: (message: never) => unknown }>();
  const on = (kind: string, topic: string, handler: (message: never) => unknown) => {
    const entry = { kind, topic, handler };
    handlers.add(entry);
    return () => handlers.delete(entry);
  };
  const of = (kind: string) => [...handlers].filter((entry) => entry.kind === kind);
  const deliver = (kind: string, topic: string, message: unknown): void =>
    of(kind).filter((entry) => topic.startsWith(entry.topic)).forEach(({ handler }) => handler(message as never));
  const link = {
    state: signal('up'),
    me: signal({ user: 'local', role: 2, canLogIn: false, isFleet: false }),
    status: signal(create(StatusSnapshotSchema, { rigs })),
    onBlock: (topic: string, handler: () => void) => on('block', topic, handler),
    onEvent: (topic: string, handler: () => void) => on('event', topic, handler),
    onPaint: (handler: () => void) => on('paint', '', handler),
    subscribe: (topics: readonly string[]) => on('topics', topics.join(' '), () => undefined),
    send: vi.fn(),
  };
  return {
    link: link as unknown as Link & { status: typeof link.status; send: typeof link.send },
    topics: () => of('topics').map(({ topic }) => topic),
    block: (topic: string, columns: readonly (readonly number[])[], more: object = {}) =>
      deliver('block', topic, { segment: 0, firstScan: 0, rateHz: 100, scanCount: columns[0]!.length, timeMs: 0, newestMs: 0, missingScans: 0,
        quality: new Uint8Array(columns.length), columns: columns.map((values) => Float32Array.from(values)), ...more } as unknown as Block),
    event: (topic: string, event: MessageInitShape<typeof EventSchema>, timeMs = 0) => deliver('event', topic, liveEvent(event, timeMs)),
    paint: (nowMs: number) => deliver('paint', '', nowMs),
  };
};

/** Runs a hook in an empty component. `draw` renders changes and runs the effects; with isPainted false, effects never run. */
export const runHook = <Result>(hook: () => Result, isPainted = true): { now: () => Result; draw: () => void } => {
  let result: Result | undefined;
  let rerender = (): void => undefined;
  let effects: (() => void)[] = [];
  options.debounceRendering = (run) => (rerender = run);
  options.requestAnimationFrame = (run) => void (isPainted && effects.push(run));
  vi.stubGlobal('document', {}); // Preact compares with it
  const Page = (): null => {
    result = hook();
    return null;
  };
  render(h(Page, {}), { childNodes: [] } as unknown as Element);
  const draw = (): void => {
    rerender();
    effects.splice(0).forEach((run) => run());
  };
  draw();
  return { now: () => result!, draw };
};
