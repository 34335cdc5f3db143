// SPDX-License-Identifier: Apache-2.0
// Numbers and times in the reader's format: the locale sets the decimal sign, never the units.
import { strings } from '../strings';
import { locale } from '../strings/language';

const formats = new Map<string, Intl.NumberFormat>();

const format = (digits: number, sign: 'auto' | 'exceptZero'): Intl.NumberFormat => {
  const key = `${digits} ${sign}`;
  const known = formats.get(key);
  if (known !== undefined) return known;
  const made = new Intl.NumberFormat(locale, { minimumFractionDigits: digits, maximumFractionDigits: digits, signDisplay: sign });
  formats.set(key, made);
  return made;
};

/** Returns "12.3", or a dash for an undefined value, never 0. */
export const fixed = (value: number | undefined, digits: number): string => {
  if (value === undefined || !Number.isFinite(value)) return strings.common.undefinedValue;
  const rounded = Number(value.toFixed(digits));
  return format(digits, 'auto').format(rounded === 0 ? 0 : rounded); // never "-0.0"
};

/** Formats a difference: "+12.3", "-0.4", "0.0". */
export const signed = (value: number | undefined, digits: number): string => {
  if (value === undefined || !Number.isFinite(value)) return strings.common.undefinedValue;
  const rounded = Number(value.toFixed(digits));
  return format(digits, 'exceptZero').format(rounded === 0 ? 0 : rounded);
};

/** Formats with `significant` digits, for measures of any size: 0.0123, 1.23, 123. */
export const measured = (value: number | undefined, significant = 3): string => {
  if (value === undefined || !Number.isFinite(value)) return strings.common.undefinedValue;
  const size = value === 0 ? 0 : Math.floor(Math.log10(Math.abs(value)));
  return fixed(value, Math.min(6, Math.max(0, significant - 1 - size)));
};

export const whole = (value: number | bigint | undefined): string =>
  value === undefined ? strings.common.undefinedValue : format(0, 'auto').format(value);

/** Formats a share of 1 as percent, without the sign "%". */
export const percent = (share: number | undefined, digits = 0): string => fixed(share === undefined ? undefined : 100 * share, digits);

/** Returns "12.4 MB", in powers of 1000 as file managers and disks do. */
export const bytes = (count: number | bigint | undefined): string => {
  if (count === undefined) return strings.common.undefinedValue;
  let value = Number(count);
  if (!Number.isFinite(value) || value < 0) return strings.common.undefinedValue;
  const units = ['B', 'kB', 'MB', 'GB', 'TB'];
  let unit = 0;
  while (value >= 999.5 && unit < units.length - 1) {
    value /= 1000;
    unit += 1;
  }
  return `${fixed(value, unit === 0 || value >= 99.95 ? 0 : 1)} ${units[unit]}`;
};

/** Returns "8.0 s", "2:05 min" or "3:20 h". */
export const duration = (seconds: number | undefined): string => {
  if (seconds === undefined || !Number.isFinite(seconds) || seconds < 0) return strings.common.undefinedValue;
  if (seconds < 99.95) return `${fixed(seconds, 1)} s`;
  const total = Math.round(seconds < 3600 ? seconds : seconds / 60);
  return `${Math.floor(total / 60)}:${String(total % 60).padStart(2, '0')} ${seconds < 3600 ? 'min' : 'h'}`;
};

const time = new Intl.DateTimeFormat(locale, { hour: '2-digit', minute: '2-digit', second: '2-digit' });
const dateAndTime = new Intl.DateTimeFormat(locale, { year: 'numeric', month: '2-digit', day: '2-digit', hour: '2-digit', minute: '2-digit' });

/** Returns "12:03:07" for a Date.now(). */
export const clockTime = (dateMs: number): string => (dateMs > 0 ? time.format(dateMs) : strings.common.undefinedValue);
/** Returns date and minute of a UTC time in ns, or a dash for 0. */
export const dateTime = (utcNs: bigint): string =>
  utcNs > 0n ? dateAndTime.format(Number(utcNs / 1_000_000n)) : strings.common.undefinedValue;

const utcDay = new Intl.DateTimeFormat(locale, { day: 'numeric', month: 'short', year: 'numeric', timeZone: 'UTC' });

/** Returns "23 Nov 2026" for the UTC day at this time in ms: the same day for every reader. */
export const dayUtc = (utcMs: number): string => utcDay.format(utcMs);

const dayAndMonth = new Intl.DateTimeFormat(locale, { day: 'numeric', month: 'short' });
const dayOfYear = new Intl.DateTimeFormat(locale, { day: 'numeric', month: 'short', year: 'numeric' });

/** Returns "23 Nov" for a UTC time in ns, with the year unless it is the present one. */
export const day = (utcNs: bigint): string => {
  if (utcNs <= 0n) return strings.common.undefinedValue;
  const date = new Date(Number(utcNs / 1_000_000n));
  return (date.getFullYear() === new Date().getFullYear() ? dayAndMonth : dayOfYear).format(date);
};
