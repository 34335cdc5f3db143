// SPDX-License-Identifier: Apache-2.0
// The patient screen through a Romberg test with feedback and a session of the reaching task.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, filesBelow, waitFor } from './support.mjs';
import { Bench, by, fixed, remember, rememberedOf, textOf } from './support_browser.mjs';

const shortRomberg = { 'blocks = 2': 'blocks = 1', 'settle_s = 5 ': 'settle_s = 2 ', 'duration_s = 30 ': 'duration_s = 4 ' };
const shortReaching = { 'blocks = 3': 'blocks = 2', 'duration_s = 5': 'duration_s = 4' };
const subject = { sex: 'female', age_years: 52, weight_kg: 70, height_cm: 175, side: 'right', arm_length_cm: 68, max_reach_cm: 125 };
const fields = Object.entries(subject).flatMap(([name, value]) => ['--field', `${name}=${value}`]);
const [high, low] = [880, 440];
const minutesMs = 240_000;

/** Records the frequency of every tone that a page plays. */
const recordTones = () => {
  window.tones = [];
  const { start } = OscillatorNode.prototype;
  OscillatorNode.prototype.start = function (...words) {
    window.tones.push(this.frequency.value);
    return start.apply(this, words);
  };
};

/** Returns whether the canvas has a vermillion dot (#d55e00), which is the centre of pressure. */
const hasDot = (page) =>
  by(page, 'patient-target').evaluate((canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let at = 0; at < data.length; at += 4) count += data[at] > 190 && data[at + 1] < 120 && data[at + 2] < 40 && data[at + 3] > 200 ? 1 : 0;
    return count > 20;
  });

const isState = (page, state) => by(page, 'patient').and(page.locator(`[data-state="${state}"]`));

