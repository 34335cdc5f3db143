// SPDX-License-Identifier: Apache-2.0
// All texts of the dashboard, one folder per language, one file per page. A text that a language lacks fails the build. Sentences with numbers are
// functions; they receive each number as text in the reader's format (parts/numbers.ts). Units are not translated.
import { de } from './de';
import { en } from './en';
import { language } from './language';

export const strings: typeof en = { en, de }[language];
