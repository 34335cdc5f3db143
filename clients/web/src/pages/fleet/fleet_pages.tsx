// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { Link } from '../../link/types';
import '../sessions/sessions.css';
import { ClinicPage } from './clinic_page';
import { ClinicsPage } from './clinics_page';
import './fleet.css';
import { FleetSessionsPage } from './sessions_page';
import { TrendsPage } from './trends_page';

/** `path`: ["clinics"], ["clinics", NAME], ["sessions"], ["sessions", CLINIC] or ["trends"]. */
export const FleetPages = ({ link, path }: { link: Link; path: readonly string[] }): JSX.Element => {
  const [page, clinic] = path;
  if (page === 'sessions') return <FleetSessionsPage key={clinic} link={link} clinic={clinic ?? ''} />;
  if (page === 'trends') return <TrendsPage link={link} />;
  return clinic === undefined ? <ClinicsPage link={link} /> : <ClinicPage key={clinic} link={link} name={clinic} />;
};
