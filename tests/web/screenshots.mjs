// SPDX-License-Identifier: Apache-2.0
// Makes the pictures of the dashboard for README.md: node tests/web/screenshots.mjs FOLDER. `scripts/screenshots` builds first.
import assert from 'node:assert/strict';
import { mkdirSync, statSync } from 'node:fs';
import path from 'node:path';

import { Bench, by, goTo } from './support_browser.mjs';
import { pause, waitFor } from './support.mjs';

const folder = process.argv[2];
if (folder === undefined) throw new Error('usage: node tests/web/screenshots.mjs FOLDER');

const minutesMs = 240_000; // for steps of a minute, on a busy machine
const subject = { sex: 'female', age_years: 52, weight_kg: 68, height_cm: 175, side: 'right', arm_length_cm: 67, max_reach_cm: 124 };
const fields = Object.entries(subject).flatMap(([name, value]) => ['--field', `${name}=${value}`]);

/** Takes a picture without the pointer. Fails if the page shows old data, because the machine was too busy. */
const shoot = async (page, name) => {
  const file = path.join(folder, `${name}.png`);
  await page.mouse.move(0, 0);
  await page.screenshot({ path: file, animations: 'disabled' });
  for (const old of ['no-data', 'data-age']) assert.equal(await by(page, old).count(), 0, `${file} shows old data: this machine is too busy`);
  console.log(`${file}: ${Math.round(statSync(file).size / 1024)} KiB`);
};

const startTrial = (daemon, rig) => waitFor(() => daemon.ctl('session', 'trial', 'next', '--rig', rig).then(() => true, () => false), `a first trial on ${rig}`);

/** Takes a picture after twenty seconds of a trial. Returns the ID of the session with that trial. */
const pictureFloor = async ({ daemon, tabs }) => {
  const page = await tabs.open('floor');
  const results = daemon.watch('floor/sway');
  await waitFor(() => results.seen.length > 0, 'a person stands on the plate');
  const id = (await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg', '--subject', 'P017')).trim();
  await startTrial(daemon, 'floor');
  await page.locator('[data-testid="guidance"][data-state="measuring"]').waitFor();
  await pause(22_000);
  await shoot(page, 'live-floor');
  await waitFor(() => results.seen.some(({ event }) => event.trial === 1 && !event.is_preliminary), 'the trial has a result', minutesMs);
  await daemon.ctl('session', 'stop', '--rig', 'floor');
  await page.close();
  return id;
};

/** Takes a picture of the third reach to the farthest target, with the two earlier ones behind it. */
const pictureChair = async ({ daemon, tabs }) => {
  const page = await tabs.open('chair');
  await daemon.ctl('session', 'start', '--rig', 'chair', '--protocol', 'reaching-short', '--subject', 'P021', ...fields);
  await startTrial(daemon, 'chair');
  await page.locator('.chair-prompt-back', { hasText: /Maximum reach.*Trial [789] of 9/s }).waitFor();
  await page.getByRole('heading', { name: 'Trunk class', exact: true }).waitFor(); // and not "Trunk class, last trial"
  await shoot(page, 'live-chair');
  await waitFor(async () => /"phase": *"finished"/.test(await daemon.ctl('status', '--json')), 'all reaches are done', minutesMs);
  await daemon.ctl('session', 'stop', '--rig', 'chair');
  await page.close();
};

const pictureSession = async ({ tabs }, id) => {
  const page = await tabs.open(`sessions/${id}`);
  await by(page, 'report').getByRole('button').nth(1).click(); // the first trial
  await page.frameLocator('[data-testid="report-frame"]').locator('svg').first().waitFor();
  await by(page, 'report-panel').evaluate((panel) => panel.scrollIntoView());
  await shoot(page, 'session');
  await goTo(page, 'health');
  await pause(15_000); // the histogram of latencies fills
  await shoot(page, 'health');
  await page.close();
};

mkdirSync(folder, { recursive: true });
const bench = await Bench.opened();
bench.tabs.context.setDefaultTimeout(minutesMs);
try {
  const id = await pictureFloor(bench);
  await pictureChair(bench);
  await pictureSession(bench, id);
} finally {
  await bench.close();
}
