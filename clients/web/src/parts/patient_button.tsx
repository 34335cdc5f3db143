// SPDX-License-Identifier: Apache-2.0
// Opens the patient screen of a rig in a window of its own.
import type { JSX } from 'preact';

import { strings } from '../strings';
import { Button } from './controls';

/** "noopener": the window gets a process of its own, so that this page cannot delay its picture. */
const openWindow = (rig: string): void => void window.open(`#/patient/${encodeURIComponent(rig)}`, '_blank', 'popup,noopener,width=1280,height=800');

export const PatientButton = ({ rig }: { rig: string }): JSX.Element => (
  <Button label={strings.patient.open} testId="open-patient" onClick={() => openWindow(rig)} />
);
