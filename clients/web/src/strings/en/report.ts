// SPDX-License-Identifier: Apache-2.0
// The report of a session.
export const report = {
  pdf: 'PDF of all pages',
};
