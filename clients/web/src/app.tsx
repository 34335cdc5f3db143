// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { Link } from './link/types';
import { ChairPage } from './pages/chair/chair_page';
import { FleetPages } from './pages/fleet/fleet_pages';
import { FloorPage } from './pages/floor/floor_page';
import { HealthPage } from './pages/health/health_page';
import { SessionsPage } from './pages/sessions/sessions_page';
import { LoginPage } from './shell/login_page';
import { path } from './shell/route';
import { Shell } from './shell/shell';

const Page = ({ link }: { link: Link }): JSX.Element => {
  if (link.state.value === 'login') return <LoginPage link={link} />;
  if (link.state.value === 'fleet') return <FleetPages link={link} path={path.value} />;
  switch (path.value[0]) {
    case 'chair':
      return <ChairPage link={link} />;
    case 'sessions':
    case 'compare':
    case 'subjects':
      return <SessionsPage link={link} path={path.value} />;
    case 'health':
      return <HealthPage link={link} />;
    default:
      return <FloorPage link={link} rigName={path.value[1]} />;
  }
};

export const App = ({ link }: { link: Link }): JSX.Element => (
  <Shell link={link}>
    <Page link={link} />
  </Shell>
);
