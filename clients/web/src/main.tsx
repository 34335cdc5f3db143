// SPDX-License-Identifier: Apache-2.0
import { render } from 'preact';

import { App } from './app';
import { thisBrowser } from './link/browser';
import { GatewayLink } from './link/gateway_link';
import { openMeasurement } from './link/measurement';
import { startTheme } from './shell/theme';
import { strings } from './strings';
import { language } from './strings/language';
import './theme.css';
import './shell/shell.css';

document.documentElement.lang = language;
document.title = strings.common.documentTitle;
startTheme();
const measurement = new URLSearchParams(location.search).has('measure') ? openMeasurement() : undefined;
const openLink = (clinic?: string): GatewayLink => {
  const link = new GatewayLink(thisBrowser(clinic), measurement);
  measurement?.watch(link);
  return link;
};
render(<App link={openLink()} openClinic={openLink} />, document.getElementById('app')!);
