// SPDX-License-Identifier: Apache-2.0
// What the symbols of figures mean.
import { strings } from '../../strings';

/** Of "eyes-open/RANGE_AP": "range, front to back". Undefined for what has no words: the symbol stands for itself. */
export const figureMeaning = (name: string): string | undefined => {
  const { words, axes, of } = strings.sessions.figures;
  const symbol = name.slice(name.lastIndexOf('/') + 1);
  const axis = /_(AP|ML)(?=_|$)/.exec(symbol)?.[1];
  const base = axis === undefined ? symbol : symbol.replace(`_${axis}`, '');
  const what = Object.hasOwn(words, base) ? words[base] : undefined;
  if (what === undefined || axis === undefined) return what;
  return of(what, axes[axis] ?? axis);
};