describe('the patient screen', () => {
  let bench;
  let daemon;
  let gateway;
  let tabs;
  let page;
  before(async () => {
    const protocols = (folder) => {
      alteredProtocol(folder, 'romberg-feedback', shortRomberg);
      alteredProtocol(folder, 'reaching-short', shortReaching);
    };
    bench = await Bench.opened({ daemon: { devices: { 'sim:chair?seed=5': 'sim:chair?seed=5&reaches=cued' }, protocols } });
    ({ daemon, gateway, tabs } = bench);
    await tabs.context.addInitScript(recordTones);
  });
  after(() => bench?.close());

  const startTrial = (rig) => waitFor(() => daemon.ctl('session', 'trial', 'next', '--rig', rig).then(() => true, () => false), `a trial on ${rig}`);

  // requirement: UI-10
  test('opens from the page of a rig, in a window of its own, and shows nothing but the task', async () => {
    const therapist = await tabs.open('floor');
    await by(therapist, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
    const opened = tabs.context.waitForEvent('page');
    await by(therapist, 'open-patient').click();
    page = await opened;
    await isState(page, 'idle').waitFor();

    assert.equal(new URL(page.url()).hash, '#/patient/floor');
    assert.equal(await page.evaluate(() => window.opener), null, 'a window with an opener shares its process');
    assert.equal(await textOf(page, 'patient-word'), 'Welcome');
    for (const testId of ['tab-floor', 'status-line', 'who', 'session-id']) assert.equal(await by(page, testId).count(), 0, testId);
    await therapist.close();
  });

  test('plays no sound before a press', async () => {
    await page.bringToFront();
    assert.equal(await by(page, 'sound').getAttribute('aria-pressed'), 'false');
    await by(page, 'sound').click();
    await by(page, 'sound').and(page.locator('[aria-pressed="true"]')).waitFor();
    assert.deepEqual(await page.evaluate(() => window.tones), [high], 'a press is answered by a tone');
  });

  // requirement: UI-11
  test('a Romberg test: the dot is shown in trials with feedback only, and a tone begins and ends each trial', { timeout: 600_000 }, async () => {
    await remember(page, 'patient', 'data-state');
    const id = (await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg-feedback', '--subject', 'P31')).trim();
    await isState(page, 'wait').waitFor();
    assert.equal(await textOf(page, 'patient-what'), 'Next: Eyes open');
    assert.equal(await hasDot(page), false);
    const shown = [];
    for (const [trial, condition] of ['Eyes open', 'Eyes open, feedback', 'Eyes closed'].entries()) {
      await startTrial('floor');
      await isState(page, 'measure').waitFor();
      const hasFeedback = trial === 1;
      if (hasFeedback) await waitFor(() => hasDot(page), 'the dot is shown');
      shown.push([await textOf(page, 'patient-word'), await textOf(page, 'patient-what'), await textOf(page, 'patient-hint'), await hasDot(page)]);
      assert.equal(await by(page, 'patient-target').getAttribute('data-feedback'), String(hasFeedback));
      await isState(page, trial === 2 ? 'done' : 'rest').waitFor();
      assert.equal(await by(page, 'patient-target').count(), 0, 'no target between trials');
      assert.deepEqual(shown.at(-1), ['Stand still', condition, hasFeedback ? 'Keep the dot in the middle.' : '', hasFeedback]);
    }
    assert.equal(await textOf(page, 'patient-word'), 'Done');
    const states = (await rememberedOf(page, 'patient')).map(({ value }) => value).join(' ');
    assert.equal(states, 'idle wait settle measure rest settle measure rest settle measure done');
    assert.deepEqual(await page.evaluate(() => window.tones), [high, high, low, high, low, high, low]);
    await daemon.ctl('session', 'stop', '--rig', 'floor');
    await isState(page, 'idle').waitFor();

    const session = await daemon.endedSession(id);
    const valueOf = (name) => session.results.find((result) => result.name === name)?.value;
    const [open, closed] = [valueOf('eyes-open/MVELO'), valueOf('eyes-closed/MVELO')];
    assert.ok(valueOf('eyes-open-feedback/MVELO') > 0, 'the trial with feedback has a result of its own');
    assert.ok(Math.abs(valueOf('romberg/feet=two,surface=firm/MVELO') - closed / open) < 1e-9, JSON.stringify(session.results.map(({ name }) => name)));
    assert.equal(session.results.filter(({ name }) => name.startsWith('romberg/') && name.includes('feedback')).length, 0);
    for (const format of ['csv', 'bids']) {
      const folder = path.join(daemon.folder, `export-${format}`);
      await daemon.ctl('session', 'export', id, '--format', format, '--out', folder);
      const events = filesBelow(folder).filter((file) => /events\.(csv|tsv)$/.test(file)).flatMap((file) => readFileSync(file, 'utf8').split('\n'));
      const ofTrial = (condition) => events.filter((line) => line.includes(condition) && line.includes('measure'));
      const feedback = ofTrial('eyes-open-feedback');
      assert.ok(feedback.length > 0 && feedback.every((line) => /"feedback\\?"+: ?"+cop/.test(line)), `${format}: ${feedback[0]}`);
      assert.ok(ofTrial('eyes-closed').every((line) => !line.includes('feedback')), format);
    }
  });

  test('opened in the middle of a trial with feedback, at the address /patient', { timeout: 600_000 }, async () => {
    await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg-feedback', '--subject', 'P31');
    await startTrial('floor');
    await isState(page, 'rest').waitFor();
    await startTrial('floor');
    await isState(page, 'settle').waitFor();
    const late = await tabs.context.newPage();
    await late.goto(`${gateway.url}/patient`);

    await waitFor(async () => (await isState(late, 'measure').count()) > 0 && (await hasDot(late).catch(() => false)), 'the late screen shows the dot');
    assert.equal(await textOf(late, 'patient-what'), 'Eyes open, feedback');
    await isState(late, 'rest').waitFor();
    assert.deepEqual(await late.evaluate(() => window.tones), [], 'nobody has pressed');
    await late.close();
    await daemon.ctl('session', 'stop', '--rig', 'floor');
  });

  test('a reaching session: Go, and after each reach how much the trunk helped', { timeout: 900_000 }, async () => {
    await page.goto(`${gateway.url}/#/patient/chair`);
    await page.reload();
    await isState(page, 'idle').waitFor();
    await remember(page, 'patient', 'data-state');
    await remember(page, 'patient-reach', 'data-class');
    const id = (await daemon.ctl('session', 'start', '--rig', 'chair', '--protocol', 'reaching-short', '--subject', 'P32', ...fields)).trim();
    await isState(page, 'wait').waitFor();
    assert.match(await textOf(page, 'patient-what'), /^Next: /);
    await startTrial('chair');
    await isState(page, 'done').waitFor({ timeout: minutesMs });
    await daemon.ctl('session', 'stop', '--rig', 'chair');
    const { trials } = await daemon.endedSession(id);

    const states = (await rememberedOf(page, 'patient')).map(({ value }) => value).join(' ');
    assert.match(states, /^idle wait (ready go (back )?(rest|done) ?){6}( ?idle)?$/);
    assert.equal(trials.length, 6);
    const classes = ['Your trunk stayed upright', 'Your trunk helped a little', 'Your trunk helped', 'Your trunk helped a lot'];
    const wordOf = ({ result }) => {
      const { movement } = result;
      if (movement === undefined) return 'No reach seen';
      if (movement.trunk_class < 0) return 'Not certain this time';
      const isMinor = movement.trunk_class === 1 && movement.reasons.includes('minor');
      return `${isMinor ? 'Your trunk helped little or not at all' : classes[movement.trunk_class]}, about ${fixed(movement.trunk_deg, 0)}°`;
    };
    const seen = (await rememberedOf(page, 'patient-reach')).filter(({ value }) => value !== '').map(({ text }) => text);
    assert.deepEqual(seen, trials.map(wordOf));
  });

  // requirement: UI-10
  test('without data there is no picture, and it comes back', { timeout: 600_000 }, async () => {
    await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'free', '--subject', 'P31');
    await page.goto(`${gateway.url}/#/patient/floor`);
    await isState(page, 'measure').waitFor();
    await by(page, 'patient-target').waitFor();
    await daemon.kill();

    await isState(page, 'noData').waitFor();
    assert.equal(await by(page, 'patient-target').count(), 0);
    assert.match(await textOf(page, 'patient-hint'), /No data since \d\d:\d\d:\d\d/);
    await daemon.start();
    await isState(page, 'idle').waitFor();
  });

  test('no request went to another host, and nothing violated the policy', () => tabs.close());
});
