// SPDX-License-Identifier: Apache-2.0
import type { en } from '../en';
import { chair } from './chair';
import { common } from './common';
import { fleet } from './fleet';
import { floor } from './floor';
import { health } from './health';
import { report } from './report';
import { sessions } from './sessions';

export const de: typeof en = { common, floor, chair, sessions, report, health, fleet };
