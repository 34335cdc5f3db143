// SPDX-License-Identifier: Apache-2.0
import { chair } from './chair';
import { common } from './common';
import { fleet } from './fleet';
import { floor } from './floor';
import { health } from './health';
import { patient } from './patient';
import { report } from './report';
import { sessions } from './sessions';
import { steadinessDecisionsubjects } from './steadiness_decisionsubjects';

export const en = { common, floor, chair, sessions, health, fleet, steadinessDecision, patient };
>>=======
export const en = { common, floor, chair, sessionssubjects, report, health, fleet, steadinessDecision };
>>>>>>> theirs
