// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { expect, test, vi } from 'vitest';

import { StatusSnapshotSchema } from '../../generated/dts/v1/control_pb';
import { SubjectRecordSchema } from '../../generated/dts/v1/sessions_pb';
import { fakeLink, runHook } from '../../testing';
import { useSubject } from './subject_record';

/** A daemon with a subject whose notes the test changes. */
const daemon = () => {
  const { link } = fakeLink([{ rig: { name: 'floor' } }]);
  const notes: string[] = [];
  link.send.mockImplementation(() =>
    Promise.resolve({ case: 'subject', value: create(SubjectRecordSchema, { notes: notes.map((text, index) => ({ number: index + 1, text })) }) }),
  );
  const page = runHook(() => useSubject(link, 'P017', false));
  const shown = async (): Promise<readonly string[] | undefined> => {
    for (let turn = 0; turn < 3; ++turn) {
      page.draw();
      await Promise.resolve();
      await Promise.resolve();
    }
    page.draw();
    return page.now().answer?.notes.map(({ text }) => text);
  };
  return { link, notes, page, shown };
};

test('useSubject.After an own change the subject is asked for again', async () => {
  const { link, notes, page, shown } = daemon();
  expect(await shown()).toEqual([]);
  notes.push('walks with a stick');
  page.now().reload();
  expect(await shown()).toEqual(['walks with a stick']);
  expect(link.send).toHaveBeenCalledTimes(2);
});

test('useSubject.A change by somebody else is shown when a session starts or ends, also after an own change', async () => {
  const { link, notes, page, shown } = daemon();
  await shown();
  notes.push('own');
  page.now().reload();
  await shown();
  notes.push('of a colleague');
  link.status.value = create(StatusSnapshotSchema, { rigs: [{ rig: { name: 'floor' }, session: { sessionId: 's1', state: 2 } }] });
  expect(await shown()).toEqual(['own', 'of a colleague']);
});

test('useSubject.Without a connection nothing is asked, and what was shown stays', async () => {
  const { link, shown } = daemon();
  await shown();
  (link.state as { value: string }).value = 'no-daemon';
  expect(await shown()).toEqual([]);
  expect(vi.mocked(link.send)).toHaveBeenCalledTimes(1);
});
