// SPDX-License-Identifier: Apache-2.0
// All English texts of the dashboard, one file per page. To translate, translate this folder. Sentences with numbers are functions; they receive
// each number as text in the reader's format (parts/numbers.ts). Units are not translated.
import { chair } from './chair';
import { common } from './common';
import { fleet } from './fleet';
import { floor } from './floor';
import { health } from './health';
import { patient } from './patient';
import { sessions } from './sessions';

export const strings = { common, floor, chair, sessions, health, fleet, patient };
