// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from 'vitest';

import { askSize } from './exports';

afterEach(() => vi.unstubAllGlobals());

/** Serves answers in turn; records the requested methods and the bodies that were read. */
const answering = (...answers: readonly { status: number; length?: string; body?: string }[]) => {
  const asked: string[] = [];
  const read: string[] = [];
  const next = [...answers];
  vi.stubGlobal('fetch', async (_url: string, { method = 'GET' }: RequestInit): Promise<Response> => {
    asked.push(method);
    const { status, length, body = '' } = next.shift()!;
    const stream = new ReadableStream<Uint8Array>({
      pull: (controller) => {
        read.push(body);
        controller.enqueue(new TextEncoder().encode(body));
        controller.close();
      },
    }, { highWaterMark: 0 });
    return new Response(method === 'HEAD' ? null : stream, { status, headers: length === undefined ? {} : { 'Content-Length': length } });
  });
  return { asked, read };
};
const ask = (): Promise<number> => askSize('/x', new AbortController().signal);

test('askSize.HeadWithLength is enough', async () => {
  const { asked } = answering({ status: 200, length: '1234' });

  expect(await ask()).toBe(1234);
  expect(asked).toEqual(['HEAD']);
});

test('askSize.HeadWithoutLength: no size, and nothing is downloaded', async () => {
  const { asked } = answering({ status: 200 });

  expect(await ask()).toBeNaN();
  expect(asked).toEqual(['HEAD']);
});

test('askSize.Error is that of the archive', async () => {
  const { asked } = answering({ status: 409 }, { status: 409, body: '{"what": "it is recording", "hint": "stop it"}' });

  await expect(ask()).rejects.toMatchObject({ message: 'It is recording', hint: 'Stop it' });
  expect(asked).toEqual(['HEAD', 'GET']);
});

test('askSize.ErrorThatIsOver: the export that is then sent is not read', async () => {
  const { read } = answering({ status: 503 }, { status: 200, length: '99', body: 'export' });

  expect(await ask()).toBe(99);
  expect(read).toEqual([]);
});
