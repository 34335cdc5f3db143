// SPDX-License-Identifier: Apache-2.0
import { useSignal } from '@preact/signals';

import type { SubjectRecord } from '../../generated/dts/v1/sessions_pb';
import type { Link } from '../../link/types';
import { strings } from '../../strings';
import type { Asked } from '../sessions/asking';
import { sessionsKey, useAsked } from '../sessions/asking';

const askSubject = async (link: Link, subject: string): Promise<SubjectRecord> => {
  const answer = await link.send({ case: 'showSubject', value: { subject } });
  if (answer.case !== 'subject') throw new Error(strings.sessions.unexpected);
  return answer.value;
};

export interface KeptSubject extends Asked<SubjectRecord> {
  /** Asks again after a change of the own. */
  readonly reload: () => void;
}

/** Asks for a subject, and again after each change of the own and whenever a session starts or ends: its sessions, notes and plan may be others then. */
export const useSubject = (link: Link, subject: string, isErased: boolean): KeptSubject => {
  const changes = useSignal(0);
  const sessions = sessionsKey(link);
  const key = sessions === '' || isErased ? '' : `${subject} ${changes.value} ${sessions}`;
  const asked = useAsked(key, () => askSubject(link, subject)).value;
  return { ...asked, reload: () => void (changes.value += 1) };
};
