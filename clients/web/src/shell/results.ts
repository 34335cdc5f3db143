// SPDX-License-Identifier: Apache-2.0
import type { Link } from '../link/types';

/** Returns whether a page may show results of people. All pages may, except login and health. */
export const hasResults = (link: Pick<Link, 'state'>, path: readonly string[]): boolean => link.state.value !== 'login' && path[0] !== 'health';
