// SPDX-License-Identifier: Apache-2.0
// Results of several sessions side by side, as in `dtsctl session compare`.
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import type { SessionResult } from '../../generated/dts/v1/stream_pb';

export const mostCompared = 12; // more columns do not fit the page

export interface ComparedResult {
  readonly name: string;
  readonly unit: string;
  /** One value per session; undefined if a session has none. */
  readonly values: readonly (number | undefined)[];
}

/** A reason why values of two sessions cannot be compared. */
export type Caution =
  | { readonly kind: 'subjects' }
  | { readonly kind: 'arms' }
  | { readonly kind: 'unit'; readonly result: string }
  | { readonly kind: 'uneven'; readonly condition: string }
  | { readonly kind: 'analysis'; readonly condition: string; readonly of: string; readonly one: string; readonly other: string };

export interface Comparison {
  readonly sessions: readonly SessionRecord[]; // oldest first
  readonly results: readonly ComparedResult[];
  readonly cautions: readonly Caution[];
}

/** Returns a subject's sessions with results, on the rig of the newest of them: a chair and a platform have no results in common. */
export const comparable = (sessions: readonly SessionRecord[]): SessionRecord[] => {
  const withResults = sessions.filter((session) => session.results.length > 0);
  const newest = withResults.reduce<SessionRecord | undefined>(
    (best, session) => (best === undefined || session.startedUtcNs > best.startedUtcNs ? session : best),
    undefined,
  );
  return withResults.filter((session) => session.rig === newest?.rig);
};

export const difference = (one: number | undefined, other: number | undefined): number | undefined =>
  one === undefined || other === undefined ? undefined : other - one;

/** Returns the change as a share of the first value. None for degrees and for values up to 0: such a share has no meaning. */
export const shareOfChange = (result: ComparedResult, one: number, other: number): number | undefined => {
  const [first, second] = [result.values[one], result.values[other]];
  if (first === undefined || second === undefined || !(first > 0) || result.unit === 'deg') return undefined;
  return (second - first) / first;
};

type Details = Readonly<Record<string, unknown>>;

const detailsOf = (result: SessionResult): Details => {
  try {
    const json: unknown = JSON.parse(result.details);
    return typeof json === 'object' && json !== null && !Array.isArray(json) ? (json as Details) : {};
  } catch {
    return {};
  }
};

/** Returns a number or a short text of the details, and ignores everything else. */
const plain = (details: Details, key: string): number | string | undefined => {
  const value = Object.hasOwn(details, key) ? details[key] : undefined;
  return typeof value === 'number' || (typeof value === 'string' && value.length <= 32) ? value : undefined;
};

const isNear = (one: number | string, other: number | string): boolean =>
  one === other || (typeof one === 'number' && typeof other === 'number' && Math.abs(one - other) < 0.1);

const cautionsOf = (first: SessionResult, other: SessionResult): Caution[] => {
  const cautions: Caution[] = first.unit === other.unit ? [] : [{ kind: 'unit', result: first.name }];
  const slash = first.name.lastIndexOf('/');
  const condition = slash < 0 ? first.name : first.name.slice(0, slash);
  const [inOne, inOther] = [detailsOf(first), detailsOf(other)];
  for (const of of ['duration_s', 'profile', 'rate_hz']) {
    const [one, two] = [plain(inOne, of), plain(inOther, of)];
    // A mean over trials of different durations has no duration.
    if (of === 'duration_s' && (one === undefined) !== (two === undefined)) cautions.push({ kind: 'uneven', condition });
    if (one === undefined || two === undefined || isNear(one, two)) continue;
    cautions.push({ kind: 'analysis', condition, of, one: String(one), other: String(two) });
  }
  return cautions;
};

/** Returns which arm reached; undefined: not known, or a session of standing. */
const arm = ({ fields, results }: SessionRecord): string | undefined => (results.some(({ name }) => /^targets(_part_\d+)?$/.test(name)) ? fields['side'] : undefined);

export const compare = (unsorted: readonly SessionRecord[]): Comparison => {
  const sessions = [...unsorted].sort((one, other) => (one.startedUtcNs < other.startedUtcNs ? -1 : 1));
  const firsts = new Map<string, SessionResult>();
  const values = new Map<string, (number | undefined)[]>();
  const arms = new Set<string>();
  const cautions = new Map<string, Caution>(); // by content, so that each appears once
  const caution = (one: Caution): void => void cautions.set(JSON.stringify(one), one);
  sessions.forEach((session, index) => {
    if (session.subject !== sessions[0]?.subject) caution({ kind: 'subjects' });
    if (arm(session) !== undefined && arms.add(arm(session)!).size > 1) caution({ kind: 'arms' });
    for (const result of session.results) {
      const first = firsts.get(result.name);
      if (first === undefined) {
        firsts.set(result.name, result);
        values.set(result.name, new Array<number | undefined>(sessions.length).fill(undefined));
      } else {
        cautionsOf(first, result).forEach(caution);
      }
      if (Number.isFinite(result.value)) values.get(result.name)![index] = result.value;
    }
  });
  const results = [...firsts].map(([name, { unit }]) => ({ name, unit, values: values.get(name) ?? [] }));
  return { sessions, results, cautions: [...cautions.values()] };
};
