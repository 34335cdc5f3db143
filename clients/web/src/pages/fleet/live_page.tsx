// SPDX-License-Identifier: Apache-2.0
// The live page of a rig of a clinic: the page of the clinic's own dashboard, without its buttons.
import type { JSX } from 'preact';

import type { Link } from '../../link/types';
import { Notice } from '../../parts/controls';
import { strings } from '../../strings';
import { ChairPage } from '../chair/chair_page';
import { FloorPage } from '../floor/floor_page';
import './fleet.css';

const words = strings.fleet.live;
const kinds = new Set(['floor', 'chair']);

/** Returns the clinic of ["clinics", NAME, "floor" or "chair", RIG]; nothing for other pages. */
export const watchedClinic = ([page, clinic, kind]: readonly string[]): string | undefined =>
  page === 'clinics' && kind !== undefined && kinds.has(kind) ? clinic : undefined;

/** `path`: as in `watchedClinic`. */
export const FleetLivePage = ({ link, path }: { link: Link; path: readonly string[] }): JSX.Element => {
  const [, clinic = '', kind, rig] = path;
  const problem = link.problem.value;
  return (
    <div class="fleet-live">
      <div class="fleet-live-head">
        <a class="sessions-link" href={`#/clinics/${clinic}`} data-testid="back-to-clinic">
          {words.back(clinic)}
        </a>
        <span>{words.lookOnly}</span>
      </div>
      {problem !== '' && <Notice kind="warning" what={problem} testId="clinic-problem" />}
      <div class="fleet-live-page">{kind === 'chair' ? <ChairPage link={link} rigName={rig} /> : <FloorPage link={link} rigName={rig} />}</div>
    </div>
  );
};
