// SPDX-License-Identifier: Apache-2.0
// Results of several sessions side by side, as in `dtsctl session compare`.
import type { SessionRecord } from '../../generated/dts/v1/sessions_pb';
import type { SessionResult } from '../../generated/dts/v1/stream_pb';
import { dateTime } from '../../parts/numbers';
import { lossOfSession } from './losses';
import { partsOf } from './result_names';

export const mostCompared = 12; // more columns do not fit the page

export interface ComparedResult {
  readonly name: string;
  readonly unit: string;
  /** One value per session; undefined if a session has none. */
  readonly values: readonly (number | undefined)[];
}

/** A reason why values of two sessions cannot be compared, or only with care. `when`: the start of the session. */
export type Caution =
  | { readonly kind: 'subjects' }
  | { readonly kind: 'rigs' }
  | { readonly kind: 'protocols'; readonly protocols: readonly string[] }
  | { readonly kind: 'lost'; readonly when: string; readonly losses: string }
  | { readonly kind: 'resumed'; readonly when: string }
  | { readonly kind: 'arms' }
  | { readonly kind: 'unit'; readonly result: string }
  | { readonly kind: 'uneven'; readonly condition: string }
  | { readonly kind: 'analysis'; readonly condition: string; readonly of: string; readonly one: string; readonly other: string };

export interface Comparison {
  readonly sessions: readonly SessionRecord[]; // oldest first
  readonly results: readonly ComparedResult[];
  readonly cautions: readonly Caution[];
}

/**
 * Returns a subject's newest sessions with results, on the rig of the newest of them: a chair and a platform have no results in common. `listed` is
 * newest first and has no results; `ask` returns a session with its results. Asks for as many at a time as can be compared, until `signal`.
 */
export const comparable = async (
  listed: readonly SessionRecord[],
  ask: (sessionId: string) => Promise<SessionRecord>,
  signal: AbortSignal,
): Promise<readonly SessionRecord[]> => {
  let found: readonly SessionRecord[] = [];
  for (let begin = 0; begin < listed.length && found.length < mostCompared && !signal.aborted; begin += mostCompared) {
    const group = await Promise.all(listed.slice(begin, begin + mostCompared).map(({ sessionId }) => ask(sessionId)));
    const all = [...found, ...group.filter(({ results }) => results.length > 0)];
    found = all.filter(({ rig }) => rig === all[0]?.rig);
  }
  return found.slice(0, mostCompared);
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

const cautionsOf = (name: string, first: SessionResult, other: SessionResult): Caution[] => {
  const cautions: Caution[] = first.unit === other.unit ? [] : [{ kind: 'unit', result: name }];
  const slash = name.lastIndexOf('/');
  const condition = slash < 0 ? name : name.slice(0, slash);
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
const arm = ({ fields, results }: SessionRecord): string | undefined => (results.some(({ name }) => partsOf(name).whole === 'targets') ? fields['side'] : undefined);

/**
 * Returns the names under which the results of a session are compared. Each part of a resumed session has its own results: if only one part has a
 * result, it is that of the session.
 */
const comparedNames = ({ results }: SessionRecord): readonly string[] => {
  const wholes = results.map(({ name }) => partsOf(name).whole);
  return results.map(({ name }, index) => (wholes.indexOf(wholes[index]!) === wholes.lastIndexOf(wholes[index]!) ? wholes[index]! : name));
};

export const compare = (unsorted: readonly SessionRecord[]): Comparison => {
  const sessions = [...unsorted].sort((one, other) => (one.startedUtcNs < other.startedUtcNs ? -1 : 1));
  const firsts = new Map<string, SessionResult>();
  const values = new Map<string, (number | undefined)[]>();
  const arms = new Set<string>();
  const cautions = new Map<string, Caution>(); // by content, so that each appears once
  const caution = (one: Caution): void => void cautions.set(JSON.stringify(one), one);
  const protocols = [...new Set(sessions.map(({ protocol }) => protocol))];
  if (protocols.length > 1) caution({ kind: 'protocols', protocols });
  sessions.forEach((session, index) => {
    const when = dateTime(session.startedUtcNs);
    const losses = lossOfSession(session);
    const names = comparedNames(session);
    if (session.subject !== sessions[0]?.subject) caution({ kind: 'subjects' });
    if (session.rig !== sessions[0]?.rig) caution({ kind: 'rigs' });
    if (arm(session) !== undefined && arms.add(arm(session)!).size > 1) caution({ kind: 'arms' });
    if (losses !== '') caution({ kind: 'lost', when, losses });
    if (names.some((name) => partsOf(name).part > 1)) caution({ kind: 'resumed', when });
    session.results.forEach((result, at) => {
      const name = names[at]!;
      const first = firsts.get(name);
      if (first === undefined) {
        firsts.set(name, result);
        values.set(name, new Array<number | undefined>(sessions.length).fill(undefined));
      } else {
        cautionsOf(name, first, result).forEach(caution);
      }
      if (Number.isFinite(result.value)) values.get(name)![index] = result.value;
    });
  });
  const results = [...firsts].map(([name, { unit }]) => ({ name, unit, values: values.get(name) ?? [] }));
  return { sessions, results, cautions: [...cautions.values()] };
};
