// SPDX-License-Identifier: Apache-2.0
// Plain names of results and units.
import { capitalised, spoken } from '../../parts/names';
import { fixed } from '../../parts/numbers';
import { strings } from '../../strings';

const words = strings.sessions.resultNames;

const wordOf = (key: string): string | undefined => (Object.hasOwn(words.words, key) ? words.words[key] : undefined);

/** "range, front-back" for "RANGE_AP"; a symbol without a plain name is shown with spaces. */
const measureName = (symbol: string): string => {
  const axis = /_(AP|ML|RD|RES)(?=_|$)/.exec(symbol)?.[1];
  const what = axis === undefined ? undefined : wordOf(symbol.replace(`_${axis}`, ''));
  if (axis !== undefined && what !== undefined) return words.alongAxis(what, words.axes[axis] ?? axis);
  return wordOf(symbol) ?? spoken(symbol);
};

/** "feet=two,surface=firm" in words; a label of another protocol is shown as it is. */
const stanceText = (stance: string): string =>
  stance
    .split(',')
    .map((label) => words.labels[label] ?? label.replace('=', ' '))
    .join(', ');

/** "romberg/feet=two" and "eyes-open" in words. */
const conditionName = (condition: string): string => {
  const [first, ...stance] = condition.split('/');
  return first === 'romberg' ? words.romberg(stanceText(stance.join(','))) : (words.conditions[condition] ?? capitalised(spoken(condition)));
};

/** Returns a result's name without the part at its end ("MVELO_part_2"), and the part: each part of a resumed session has its own results. */
export const partsOf = (name: string): { readonly whole: string; readonly part: number } => {
  const found = /^(.*)_part_([2-9]|[1-9]\d{1,5})$/.exec(name);
  return { whole: found?.[1] ?? name, part: Number(found?.[2] ?? 1) };
};

/** Returns the plain name of a result: "Eyes open: range, front-back, part 2" for "eyes-open/RANGE_AP_part_2". */
export const resultName = (name: string): string => {
  const { whole, part } = partsOf(name);
  const slash = whole.lastIndexOf('/');
  const measure = measureName(whole.slice(slash + 1));
  const plain = slash < 0 ? capitalised(measure) : words.ofCondition(conditionName(whole.slice(0, slash)), measure);
  return part > 1 ? words.ofPart(plain, String(part)) : plain;
};

/** Returns the unit as people write it: "mm²" for "mm2", nothing for a plain number. */
export const unitText = (unit: string): string => (Object.hasOwn(words.units, unit) ? (words.units[unit] ?? unit) : unit);

const counted = new Set(['trials', 'targets']);

/** Returns the value with three decimals, a count without. */
export const resultValue = ({ name, value }: { readonly name: string; readonly value: number | undefined }): string => fixed(value, counted.has(partsOf(name).whole) ? 0 : 3);
