// SPDX-License-Identifier: Apache-2.0
import type { report as english } from '../en/report';

export const report: typeof english = {
  pdf: 'PDF aller Seiten',
};
