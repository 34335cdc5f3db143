// SPDX-License-Identifier: Apache-2.0
import type { en } from '../en';
import { chair } from './chair';
import { common } from './common';
import { fleet } from './fleet';
import { floor } from './floor';
import { health } from './health';
import { patient } from './patient';
import { report } from './report';
import { sessions } from './sessions';
import { steadinessDecision } from './steadiness_decision';
import { subjects } from './subjects';

export const de: typeof en = { common, floor, chair, sessions, subjects, report, health, fleet, steadinessDecision, patient };
