// SPDX-License-Identifier: Apache-2.0
// The gateway's document about a subject, and what the page shows of it.
import type { Link } from '../../link/types';
import { CommandError } from '../../link/types';
import { fixed, measured } from '../../parts/numbers';
import { strings } from '../../strings';
import { language } from '../../strings/language';
import type { PlotLine } from '../fleet/line_plot';
import { responseError } from '../sessions/asking';
import { resultName } from '../sessions/result_names';

export interface TrendPoint {
  readonly session: string;
  readonly utc_ns: string;
  readonly value: number;
  readonly sd?: number;
  readonly trials?: number;
  readonly is_comparable: boolean;
}

export interface TrendSeries {
  readonly rig: string;
  readonly protocol: string;
  readonly condition: string;
  readonly measure: string;
  readonly unit: string;
  readonly retest?: { readonly percent: number; readonly source: string };
  readonly points: readonly TrendPoint[];
}

export interface SubjectTrend {
  readonly subject: string;
  readonly series: readonly TrendSeries[];
  readonly words: {
    readonly changes: readonly string[];
    readonly sessions: readonly { readonly session: string; readonly sentences: readonly string[] }[];
  };
}

export const askTrend = async (link: Link, subject: string, signal: AbortSignal): Promise<SubjectTrend> => {
  const response = await fetch(`/api/subjects/${encodeURIComponent(subject)}?language=${language}`, { signal });
  if (response.status === 401) link.checkLogin();
  if (!response.ok) throw await responseError(response);
  const trend = (await response.json()) as SubjectTrend;
  if (!Array.isArray(trend.series)) throw new CommandError(0, strings.sessions.unexpected, '');
  return trend;
};

/** The rig and the protocol of a series: they are chosen together. */
export const groupOf = ({ rig, protocol }: TrendSeries): string => `${rig} ${protocol}`;

const usual = ['PEA95_F', 'MVELO', 'trunk_mean_deg'];

/** Returns the measures of a group, the usual ones first. */
export const measuresOf = (series: readonly TrendSeries[], group: string): readonly string[] => {
  const all = [...new Set(series.filter((one) => groupOf(one) === group).map(({ measure }) => measure))];
  const rank = (measure: string): number => (usual.includes(measure) ? usual.indexOf(measure) : usual.length);
  return all.sort((one, other) => rank(one) - rank(other) || one.localeCompare(other));
};

export const measureText = (measure: string): string => {
  const { names } = strings.subjects.trend;
  const own = Object.hasOwn(names, measure) ? names[measure] : undefined;
  return own === undefined ? resultName(measure) : own.charAt(0).toUpperCase() + own.slice(1);
};

/** Returns a value as text; a trunk class as its word. */
export const valueText = ({ measure }: TrendSeries, value: number): string => {
  const { classes, between } = strings.subjects.trend;
  if (measure !== 'trunk_class') return measured(value);
  const [low, high] = [classes[Math.floor(value)], classes[Math.ceil(value)]];
  if (low === undefined || high === undefined) return fixed(value, 1);
  return low === high ? low : between(low, high);
};

/**
 * Returns a line for each series, and the edges of the known variation around its first comparable visit. The variation is a share of the mean of two
 * visits, so the upper edge is further away: there the mean is larger.
 */
export const plotOf = (series: readonly TrendSeries[], nameOf: (one: TrendSeries) => string): { timesMs: readonly number[]; lines: readonly PlotLine[] } => {
  const { lowerEdge, upperEdge } = strings.subjects.trend;
  const msOf = (point: TrendPoint): number => Number(BigInt(point.utc_ns) / 1_000_000n);
  const shown = series.map((one) => ({ one, points: one.points.filter((point) => point.is_comparable) }));
  const timesMs = [...new Set(shown.flatMap(({ points }) => points.map(msOf)))].sort((one, other) => one - other);
  const lines: PlotLine[] = [];
  for (const { one, points } of shown) {
    const values = new Map(points.map((point) => [msOf(point), point.value]));
    lines.push({ name: nameOf(one), values: timesMs.map((ms) => values.get(ms) ?? null) });
    const first = points[0];
    if (one.retest === undefined || first === undefined) continue;
    const half = one.retest.percent / 100 / 2;
    const percent = fixed(one.retest.percent, 0);
    for (const [edgeName, edge] of [[lowerEdge, (1 - half) / (1 + half)], [upperEdge, (1 + half) / (1 - half)]] as const) {
      lines.push({ name: edgeName(nameOf(one), percent), values: timesMs.map(() => first.value * edge) });
    }
  }
  return { timesMs, lines };
};
