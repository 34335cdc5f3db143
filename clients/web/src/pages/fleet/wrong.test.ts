// SPDX-License-Identifier: Apache-2.0
import { expect, test } from 'vitest';

import type { Clinic, Rig } from './asking';
import { agoText, backlogText, timeText, versionText, wrongTexts } from './wrong';

const rig = (name: string, change: Partial<Rig> = {}): Rig => ({
  rig: name, kind: name, device: 'streaming', session_state: 'idle', nominal_rate_hz: 100, measured_rate_hz: 100, lost_scans: 0, calibration: 'c1',
  calibration_age_d: 20, has_old_calibration: false, is_present: true, ...change,
});
const clinic = (wrong: readonly string[], change: Partial<Clinic> = {}): Clinic => ({
  name: 'kent', title: 'Kent', is_revoked: false, wrong, beat_age_s: 4, clock_offset_s: 0.01, forwarder_version: '0.2.0', has_daemon: true,
  daemon_version: '0.2.0', disk_state: 'fine', disk_free_bytes: 5e11, recordable_s: 3600, backlog_files: 0, backlog_bytes: 0, backlog_age_s: null,
  last_receipt_ms: null, held_files: 0, rigs: [rig('floor'), rig('chair')], ...change,
});

test.each<[string, Clinic, string[]]>([
  ['nothing', clinic([]), []],
  ['no heartbeat', clinic(['no_beat'], { beat_age_s: 45 }), ['No heartbeat for 45.0 s']],
  ['never a heartbeat', clinic(['no_beat'], { beat_age_s: null }), ['No heartbeat yet']],
  ['no daemon', clinic(['no_daemon']), ['dtsd does not answer']],
  ['no device: names the rig', clinic(['no_device'], { rigs: [rig('floor'), rig('chair', { device: 'gone' }), rig('old', { device: 'gone', is_present: false })] }), ['No device: chair']],
  ['disk', clinic(['disk'], { disk_state: 'full' }), ['Disk full']],
  ['losses of two rigs', clinic(['losses'], { rigs: [rig('floor', { lost_scans: 3 }), rig('chair', { lost_scans: 4 })] }), ['7 scans lost: floor, chair']],
  ['held', clinic(['held'], { held_files: 1 }), ['1 recording damaged, not sent']],
  ['backlog', clinic(['backlog'], { backlog_age_s: 3.5 * 86_400 }), ['Oldest recording waits for 3 days']],
  ['calibration: names the old one', clinic(['calibration'], { rigs: [rig('floor', { calibration_age_d: 200.9, has_old_calibration: true }), rig('chair')] }), ['Calibration 200 days old: floor']],
  ['clock', clinic(['clock'], { clock_offset_s: -3.21 }), ['Clock off by 3.2 s']],
  ['version', clinic(['version'], { forwarder_version: '0.1.0', daemon_version: '0.1.0' }), ['Old version 0.1.0']],
  ['two versions', clinic(['version'], { forwarder_version: '0.1.0' }), ['Old version 0.1.0, 0.2.0']],
  ['several, in order', clinic(['no_daemon', 'clock'], { clock_offset_s: 2 }), ['dtsd does not answer', 'Clock off by 2.0 s']],
  ['a word of a newer centre', clinic(['too_hot']), ['too_hot']],
])('wrongTexts.%s', (_, given, expected) => {
  expect(wrongTexts(given)).toEqual(expected);
});

test('wrong.Facts that are unknown are a dash or "never", never 0', () => {
  const unknown = clinic(['no_beat'], { backlog_files: null, backlog_bytes: null, forwarder_version: null, daemon_version: null });

  expect([backlogText(unknown), versionText(unknown), agoText(null), timeText(null)]).toEqual(['–', '–', 'never', '–']);
});

test('wrong.Backlog has files and size', () => {
  expect(backlogText(clinic([]))).toBe('nothing');
  expect(backlogText(clinic([], { backlog_files: 1, backlog_bytes: 2_500_000 }))).toBe('1 recording, 2.5 MB');
});
