// SPDX-License-Identifier: Apache-2.0
import { signal } from '@preact/signals';
import { afterEach, expect, test, vi } from 'vitest';

import { fakeLink, runHook } from '../../testing';
import { useSessionPages } from './session_pages';

afterEach(() => vi.unstubAllGlobals());

/** A centre whose answers the test gives, in any order. `shown`: what the page has after them. */
const centre = () => {
  const requests: { readonly path: string; readonly answer: (response: Response) => void }[] = [];
  vi.stubGlobal('fetch', (path: string) => new Promise<Response>((answer) => requests.push({ path, answer })));
  const query = signal('?clinic=kent');
  const page = runHook(() => useSessionPages(fakeLink().link, query.value));
  const shown = async (): Promise<readonly string[] | undefined> => {
    page.draw();
    await new Promise((resolve) => setTimeout(resolve));
    page.draw();
    return page.now().sessions?.map(({ id }) => id);
  };
  const answer = (index: number, ids: readonly string[], next: string | null = null): void =>
    requests[index]!.answer(new Response(JSON.stringify({ sessions: ids.map((id) => ({ id })), next })));
  const fail = (index: number): void => requests[index]!.answer(new Response('{"what": "no", "hint": ""}', { status: 503 }));
  return { requests, query, page, shown, answer, fail };
};

test('useSessionPages.Two presses load one page', async () => {
  const { requests, page, shown, answer } = centre();
  answer(0, ['k9'], '9');
  expect(await shown()).toEqual(['k9']);

  page.now().loadOlder();
  page.now().loadOlder();
  expect(requests.map(({ path }) => path)).toEqual(['/api/fleet/sessions?clinic=kent', '/api/fleet/sessions?clinic=kent&before=9']);
  answer(1, ['k8'], '8');
  expect(await shown()).toEqual(['k9', 'k8']);

  page.now().loadOlder();
  answer(2, ['k7']);
  expect(await shown()).toEqual(['k9', 'k8', 'k7']);
  expect(page.now().hasOlder).toBe(false);
});

test('useSessionPages.A page of the clinic before is not appended', async () => {
  const { requests, query, page, shown, answer } = centre();
  answer(0, ['k9'], '9');
  await shown();
  page.now().loadOlder();
  query.value = '?clinic=bern';
  await shown();
  page.now().loadOlder(); // the list is still that of Kent
  expect(requests.length).toBe(3);

  answer(2, ['b9'], '5');
  answer(1, ['k8']);
  expect(await shown()).toEqual(['b9']);
  page.now().loadOlder();
  expect(requests[3]!.path).toBe('/api/fleet/sessions?clinic=bern&before=5');
});

test('useSessionPages.After a failed change of the filter nothing is appended to the list before', async () => {
  const { query, page, shown, answer, fail } = centre();
  answer(0, ['k9'], '9');
  await shown();
  query.value = '?clinic=bern';
  await shown();
  fail(1);
  expect(await shown()).toEqual(['k9']);
  expect([page.now().hasOlder, page.now().error?.message]).toEqual([false, 'No']);
});

test('useSessionPages.A page that failed is loaded by the next press', async () => {
  const { page, shown, answer, fail } = centre();
  answer(0, ['k9'], '9');
  await shown();
  page.now().loadOlder();
  fail(1);
  await shown();
  page.now().loadOlder();
  answer(2, ['k8']);
  expect(await shown()).toEqual(['k9', 'k8']);
  expect(page.now().error).toBeUndefined();
});
