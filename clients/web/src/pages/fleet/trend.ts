// SPDX-License-Identifier: Apache-2.0
// The lines and the table of a trend.
import type { TrendPoint } from './asking';
import type { PlotLine } from './line_plot';

export interface TrendRow {
  readonly clinic: string;
  readonly weekMs: number;
  readonly count: number;
  readonly low: number;
  readonly median: number;
  readonly high: number;
}

export const rowOf = ([clinic, weekMs, count, low, median, high]: TrendPoint): TrendRow => ({ clinic, weekMs, count, low, median, high });

const byClinic = (points: readonly TrendPoint[]): Map<string, TrendRow[]> => {
  const clinics = new Map<string, TrendRow[]>();
  for (const row of points.map(rowOf)) clinics.set(row.clinic, [...(clinics.get(row.clinic) ?? []), row]);
  return clinics;
};

export interface TrendLines {
  readonly timesMs: readonly number[];
  readonly lines: readonly PlotLine[];
  /** Number of clinics, including those without a line. */
  readonly clinics: number;
}

/** Returns a line for each of the `most` clinics with the most results, by name. */
export const linesOf = (points: readonly TrendPoint[], most: number): TrendLines => {
  const clinics = [...byClinic(points)].map(([name, rows]) => ({ name, rows, count: rows.reduce((sum, row) => sum + row.count, 0) }));
  const drawn = [...clinics].sort((one, other) => other.count - one.count).slice(0, most).sort((one, other) => one.name.localeCompare(other.name));
  const timesMs = [...new Set(drawn.flatMap(({ rows }) => rows.map(({ weekMs }) => weekMs)))].sort((one, other) => one - other);
  const lines = drawn.map(({ name, rows }) => {
    const medians = new Map(rows.map(({ weekMs, median }) => [weekMs, median]));
    return { name, values: timesMs.map((ms) => medians.get(ms) ?? null) };
  });
  return { timesMs, lines, clinics: clinics.length };
};

/** Returns all weeks of one clinic, newest first; of several clinics, the newest week of each. */
export const tableOf = (points: readonly TrendPoint[]): readonly TrendRow[] => {
  const clinics = [...byClinic(points).values()].map((rows) => [...rows].sort((one, other) => other.weekMs - one.weekMs));
  return clinics.length === 1 ? clinics[0]! : clinics.map((rows) => rows[0]!).sort((one, other) => one.clinic.localeCompare(other.clinic));
};
