// SPDX-License-Identifier: Apache-2.0
// Everything the dashboard says in English, a file for each page. A translation is this folder in another language: sentences with numbers are
// functions that take them as text already in the reader's format (parts/numbers.ts), so that only words and their order live here. Units are
// not translated.
import { chair } from './chair';
import { common } from './common';
import { floor } from './floor';
import { health } from './health';
import { sessions } from './sessions';

export const strings = { common, floor, chair, sessions, health };
