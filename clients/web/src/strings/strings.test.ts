// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import { de } from './de';
import { en } from './en';
import { chosen, localeOf } from './language';

type Text = string | ((...words: string[]) => unknown);

/** Returns every text with its place in the catalogue, "common.link.noRig". */
const textsOf = (value: unknown, place = ''): (readonly [string, Text])[] => {
  if (typeof value === 'string' || typeof value === 'function') return [[place, value as Text]];
  return Object.entries(value as object).flatMap(([key, inner]) => textsOf(inner, place === '' ? key : `${place}.${key}`));
};
const english = textsOf(en);
const german = new Map(textsOf(de));

/** Returns the sentence; arguments are replaced by numbers that occur in no text. */
const said = (text: Text): string => (typeof text === 'string' ? text : String(text(...Array.from({ length: 6 }, (_, index) => `${index + 1}00${index + 1}`))));

test('strings.Both languages have the same texts, lists of the same length, and functions where the other has one', () => {
  expect([...german.keys()]).toEqual(english.map(([place]) => place));
  expect(english.filter(([place, text]) => typeof german.get(place) !== typeof text)).toEqual([]);
});

test('strings.A text that is not empty in English is not empty in German', () => {
  expect(english.filter(([place, text]) => said(text) !== '' && said(german.get(place)!) === '').map(([place]) => place)).toEqual([]);
});

test('strings.A German sentence uses the same words from outside as the English one', () => {
  const numbers = (text: Text): string[] => [...new Set(said(text).match(/\d00\d/g) ?? [])].sort();
  const differing = english.filter(([place, text]) => numbers(text).join() !== numbers(german.get(place)!).join());
  expect(differing.map(([place]) => place)).toEqual([]);
});

test('strings.No German text is the English one, except names, signs and words that both languages share', () => {
  const shared = /^(Name|Position \(mm\)|System|Sensor|Signal \(V\)|Text|Export|BIDS \(zip\)|Live|Median|Minimum|Maximum|Version|dtsd|dts-forward|SHA-256|GB|Tab|Esc|Auto)$/;
  const same = english.filter(([place, text]) => {
    const words = said(text).replaceAll(/\d00\d/g, '');
    return said(german.get(place)!) === said(text) && /[a-z]{3}/i.test(words) && !shared.test(words);
  });
  expect(same.map(([place, text]) => `${place}: ${said(text)}`)).toEqual([]);
});

test('language.The stored choice comes first, then the first language of the reader that exists, then English', () => {
  expect(chosen('de', ['en-GB'])).toBe('de');
  expect(chosen(null, ['fr-FR', 'de-AT', 'en'])).toBe('de');
  expect(chosen('toString', ['fr'])).toBe('en');
  expect(chosen(null, [])).toBe('en');
});

test("language.Numbers and dates are in the reader's own locale, if it fits the language", () => {
  expect(localeOf('de', ['en-US', 'de-AT'])).toBe('de-AT');
  expect(localeOf('de', ['en-US'])).toBe('de-DE');
  expect(localeOf('en', ['fr-FR'])).toBe('en-GB');
});
