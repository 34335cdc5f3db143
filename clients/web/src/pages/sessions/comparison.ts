// SPDX-License-Identifier: Apache-2.0
// Figures of several sessions side by side, as `dtsctl session compare` has them.
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import type { SessionResult } from '../../generated/dts/v1/stream_pb';

export const mostCompared = 12; // more columns than a page is wide

export interface Figure {
  readonly name: string;
  readonly unit: string;
  /** One for each session; undefined: it has none. */
  readonly values: readonly (number | undefined)[];
}

/** What makes values of two sessions not comparable. */
export type Caution =
  | { readonly kind: 'subjects' }
  | { readonly kind: 'unit'; readonly figure: string }
  | { readonly kind: 'uneven'; readonly condition: string }
  | { readonly kind: 'analysis'; readonly condition: string; readonly of: string; readonly one: string; readonly other: string };

export interface Comparison {
  readonly sessions: readonly SessionRecord[]; // oldest first
  readonly figures: readonly Figure[];
  readonly cautions: readonly Caution[];
}

/** A subject's sessions on the rig of the newest that has figures: those of a chair and of a platform have none in common. */
export const comparable = (sessions: readonly SessionRecord[]): SessionRecord[] => {
  const withFigures = sessions.filter((session) => session.results.length > 0);
  const newest = withFigures.reduce<SessionRecord | undefined>(
    (best, session) => (best === undefined || session.startedUtcNs > best.startedUtcNs ? session : best),
    undefined,
  );
  return withFigures.filter((session) => session.rig === newest?.rig);
};

export const difference = (one: number | undefined, other: number | undefined): number | undefined =>
  one === undefined || other === undefined ? undefined : other - one;

/** Of what has a zero of its own and is above it: a share of degrees, or of a negative score, says nothing. */
export const shareOfChange = (figure: Figure, one: number, other: number): number | undefined => {
  const [first, second] = [figure.values[one], figure.values[other]];
  if (first === undefined || second === undefined || !(first > 0) || figure.unit === 'deg') return undefined;
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

/** Nothing else than a number or a word is believed. */
const plain = (details: Details, key: string): number | string | undefined => {
  const value = Object.hasOwn(details, key) ? details[key] : undefined;
  return typeof value === 'number' || (typeof value === 'string' && value.length <= 32) ? value : undefined;
};

const isNear = (one: number | string, other: number | string): boolean =>
  one === other || (typeof one === 'number' && typeof other === 'number' && Math.abs(one - other) < 0.1);

const cautionsOf = (first: SessionResult, other: SessionResult): Caution[] => {
  const cautions: Caution[] = first.unit === other.unit ? [] : [{ kind: 'unit', figure: first.name }];
  const slash = first.name.lastIndexOf('/');
  const condition = slash < 0 ? first.name : first.name.slice(0, slash);
  const [inOne, inOther] = [detailsOf(first), detailsOf(other)];
  for (const of of ['duration_s', 'profile', 'rate_hz']) {
    const [one, two] = [plain(inOne, of), plain(inOther, of)];
    // A mean over trials of several lengths tells no length.
    if (of === 'duration_s' && (one === undefined) !== (two === undefined)) cautions.push({ kind: 'uneven', condition });
    if (one === undefined || two === undefined || isNear(one, two)) continue;
    cautions.push({ kind: 'analysis', condition, of, one: String(one), other: String(two) });
  }
  return cautions;
};

export const compare = (unsorted: readonly SessionRecord[]): Comparison => {
  const sessions = [...unsorted].sort((one, other) => (one.startedUtcNs < other.startedUtcNs ? -1 : 1));
  const firsts = new Map<string, SessionResult>();
  const values = new Map<string, (number | undefined)[]>();
  const cautions = new Map<string, Caution>(); // by what they say: each once
  const caution = (one: Caution): void => void cautions.set(JSON.stringify(one), one);
  sessions.forEach((session, index) => {
    if (session.subject !== sessions[0]?.subject) caution({ kind: 'subjects' });
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
  const figures = [...firsts].map(([name, { unit }]) => ({ name, unit, values: values.get(name) ?? [] }));
  return { sessions, figures, cautions: [...cautions.values()] };
};
