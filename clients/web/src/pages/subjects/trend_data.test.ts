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

test('plotOf.The known variation is a band around the first visit', () => {
  const { lines } = plotOf([series({ retest: { percent: 50, source: 'x' } })], () => 'open');

  expect(lines.map(({ values }) => values)).toEqual([
    [8, 9],
    [4, 4],
    [12, 12],
  ]);
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
