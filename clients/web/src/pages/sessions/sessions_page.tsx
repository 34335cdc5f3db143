// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { Link } from '../../link/types';
import { ComparePage } from './compare_page';
import { SessionDetail } from './session_detail';
import { SessionList } from './session_list';
import './sessions.css';

/** `path`: ["sessions"], ["sessions", ID], ["compare", ID, ID] or ["compare", "subject", SUBJECT ID]. */
export const SessionsPage = ({ link, path }: { link: Link; path: readonly string[] }): JSX.Element => {
  const [page, first, second] = path;
  if (page === 'compare' && first !== undefined && second !== undefined) {
    const compared = first === 'subject' ? { subject: second } : { ids: [first, second] };
    return <ComparePage key={path.join('/')} link={link} compared={compared} />;
  }
  if (page === 'sessions' && first !== undefined) return <SessionDetail key={first} link={link} sessionId={first} />;
  return <SessionList link={link} />;
};
