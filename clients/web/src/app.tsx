// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';
import { useEffect, useMemo } from 'preact/hooks';

import type { ClosableLink, Link } from './link/types';
import { ChairPage } from './pages/chair/chair_page';
import { FleetLivePage, watchedClinic } from './pages/fleet/live_page';
import { FleetPages } from './pages/fleet/fleet_pages';
import { FloorPage } from './pages/floor/floor_page';
import { HealthPage } from './pages/health/health_page';
import { PatientPage } from './pages/patient/patient_page';
import { SessionsPage } from './pages/sessions/sessions_page';
import { SubjectsPage } from './pages/subjects/subjects_page';
import { LoginPage } from './shell/login_page';
import { path } from './shell/route';
import { Shell } from './shell/shell';

/** Opens a link to the rigs of a clinic. */
export type OpenClinic = (clinic: string) => ClosableLink;

const Page = ({ link }: { link: Link }): JSX.Element => {
  if (link.state.value === 'login') return <LoginPage link={link} />;
  if (link.state.value === 'fleet') return <FleetPages link={link} path={path.value} />;
  switch (path.value[0]) {
    case 'clinics':
      return <FleetLivePage link={link} path={path.value} />;
    case 'chair':
      return <ChairPage link={link} rigName={path.value[1]} />;
    case 'sessions':
    case 'compare':
      return <SessionsPage link={link} path={path.value} />;
    case 'subjects':
      return <SubjectsPage link={link} path={path.value} />;
    case 'health':
      return <HealthPage link={link} />;
    default:
      return <FloorPage link={link} rigName={path.value[1]} />;
  }
};

export const App = ({ link, openClinic }: { link: Link; openClinic: OpenClinic }): JSX.Element => {
  const clinic = link.me.value.isFleet ? watchedClinic(path.value) : undefined;
  const watched = useMemo(() => (clinic === undefined ? undefined : openClinic(clinic)), [clinic]);
  useEffect(() => () => watched?.close(), [watched]);
  const shown = watched ?? link;
  // The patient sees nothing but the task: no tabs, no status line, no keys.
  if (path.value[0] === 'patient' && link.state.value !== 'login' && link.state.value !== 'fleet') return <PatientPage link={link} rigName={path.value[1]} />;
  return (
    <Shell link={link} live={shown}>
      <Page link={shown} />
    </Shell>
  );
};
