// SPDX-License-Identifier: Apache-2.0
// Makes pictures of the dashboard: node tests/web/screenshots.mjs FOLDER [--all]. `scripts/screenshots` builds first.
// Without --all the five pictures of the documents, else every page in both themes, and on a phone.
import assert from 'node:assert/strict';
import { mkdirSync, statSync } from 'node:fs';
import path from 'node:path';

import { Bench, by, goTo, Tabs } from './support_browser.mjs';
import { Gateway, pause, waitFor } from './support.mjs';

const [folder, option] = process.argv.slice(2);
if (folder === undefined || (option !== undefined && option !== '--all')) throw new Error('usage: node tests/web/screenshots.mjs FOLDER [--all]');
const isAll = option === '--all';

const minutesMs = 240_000; // for steps of a minute, on a busy machine
const subject = { sex: 'female', age_years: 52, weight_kg: 68, height_cm: 175, side: 'right', arm_length_cm: 67, max_reach_cm: 124 };
const fields = Object.entries(subject).flatMap(([name, value]) => ['--field', `${name}=${value}`]);
const phone = { width: 390, height: 844 };
const tablet = { width: 1280, height: 800 };

/** Takes a picture without the pointer, of the page as it is or, with --all, in both themes. */
const shoot = async (page, name) => {
  await page.mouse.move(0, 0);
  for (const scheme of isAll ? ['light', 'dark'] : ['light']) {
    const file = path.join(folder, isAll ? `${name}-${scheme}.png` : `${name}.png`);
    await page.emulateMedia({ colorScheme: scheme });
    await page.screenshot({ path: file, animations: 'disabled' });
    console.log(`${file}: ${Math.round(statSync(file).size / 1024)} KiB`);
  }
};

/** The same for a page with live data. Fails if they are old, because the machine was too busy. */
const shootLive = async (page, name) => {
  await shoot(page, name);
  for (const old of ['no-data', 'data-age']) assert.equal(await by(page, old).count(), 0, `${name} shows old data: this machine is too busy`);
};

/** With --all: a page that only the whole set has. */
const shootMore = async (page, name) => {
  if (isAll) await shoot(page, name);
};

const startTrial = (daemon, rig) => waitFor(() => daemon.ctl('session', 'trial', 'next', '--rig', rig).then(() => true, () => false), `a first trial on ${rig}`);

const onPhone = async (page, name, isReady) => {
  if (!isAll) return;
  await page.setViewportSize(phone);
  await isReady?.();
  await shoot(page, name);
  await page.setViewportSize(tablet);
};

