// SPDX-License-Identifier: Apache-2.0
// Filters of sessions and of trends, as the centre takes them.
export interface SessionFilters {
  readonly clinic: string;
  readonly rig: string;
  readonly protocol: string;
  readonly subject: string;
  readonly since: string; // "2026-01-31" in the reader's time zone; empty: any
}

/** Returns the parameters of a request. */
export const parametersOf = ({ since, subject, ...filters }: SessionFilters): Record<string, string> => {
  const [year, month, date] = since.split('-').map(Number);
  const sinceMs = since === '' ? '' : String(new Date(year ?? 0, (month ?? 1) - 1, date ?? 1).getTime());
  return { ...filters, subject: subject.trim(), since: sinceMs };
};

const yearMs = 365.25 * 86_400_000;

/** Returns when the time of a trend begins, on a full day, so that the same choice is the same request all day; empty: all. */
export const trendSince = (choice: string, nowMs: number): string =>
  choice === 'year' ? String(Math.floor((nowMs - yearMs) / 86_400_000) * 86_400_000) : '';
