// SPDX-License-Identifier: Apache-2.0
import { chair } from './chair';
import { common } from './common';
import { fleet } from './fleet';
import { floor } from './floor';
import { health } from './health';
import { report } from './report';
import { sessions } from './sessions';

export const en = { common, floor, chair, sessions, report, health, fleet };