/** Takes a picture after twenty seconds of a trial. Returns the ID of the session with that trial. */
const pictureFloor = async ({ daemon, tabs }) => {
  const page = await tabs.open('floor');
  const results = daemon.watch('floor/sway');
  await waitFor(() => results.seen.length > 0, 'a person stands on the plate');
  await by(page, 'open-start').click();
  await by(page, 'start-protocol').selectOption('romberg');
  await by(page, 'field-weight_kg').fill('5');
  await by(page, 'start-submit').click();
  await shootMore(page, 'start-form');
  await onPhone(page, 'phone-start-form');
  await by(page, 'start-session-close').click();
  const id = (await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg', '--subject', 'P017')).trim();
  await startTrial(daemon, 'floor');
  await page.locator('[data-testid="guidance"][data-state="measuring"]').waitFor();
  await pause(22_000);
  await shootLive(page, 'live-floor');
  await onPhone(page, 'phone-floor');
  await waitFor(() => results.seen.some(({ event }) => event.trial === 1 && !event.is_preliminary), 'the trial has a result', minutesMs);
  if (isAll) {
    await shoot(page, 'live-floor-done');
    await startTrial(daemon, 'floor');
    await page.locator('[data-testid="guidance"][data-state="settling"]').waitFor();
    await page.locator('body').press('x');
    await by(page, 'toast').waitFor();
    await shoot(page, 'live-floor-rejected');
  }
  await daemon.ctl('session', 'stop', '--rig', 'floor');
  await by(page, 'last-session').waitFor();
  await shootMore(page, 'live-floor-after');
  await page.close();
  return id;
};

/** Takes a picture of the patient screen in a trial with feedback. */
const picturePatient = async ({ daemon, tabs }) => {
  const page = await tabs.open('patient/floor');
  await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg-feedback', '--subject', 'P017');
  await startTrial(daemon, 'floor');
  await page.locator('[data-testid="patient"][data-state="rest"]').waitFor({ timeout: minutesMs });
  await shootMore(page, 'patient-rest');
  await startTrial(daemon, 'floor');
  await page.locator('[data-testid="patient"][data-state="measure"]').waitFor();
  await pause(2000);
  await shoot(page, 'patient');
  assert.equal(await by(page, 'patient').getAttribute('data-state'), 'measure', 'this machine is too busy');
  await daemon.ctl('session', 'stop', '--rig', 'floor');
  await page.close();
};

/** Takes a picture of the third reach to the farthest target, with the two earlier ones behind it. */
const pictureChair = async ({ daemon, tabs }) => {
  const page = await tabs.open('chair');
  if (isAll) {
    await by(page, 'open-start').click();
    await by(page, 'start-protocol').selectOption('reaching-short');
    await shoot(page, 'chair-start-form');
    await by(page, 'start-session-close').click();
  }
  await daemon.ctl('session', 'start', '--rig', 'chair', '--protocol', 'reaching-short', '--subject', 'P021', ...fields);
  await startTrial(daemon, 'chair');
  await page.locator('.chair-prompt-back', { hasText: /Maximum reach.*Trial [789] of 9/s }).waitFor();
  await page.getByRole('heading', { name: 'Trunk class', exact: true }).waitFor(); // and not "Trunk class, last trial"
  await shootLive(page, 'live-chair');
  await onPhone(page, 'phone-chair');
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
  await onPhone(page, 'phone-health');
  await page.close();
};

/** The pages around the record of a session. */
const pictureRecords = async ({ daemon, tabs }, id) => {
  await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg', '--subject', 'P017', '--label', 'second');
  await daemon.ctl('session', 'stop', '--rig', 'floor');
  const { sessions } = await daemon.json('session', 'list');
  const page = await tabs.open('sessions');
  await by(page, 'session-row').first().waitFor();
  await shoot(page, 'sessions');
  await onPhone(page, 'phone-sessions');
  await goTo(page, `sessions/${id}`);
  await by(page, 'open-correct').click();
  await by(page, 'correct-label').fill('corrected');
  await by(page, 'correct-reason').fill('typed into the wrong session');
  await shoot(page, 'session-correct');
  await onPhone(page, 'phone-correct');
  await by(page, 'correct-submit').click();
  await by(page, 'correct-saved').waitFor();
  await by(page, 'report-frame').waitFor();
  await shoot(page, 'session-top');
  await onPhone(page, 'phone-session');
  for (const part of ['trials', 'results', 'corrections', 'parts']) {
    await by(page, `${part}-panel`).evaluate((panel) => panel.scrollIntoView());
    await shoot(page, `session-${part}`);
  }
  await goTo(page, `compare/${sessions.find(({ session_id: one, rig }) => one !== id && rig === 'floor').session_id}/${id}`);
  await by(page, 'report-1').or(by(page, 'report-1-error')).first().waitFor();
  await shoot(page, 'compare');
  await goTo(page, 'subjects');
  await by(page, 'subject-row').first().waitFor();
  await shoot(page, 'subjects');
  await goTo(page, 'subjects/P017');
  await by(page, 'open-erase').click();
  await shoot(page, 'subject');
  await onPhone(page, 'phone-subject');
  await by(page, 'show-keys').click();
  await shoot(page, 'keys');
  await page.close();
};

const pictureLogin = async (bench) => {
  const users = path.join(bench.daemon.folder, 'users');
  await Gateway.addUser(users, 'anna', 'operator', 'correct horse battery');
  const gateway = await Gateway.started(bench.daemon, '--users', users);
  const tabs = await Tabs.opened(bench.browser, gateway);
  const page = await tabs.open('floor');
  await by(page, 'login').waitFor();
  await shoot(page, 'login');
  await tabs.close();
  await gateway.close();
};

const pictureDead = async ({ daemon, tabs }) => {
  const page = await tabs.open('floor');
  await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
  await daemon.kill();
  for (const name of ['floor', 'chair']) {
    await goTo(page, name);
    await by(page, 'no-data').waitFor();
    await shoot(page, `dead-${name}`);
  }
  await onPhone(page, 'phone-dead-chair');
  await page.close();
};

mkdirSync(folder, { recursive: true });
const bench = await Bench.opened({ gateway: () => (isAll ? ['--local-role', 'engineer'] : []) });
bench.tabs.context.setDefaultTimeout(minutesMs);
try {
  const id = await pictureFloor(bench);
  await pictureChair(bench);
  await picturePatient(bench);
  await pictureSession(bench, id);
  if (isAll) {
    await pictureRecords(bench, id);
    await pictureLogin(bench);
    await pictureDead(bench);
  }
} finally {
  await bench.close();
}
