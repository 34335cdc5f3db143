// SPDX-License-Identifier: Apache-2.0
// The patient screen through a Romberg test with feedback and a session of the reaching task.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, filesBelow, replaced, waitFor } from './support.mjs';
import { Bench, by, fixed, remember, rememberedOf, textOf } from './support_browser.mjs';

const shortRomberg = { 'blocks = 2': 'blocks = 1', 'settle_s = 5 ': 'settle_s = 2 ', 'duration_s = 30 ': 'duration_s = 8 ' };
const shortReaching = { 'blocks = 3': 'blocks = 2', 'duration_s = 5': 'duration_s = 4' };
const subject = { sex: 'female', age_years: 52, weight_kg: 70, height_cm: 175, side: 'right', arm_length_cm: 68, max_reach_cm: 125 };
const fields = Object.entries(subject).flatMap(([name, value]) => ['--field', `${name}=${value}`]);
const [high, low] = [880, 440];
const minutesMs = 240_000;
const standsAt = { mlMm: 34, apMm: -28 }; // from the middle of the plate: beyond the edge of the picture, and still near enough for the measurement

/** Records the frequency of every tone that a page plays. */
const recordTones = () => {
  window.tones = [];
  const { start } = OscillatorNode.prototype;
  OscillatorNode.prototype.start = function (...words) {
    window.tones.push(this.frequency.value);
    return start.apply(this, words);
  };
};

/** Returns where the vermillion dot (#d55e00) is, which is the centre of pressure: in halves of the picture from its middle. Undefined without a dot. */
const dotOf = (page) =>
  by(page, 'patient-target').evaluate((canvas) => {
    const { width, height } = canvas;
    const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
    let [count, x, y] = [0, 0, 0];
    for (let at = 0; at < data.length; at += 4) {
      if (!(data[at] > 190 && data[at + 1] < 120 && data[at + 2] < 40 && data[at + 3] > 200)) continue;
      count += 1;
      x += (at / 4) % width;
      y += Math.floor(at / 4 / width);
    }
    const half = Math.min(width, height) / 2;
    return count > 20 ? { x: (x / count - width / 2) / half, y: (height / 2 - y / count) / half } : undefined;
  });
const hasDot = async (page) => (await dotOf(page)) !== undefined;

