// SPDX-License-Identifier: Apache-2.0
import { create } from '@bufbuild/protobuf';
import { h } from 'preact';
import { expect, test } from 'vitest';

import type { RigStatus } from '../generated/dts/v1/control_pb';
import { StatusSnapshotSchema } from '../generated/dts/v1/control_pb';
import { fakeLink } from '../testing';
import { RigPage } from './rig_page';

const rigs = [
  { rig: { name: 'plate', kind: 'floor' } },
  { rig: { name: 'left', kind: 'chair' } },
  { rig: { name: 'right', kind: 'chair' } },
];

/** Returns the rigs whose page was shown. */
const shownFor = (kind: 'floor' | 'chair', rigName: string | undefined, isFleet = false): string[] => {
  const { link } = fakeLink(rigs);
  Object.assign(link.me, { value: { ...link.me.value, isFleet } });
  const shown: string[] = [];
  RigPage({ link, kind, rigName, children: (status: RigStatus) => (shown.push(status.rig!.name), h('p', {})) });
  return shown;
};

test('RigPage.Without a name shows the first rig of the kind', () => {
  expect([shownFor('floor', undefined), shownFor('chair', undefined)]).toEqual([['plate'], ['left']]);
});

// requirement: UI-17
test('RigPage.With a name shows that rig or none', () => {
  for (const isFleet of [false, true]) {
    const shown = ['left', 'right', 'gone', 'plate'].map((name) => shownFor('chair', name, isFleet));
    expect(shown).toEqual([['left'], ['right'], [], []]);
    expect(shownFor('floor', 'gone', isFleet)).toEqual([]);
  }
});

test.each<[string, number, string | undefined, readonly string[]]>([
  ['several', 3, 'right', ['#/chair/left', '#/chair/right current']],
  ['several of which none has the name', 3, 'gone', ['#/chair/left', '#/chair/right']],
  ['one that has another name', 2, 'gone', ['#/chair/left']],
  ['one', 2, undefined, []],
])('RigPage.Links of %s', (_, count, rigName, expected) => {
  const { link } = fakeLink();
  link.status.value = create(StatusSnapshotSchema, { rigs: rigs.slice(0, count) });
  const found: string[] = [];
  const look = (node: unknown): void => {
    if (Array.isArray(node)) node.forEach(look);
    if (typeof node !== 'object' || node === null || !('props' in node)) return;
    const { href, children, ...more } = node.props as { href?: string; children?: unknown; 'aria-current'?: string };
    if (href !== undefined) found.push(more['aria-current'] === 'page' ? `${href} current` : href);
    look(children);
  };

  look(RigPage({ link, kind: 'chair', rigName, children: () => h('p', {}) }));

  expect(found).toEqual(expected);
});
