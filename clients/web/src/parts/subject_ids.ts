// SPDX-License-Identifier: Apache-2.0
// Subject IDs that people may confuse: "P017" and "p-017" would be two subjects.
import type { Link } from '../link/types';

/** Returns all known subject IDs; none if the daemon does not answer: then there is no note. */
export const askSubjects = async (link: Link): Promise<readonly string[]> => {
  const answer = await link.send({ case: 'listSubjects', value: {} }).catch(() => undefined);
  return answer?.case === 'subjects' ? answer.value.subjects.map(({ subject }) => subject) : [];
};

/** Returns the ID without what people type differently: case, "_", "." and "-". */
const folded = (subject: string): string => subject.replaceAll(/[_.-]/g, '').toLowerCase();

/** Returns a known ID that differs from a new one only by case or punctuation, or "". */
export const similarSubject = (known: readonly string[], entered: string): string =>
  entered === '' || known.includes(entered) ? '' : (known.find((one) => folded(one) === folded(entered)) ?? '');