/** The dot is to the right of the middle if the centre of pressure is, and above it if that is in front. */
const assertFollowsTheCop = async (page, watch, middle) => {
  const agreement = [0, 0];
  for (let count = 0; count < 40; ++count) {
    const dot = await dotOf(page);
    const cop = watch.seen.findLast(({ values }) => values !== undefined)?.values.at(-1);
    if (dot !== undefined && Number.isFinite(cop?.[0]) && Number.isFinite(cop?.[1])) {
      for (const [column, shown] of [dot.x, dot.y].entries()) agreement[column] += shown * (cop[column] - Number(middle[column]));
    }
    await page.waitForTimeout(100);
  }
  assert.ok(agreement[0] > 0 && agreement[1] > 0, `neither axis is mirrored: ${agreement}`);
};

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
      const endless = replaced(readFileSync(path.join(folder, 'romberg-feedback.toml'), 'utf8'), {
        'name = "romberg-feedback"': 'name = "endless"',
        'order = "as-listed"': 'order = "as-listed" # each trial until `next`',
        'duration_s = 8 ': 'duration_s = 0 ',
      });
      writeFileSync(path.join(folder, 'endless.toml'), endless);
    };
    const devices = { 'sim:floor?seed=7': `sim:floor?seed=7&x_mm=${standsAt.mlMm}&y_mm=${standsAt.apMm}`, 'sim:chair?seed=5': 'sim:chair?seed=5&reaches=cued' };
    bench = await Bench.opened({ daemon: { devices, protocols } });
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
    // On a busy machine, the page may show that a trial settles only when it is measured already.
    assert.equal(states.replaceAll('settle ', ''), 'idle wait measure rest measure rest measure done');
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
    await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'endless', '--subject', 'P31');
    await startTrial('floor'); // without feedback
    await isState(page, 'measure').waitFor();
    await startTrial('floor'); // ends it
    await isState(page, 'rest').waitFor();
    await startTrial('floor');
    const late = await tabs.context.newPage();
    await late.goto(`${gateway.url}/patient`);

    await waitFor(async () => (await isState(late, 'measure').count()) > 0 && (await hasDot(late).catch(() => false)), 'the late screen shows the dot');
    assert.equal(await textOf(late, 'patient-what'), 'Eyes open, feedback');
    await startTrial('floor'); // ends it
    await isState(late, 'rest').waitFor();
    assert.deepEqual(await late.evaluate(() => window.tones), [], 'nobody has pressed');
    await late.close();
    await daemon.ctl('session', 'stop', '--rig', 'floor');
  });

  // requirement: COP-1
  test('the middle of the feedback is where the person stands, and no gap moves it', { timeout: 600_000 }, async () => {
    const watch = daemon.watch('floor/cop', 'floor/trial');
    await page.bringToFront();
    await remember(page, 'patient-target', 'aria-label');
    await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'endless', '--subject', 'P31');
    await startTrial('floor'); // without feedback
    await isState(page, 'measure').waitFor();
    await startTrial('floor'); // ends it
    await isState(page, 'rest').waitFor();
    await startTrial('floor');
    const middleOf = () => by(page, 'patient-target').evaluate(({ dataset }) => [dataset.mlMm, dataset.apMm]);
    const assertInTheMiddle = async () => {
      await waitFor(() => hasDot(page), 'the dot is shown');
      const dots = [];
      for (let count = 0; count < 30; ++count) {
        dots.push(await dotOf(page));
        await page.waitForTimeout(100);
      }
      const seen = dots.filter((dot) => dot !== undefined);
      const mean = (axis) => seen.reduce((sum, dot) => sum + dot[axis], 0) / seen.length;
      assert.ok(Math.hypot(mean('x'), mean('y')) < 0.5, `a person who stands still is in the middle: on average ${mean('x')}, ${mean('y')}`);
    };
    await isState(page, 'measure').waitFor();
    await assertInTheMiddle();
    await assertFollowsTheCop(page, watch, await middleOf());
    const labels = (await rememberedOf(page, 'patient-target')).map(({ value }) => value);
    assert.deepEqual(labels.slice(-2), ['A point to look at', 'Target, and a dot that moves as you sway'], 'no target before its middle is known');

    const middle = await middleOf();
    const began = watch.seen.find(({ event }) => event?.step === 'measure' && event.trial === 2).first_scan;
    const scans = watch.seen.filter(({ values }) => values !== undefined).flatMap(({ first_scan: first, values }) => values.map((value, index) => [first + index, value]));
    const settled = scans.filter(([scan]) => scan >= began - 100 && scan < began).map(([, value]) => value); // 1 s
    assert.equal(settled.length, 100);
    for (const [column, shown] of middle.entries()) {
      const mean = settled.reduce((sum, value) => sum + value[column], 0) / settled.length;
      assert.ok(Math.abs(Number(shown) - mean) < 0.2, `${shown} mm, recorded ${mean} mm`);
    }
    assert.ok(Math.hypot(Number(middle[0]) - standsAt.mlMm, Number(middle[1]) - standsAt.apMm) < 12, `${middle} is where the person stands`);

    await gateway.kill();
    await isState(page, 'noData').waitFor();
    await gateway.restart();
    await isState(page, 'measure').waitFor();
    await assertInTheMiddle();
    assert.deepEqual(await middleOf(), middle);
    await daemon.ctl('session', 'stop', '--rig', 'floor');
    await isState(page, 'idle').waitFor();
    await watch.close();
  });

  test('a reaching session: Go, and after each reach how much the trunk helped', { timeout: 900_000 }, async () => {
    await page.goto(`${gateway.url}/#/patient/chair`);
    await page.reload();
    await isState(page, 'idle').waitFor();
    await remember(page, 'patient', 'data-state');
    await remember(page, 'patient-reach', 'data-class');
    const watch = daemon.watch('chair/class');
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
    /** What the screen said after the trial: with the class of that moment. The catalogue has it again on the subject's own scale. */
    const wordOf = (movement) => {
      if (movement.trunk_class < 0) return 'Not certain this time';
      const isMinor = movement.trunk_class === 1 && movement.reasons.includes('minor');
      return `${isMinor ? 'Your trunk helped little or not at all' : classes[movement.trunk_class]}, about ${fixed(movement.trunk_deg, 0)}°`;
    };
    const seen = (await rememberedOf(page, 'patient-reach')).filter(({ value }) => value !== '').map(({ text }) => text);
    assert.equal(seen.length, trials.length, seen.join(' | '));
    let before = 0; // number of the reach of the trial before
    for (const [index, { result }] of trials.entries()) {
      const number = result.reach?.number;
      // Until the result of the trial, the screen shows the first reach after Go, which may be another one of the same class.
      const isOfTrial = ({ event }) => event.kind === 'class' && event.number > before && event.number <= number;
      const words = number === undefined ? ['No reach seen'] : watch.seen.filter(isOfTrial).map(({ event }) => wordOf(event));
      assert.ok(words.includes(seen[index]), `trial ${index + 1}: ${seen[index]}; possible: ${words.join(' | ')}`);
      before = number ?? before;
    }
    await watch.close();
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
