// SPDX-License-Identifier: Apache-2.0
// What is wrong with a clinic, in words. The centre decides what is wrong.
import { bytes, duration, fixed, whole } from '../../parts/numbers';
import { strings } from '../../strings';
import type { Clinic, Rig } from './asking';

const daySeconds = 86_400;

/** "12.0 s", "3:20 h", or "3 days". */
export const timeText = (seconds: number | null): string =>
  seconds === null || seconds < 2 * daySeconds ? duration(seconds === null ? undefined : Math.max(0, seconds)) : strings.fleet.days(whole(Math.floor(seconds / daySeconds)));

const namesOf = (rigs: readonly Rig[]): string => rigs.map(({ rig }) => rig).join(', ');

const textOf = (wrong: string, clinic: Clinic): string => {
  const words = strings.fleet.wrong;
  const present = clinic.rigs.filter((rig) => rig.is_present);
  switch (wrong) {
    case 'no_beat':
      return clinic.beat_age_s === null ? words.neverSeen : words.noBeat(timeText(clinic.beat_age_s));
    case 'no_daemon':
      return words.noDaemon;
    case 'no_device':
      return words.noDevice(namesOf(present.filter(({ device }) => device !== 'streaming' && device !== 'waiting')));
    case 'disk':
      return words.disk[clinic.disk_state ?? ''] ?? wrong;
    case 'losses': {
      const losing = present.filter((rig) => rig.lost_scans > 0);
      return words.losses(whole(losing.reduce((sum, rig) => sum + rig.lost_scans, 0)), namesOf(losing));
    }
    case 'held':
      return words.held(whole(clinic.held_files ?? 0));
    case 'backlog':
      return words.backlog(timeText(clinic.backlog_age_s));
    case 'calibration': {
      const old = present.filter((rig) => rig.has_old_calibration);
      return words.calibration(whole(Math.floor(Math.max(...old.map((rig) => rig.calibration_age_d ?? 0)))), namesOf(old));
    }
    case 'clock':
      return words.clock(fixed(Math.abs(clinic.clock_offset_s ?? NaN), 1));
    case 'version':
      return words.version([...new Set([clinic.forwarder_version, clinic.daemon_version])].filter((one) => one !== null && one !== '').join(', '));
    default:
      return wrong; // of a newer centre
  }
};

/** Returns a text for each thing that is wrong, the worst first. */
export const wrongTexts = (clinic: Clinic): readonly string[] => clinic.wrong.map((wrong) => textOf(wrong, clinic));

export const backlogText = ({ backlog_files: files, backlog_bytes: size }: Clinic): string => {
  if (files === null) return strings.common.undefinedValue;
  return files === 0 ? strings.fleet.clinics.noBacklog : strings.fleet.clinics.backlog(whole(files), bytes(size ?? undefined));
};

export const agoText = (seconds: number | null): string => (seconds === null ? strings.fleet.clinics.never : strings.fleet.clinics.ago(timeText(seconds)));

export const diskText = (clinic: Clinic): string => bytes(clinic.disk_free_bytes ?? undefined);

export const versionText = (clinic: Clinic): string =>
  [...new Set([clinic.forwarder_version, clinic.daemon_version])].filter((one) => one !== null && one !== '').join(', ') || strings.common.undefinedValue;
