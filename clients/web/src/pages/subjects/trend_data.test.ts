// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import type { TrendSeries } from './trend_data';
import { measuresOf, measureText, plotOf, valueText } from './trend_data';

const point = (day: number, value: number, isComparable = true): TrendSeries['points'][number] => ({
  session: `s${day}`,
  utc_ns: String(BigInt(day) * 86_400_000_000_000n),
  value,
  is_comparable: isComparable,
});
const series = (more: Partial<TrendSeries>): TrendSeries => ({
  rig: 'floor',
  protocol: 'romberg',
  condition: 'eyes-open',
  measure: 'MVELO',
  unit: 'mm/s',
  points: [point(1, 8), point(3, 9)],
  ...more,
});

test('plotOf.Visits without a value are gaps, and other settings are left out', () => {
  const closed = series({ condition: 'eyes-closed', points: [point(1, 5, false), point(2, 11), point(3, 12)] });
  const { timesMs, lines } = plotOf([series({}), closed], ({ condition }) => condition);

  expect(timesMs).toEqual([1, 2, 3].map((day) => day * 86_400_000));
  expect(lines).toEqual([
    { name: 'eyes-open', values: [8, null, 9] },
    { name: 'eyes-closed', values: [null, 11, 12] },
  ]);
});

test('plotOf.The known variation is a band around the first visit: a share of the mean of two visits', () => {
  const { lines } = plotOf([series({ retest: { percent: 65, source: 'x' } })], () => 'Eyes open');
  const [visits, lower, upper] = lines.map(({ values }) => values);

  expect(lines.map(({ name }) => name)).toEqual(['Eyes open', 'Eyes open: lower edge of known variation (65 %)', 'Eyes open: upper edge of known variation (65 %)']);
  expect(visits).toEqual([8, 9]);
  for (const edge of [lower, upper]) {
    const [value, same] = edge!;
    expect(same).toBe(value);
    expect(Math.abs(value! - 8) / ((value! + 8) / 2)).toBeCloseTo(0.65);
  }
  expect(lower![0]).toBeLessThan(8);
  expect(upper![0]).toBeGreaterThan(8);
});

test('measuresOf.The usual measures are first', () => {
  const all = ['AREA_CC', 'MVELO', 'PEA95_F', 'RDIST'].map((measure) => series({ measure }));

  expect(measuresOf(all, 'floor romberg')).toEqual(['PEA95_F', 'MVELO', 'AREA_CC', 'RDIST']);
  expect(measuresOf(all, 'chair romberg')).toEqual([]);
});

test('valueText.A trunk class is a word, also between two classes', () => {
  const classes = series({ measure: 'trunk_class', unit: '1' });

  expect(valueText(classes, 1)).toBe('minor');
  expect(valueText(classes, 1.5)).toBe('between minor and moderate');
  expect(valueText(classes, 9)).toBe('9.0');
  expect(measureText('trunk_mean_deg')).toBe('Trunk angle');
});
