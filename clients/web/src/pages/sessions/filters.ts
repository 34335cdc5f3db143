// SPDX-License-Identifier: Apache-2.0
import type { SessionPart, SessionRecord } from '../../generated/dts/v1/sessions_pb';

export interface Filters {
  readonly subject: string; // part of the subject ID
  readonly protocol: string;
  readonly state: string;
  readonly from: string; // "2026-01-31" in the reader's time zone; empty: any
  readonly to: string;
}

export const noFilters: Filters = { subject: '', protocol: '', state: '', from: '', to: '' };

/** Returns midnight of a day in the reader's time zone. */
const dayStartMs = (day: string, plusDays: number): number => {
  const [year, month, date] = day.split('-').map(Number);
  return new Date(year ?? 0, (month ?? 1) - 1, (date ?? 1) + plusDays).getTime();
};

export const passes = (session: SessionRecord, filters: Filters): boolean => {
  const startedMs = Number(session.startedUtcNs / 1_000_000n);
  return (
    session.subject.toLowerCase().includes(filters.subject.trim().toLowerCase()) &&
    (filters.protocol === '' || session.protocol === filters.protocol) &&
    (filters.state === '' || session.state === filters.state) &&
    (filters.from === '' || startedMs >= dayStartMs(filters.from, 0)) &&
    (filters.to === '' || startedMs < dayStartMs(filters.to, 1))
  );
};

/** Returns whether a part is of the rig that leads the session: the others recorded at the same time. */
export const leads = ({ leadingPart }: SessionPart): boolean => leadingPart === 0;

/** Returns the duration of all parts of the leading rig in s. */
export const durationS = (session: SessionRecord): number => session.parts.filter(leads).reduce((sum, part) => sum + part.durationS, 0);

/** Returns "floor, plate": the rigs of a session, the leading one first. */
export const rigsOf = (session: SessionRecord): string => [...new Set([session.rig, ...session.parts.filter((part) => !leads(part)).map(({ rig }) => rig)])].join(', ');
