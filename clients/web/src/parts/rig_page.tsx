// SPDX-License-Identifier: Apache-2.0
// The frame of a live page: chooses the rig, and links to the others of its kind.
import type { JSX } from 'preact';

import type { RigStatus } from '../generated/dts/v1/control_pb';
import type { Link } from '../link/types';
import { strings } from '../strings';
import { Notice } from './controls';

interface RigPageProps {
  link: Link;
  kind: 'floor' | 'chair';
  /** Of the address "#/floor/NAME"; undefined: the first rig of the kind. Another rig never replaces a named one: it may measure another person. */
  rigName: string | undefined;
  children: (status: RigStatus) => JSX.Element;
}

export const RigPage = ({ link, kind, rigName, children }: RigPageProps): JSX.Element => {
  const words = strings[kind];
  const status = link.status.value;
  if (status === undefined) return <p class="empty">{strings.common.rigs.waiting}</p>;
  const rigs = status.rigs.filter(({ rig }) => rig?.kind === kind);
  if (rigs.length === 0) return <Notice kind="plain" what={words.noRig} hint={words.noRigHint} testId="no-rig" />;
  const shown = rigName === undefined ? rigs[0] : rigs.find(({ rig }) => rig!.name === rigName);
  const { isFleet } = link.me.value; // a page of the centre has its own links
  const page =
    shown !== undefined ? (
      children(shown)
    ) : (
      <Notice kind="warning" what={words.noRigNamed(rigName ?? '')} hint={isFleet ? '' : strings.common.rigs.choose} testId="no-rig" />
    );
  if (isFleet || (rigs.length === 1 && shown !== undefined)) return page;
  return (
    <div class="rig-page">
      <nav class="row" aria-label={words.rigs}>
        {rigs.map(({ rig }) => (
          <a key={rig!.name} class="tab" href={`#/${kind}/${encodeURIComponent(rig!.name)}`} aria-current={rig === shown?.rig ? 'page' : undefined}>
            {rig!.name}
          </a>
        ))}
      </nav>
      <div class="rig-page-shown">{page}</div>
    </div>
  );
};
