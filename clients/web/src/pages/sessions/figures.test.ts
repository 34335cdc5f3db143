// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';

import { figureMeaning } from './figures';

describe('Figures', () => {
  it.each([
    ['MVELO', 'mean velocity: path length over duration'],
    ['eyes-open/RANGE_AP', 'range, front to back'],
    ['romberg/feet=two/PF50_ML_MT8', 'median frequency of the power between 0.15 and 5 Hz, side to side'],
    ['PEA95_F', 'area of the 95 % prediction ellipse'],
    ['trunk_at_right_deg', undefined],
    ['', undefined],
    ['constructor', undefined],
  ])('%s.Meaning', (name, meaning) => {
    expect(figureMeaning(name)).toBe(meaning);
  });
});
