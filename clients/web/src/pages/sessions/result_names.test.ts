// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { resultName, resultValue, unitText } from './result_names';

test.each([
  ['MVELO', 'Mean velocity'],
  ['eyes-open/RANGE_AP', 'Eyes open: range, front-back'],
  ['eyes-closed-two-feet/MSD_RES_1s', 'Eyes closed two feet: mean square displacement after 1 s, both axes'],
  ['romberg/feet=two/PF50_ML_MT8', 'Romberg ratio, eyes closed / open, two feet: median frequency, left-right'],
  ['romberg/MVELO', 'Romberg ratio, eyes closed / open: mean velocity'],
  ['trunk_sd_deg', 'Trunk angle, SD within a target'],
  ['of_a_later_version', 'Of a later version'],
  ['eyes-open/RANGE_AP_part_2', 'Eyes open: range, front-back, part 2'],
  ['targets_part_12', 'Targets, part 12'],
  ['x_part_1', 'X part 1'],
  ['AP_USE', 'Front-back range, share of the foot length'],
  ['', ''],
  ['constructor', 'Constructor'],
])('resultName.%j is %j', (name, expected) => {
  expect(resultName(name)).toBe(expected);
});

test.each([
  ['mm2', 'mm²'],
  ['1', ''],
  ['Hz', 'Hz'],
  ['constructor', 'constructor'],
])('unitText.%j is %j', (unit, expected) => {
  expect(unitText(unit)).toBe(expected);
});

test('resultValue.Counts have no decimals, other values three', () => {
  expect([resultValue({ name: 'trials', value: 9 }), resultValue({ name: 'targets_part_2', value: 3 }), resultValue({ name: 'd2_sd_mm', value: 0.1333 }), resultValue({ name: 'x', value: undefined })]).toEqual(['9', '3', '0.133', '–']);
});
