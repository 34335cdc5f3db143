// SPDX-License-Identifier: Apache-2.0
// The language of the page. It is chosen when the page is loaded, because texts are read before anything is drawn; another choice loads it again.

export type Language = 'en' | 'de';

/** Each language in its own words. */
export const languages: Readonly<Record<Language, string>> = { en: 'English', de: 'Deutsch' };

const storedAs = 'dts-language';
const isLanguage = (text: string | null): text is Language => text !== null && Object.hasOwn(languages, text);

/** Returns the stored choice, else the first of the reader's languages that the dashboard has, else English. */
export const chosen = (stored: string | null, readers: readonly string[]): Language =>
  isLanguage(stored) ? stored : (readers.map((one) => one.slice(0, 2).toLowerCase()).find(isLanguage) ?? 'en');

/** Returns the locale of numbers and dates: the reader's own if it fits the language, "de-AT" for German; else what the language has at home. */
export const localeOf = (wanted: Language, readers: readonly string[]): string =>
  readers.find((one) => one.toLowerCase().startsWith(wanted)) ?? { en: 'en-GB', de: 'de-DE' }[wanted];

const readers = typeof navigator === 'undefined' ? [] : (navigator.languages ?? []); // no browser in unit tests

export const language: Language = chosen(typeof localStorage === 'undefined' ? null : localStorage.getItem(storedAs), readers);
export const locale: string = localeOf(language, readers);

/** Keeps the choice in this browser, and loads the page again in that language. */
export const changeLanguage = (wanted: Language): void => {
  localStorage.setItem(storedAs, wanted);
  location.reload();
};
