// SPDX-License-Identifier: Apache-2.0
import type { JSX } from 'preact';

import type { Link } from '../../link/types';
import '../sessions/sessions.css';
import { SubjectList } from './subject_list';
import { SubjectPage } from './subject_page';

/** `path`: ["subjects"] or ["subjects", SUBJECT ID]. */
export const SubjectsPage = ({ link, path }: { link: Link; path: readonly string[] }): JSX.Element =>
  path[1] === undefined ? <SubjectList link={link} /> : <SubjectPage key={path[1]} link={link} subject={path[1]} />;
