// SPDX-License-Identifier: Apache-2.0
// What the centre reports under /api/fleet, with its names. Times end in _ms (UTC), _s, _d.
import type { ReadonlySignal } from '@preact/signals';
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';

import { ErrorCode } from '../../generated/dts/v1/control_pb';
import type { Link } from '../../link/types';
import { CommandError } from '../../link/types';
import { strings } from '../../strings';
import type { Asked } from '../sessions/asking';
import { responseError, useAsked } from '../sessions/asking';

export interface Rig {
  readonly rig: string;
  readonly kind: string;
  readonly device: string;
  readonly session_state: string;
  readonly nominal_rate_hz: number;
  readonly measured_rate_hz: number | null;
  readonly lost_scans: number;
  readonly calibration: string;
  readonly calibration_age_d: number | null;
  readonly has_old_calibration: boolean;
  readonly is_present: boolean;
}

/** Facts of the newest heartbeat are null if there was none. */
export interface Clinic {
  readonly name: string;
  readonly title: string;
  readonly is_revoked: boolean;
  readonly wrong: readonly string[];
  readonly beat_age_s: number | null;
  readonly clock_offset_s: number | null;
  readonly forwarder_version: string | null;
  readonly has_daemon: boolean | null;
  readonly daemon_version: string | null;
  readonly disk_state: string | null;
  readonly disk_free_bytes: number | null;
  readonly recordable_s: number | null;
  readonly backlog_files: number | null;
  readonly backlog_bytes: number | null;
  readonly backlog_age_s: number | null;
  readonly last_receipt_ms: number | null;
  readonly held_files: number | null;
  readonly rigs: readonly Rig[];
}
export interface Clinics {
  readonly clinics: readonly Clinic[];
}

export interface ClinicDetail {
  readonly clinic: Clinic;
  readonly history: readonly { readonly day: string; readonly largest_backlog_bytes: number }[];
  readonly receipts: readonly {
    readonly session: string;
    readonly part: number;
    readonly bytes: number;
    readonly sha256: string;
    readonly stored_ms: number;
  }[];
}

export interface Session {
  readonly clinic: string;
  readonly id: string;
  readonly rig: string;
  readonly protocol: string;
  readonly subject: string | null;
  readonly label: string | null;
  readonly state: string;
  readonly started_ms: number;
  readonly duration_s: number | null;
  readonly planned_trials: number;
  readonly valid_trials: number | null;
  readonly parts: number;
  readonly stored_parts: number;
}
export interface Sessions {
  readonly sessions: readonly Session[];
  /** Where the next page begins; null: there is none. */
  readonly next: string | null;
}

export interface Measure {
  readonly name: string;
  readonly analysis: string;
  readonly unit: string;
  readonly count: number;
}
export interface Measures {
  readonly measures: readonly Measure[];
  /** Of all sessions. */
  readonly protocols: readonly string[];
}

/** Clinic, start of the week (UTC, ms), number of results, lower quartile, median, upper quartile. */
export type TrendPoint = readonly [string, number, number, number, number, number];
export interface Trend {
  readonly points: readonly TrendPoint[];
}

/** Returns "?clinic=kent&limit=50", without what is empty. */
export const queryOf = (parameters: Readonly<Record<string, string>>): string => {
  const query = new URLSearchParams(Object.entries(parameters).filter(([, value]) => value !== '')).toString();
  return query === '' ? '' : `?${query}`;
};

/** Asks the centre for a page. Fails with CommandError; after the end of the login the link asks who the user is. */
export const askCentre = async <T>(link: Link, path: string, signal: AbortSignal): Promise<T> => {
  let response: Response;
  try {
    response = await fetch(`/api/fleet/${path}`, { cache: 'no-store', signal });
  } catch {
    throw new CommandError(ErrorCode.UNREACHABLE, strings.fleet.unreachable, strings.fleet.unreachableHint);
  }
  if (response.status === 401) link.checkLogin();
  if (!response.ok) throw await responseError(response);
  return (await response.json()) as T;
};

/** A count that rises every `everyMs` while the tab is shown: a key for `useAsked`. */
export const useTurns = (link: Link, everyMs: number): number => {
  const turns = useSignal(0);
  useEffect(() => {
    let turnedMs = performance.now();
    return link.onTick((nowMs) => {
      if (nowMs - turnedMs < everyMs) return;
      turnedMs = nowMs;
      turns.value += 1;
    });
  }, [link, everyMs]);
  return turns.value;
};

const pollMs = 10_000; // as often as heartbeats

/** Asks now, when `path` changes, and every 10 s. */
export const usePolled = <T>(link: Link, path: string): ReadonlySignal<Asked<T>> =>
  useAsked(`${useTurns(link, pollMs)} ${path}`, (signal) => askCentre<T>(link, path, signal));
