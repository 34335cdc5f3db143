// SPDX-License-Identifier: Apache-2.0
// A session of the reaching task with six trials, run only with the keys A, R and X.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, waitFor } from './support.mjs';
import { Bench, by, fixed, remember, rememberedOf, textOf, waitForText } from './support_browser.mjs';

const sixTrials = {
  'blocks = 3': 'blocks = 2',
  'starts_by_itself = true': 'starts_by_itself = false',
  'cue_delay_max_s = 2.0': 'cue_delay_max_s = 1.5',
  'duration_s = 5': 'duration_s = 4',
  'block_rest_s = 2': 'block_rest_s = 0',
  'rest_s = 1': 'rest_s = 0',
};
const subject = { age_years: '52', weight_kg: '70', height_cm: '175', arm_length_cm: '68', max_reach_cm: '125' };
const classes = ['none', 'minor', 'moderate', 'maximum'];

const titles = { 120: '120 %', 150: '150 %', max: 'Maximum reach' };
const shapes = { done: '✓', redone: '↻', rejected: '✕' };

/** Returns the expected row of the page's table for a trial of `dtsctl session show`. Reasons for "uncertain" are not compared. */
const rowOf = ({ trial, attempt, condition, outcome, result }) => {
  const target = result?.target_cm > 0 ? `${titles[condition]}, ${fixed(result.target_cm, 0)}\u00a0cm` : titles[condition];
  const ending = outcome === 'done' && result?.reach === undefined ? '! no reach' : `${shapes[outcome]} ${outcome}`;
  const movement = result?.movement;
  const isMinor = movement?.reasons.includes('minor') && movement.trunk_class === 1;
  const word = movement === undefined ? 'no reach' : isMinor ? 'none or minor' : (classes[movement.trunk_class] ?? 'uncertain');
  const deg = movement?.trunk_class >= 0 ? movement.trunk_deg : null; // without a class no angle is shown
  return [attempt > 1 ? `${trial}.${attempt}` : `${trial}`, target, ending, word, deg === null ? '–' : fixed(deg, 1)];
};

describe('a session of the reaching task', () => {
  let bench;
  let daemon;
  let gateway;
  let tabs;
  let page;
  before(async () => {
    const devices = { 'sim:chair?seed=5': 'sim:chair?seed=5&reaches=cued' };
    bench = await Bench.opened({ daemon: { devices, protocols: (folder) => alteredProtocol(folder, 'reaching-short', sixTrials) } });
    ({ daemon, gateway, tabs } = bench);
    page = await tabs.open('chair');
  });
  after(() => bench?.close());

  const isStep = (step) => by(page, 'prompt').and(page.locator(`[data-step="${step}"]`));

  test('asks for the fields that the protocol requires', async () => {
    await by(page, 'open-start').click();
    await by(page, 'start-protocol').selectOption('reaching-short');
    await by(page, 'start-subject').fill('P6');
    await by(page, 'field-sex').selectOption('female');
    await by(page, 'field-side').selectOption('right');
    for (const [name, value] of Object.entries(subject)) await by(page, `field-${name}`).fill(value);
    await by(page, 'field-max_reach_cm').fill('');
    await by(page, 'start-submit').click();
    const isRefused = await by(page, 'field-max_reach_cm').evaluate((input) => !input.checkValidity());
    assert.ok(isRefused);

    await by(page, 'field-max_reach_cm').fill(subject.max_reach_cm);
    await by(page, 'start-submit').click();

    await isStep('waiting').waitFor();
    await waitForText(page, 'trial-counter', /^Ready for trial 1 of 6$/); // the record, which says it, arrives after the status
  });

  // requirement: UI-6
  test('runs by keys, with each prompt in order', { timeout: 600_000 }, async () => {
    const trialWatch = daemon.watch('chair/trial');
    await remember(page, 'prompt', 'data-step');
    const stepsOf = async (value) => (await rememberedOf(page, 'prompt')).filter((one) => one.value === value).length;
    let starts = 0;
    const runTrial = async (trial, key) => {
      await page.keyboard.press(key);
      starts += 1;
      await waitFor(async () => (await stepsOf('go')) === starts, 'the page says GO');
      assert.match(await textOf(page, 'trial-counter'), new RegExp(`^Trial ${trial} of 6`));
      await isStep(trial === 6 ? 'finished' : 'waiting').waitFor();
    };
    const rowSays = (words) => by(page, 'trial-table').locator('tr').filter({ hasText: words }).waitFor();
    await runTrial(1, 'a');
    await runTrial(2, 'a');
    await runTrial(2, 'r'); // it is void and starts again at once
    await rowSays('redone');
    assert.match(await textOf(page, 'trial-counter'), /attempt 2$/);
    await runTrial(3, 'a');
    await page.keyboard.press('x'); // 3 is void, the plan goes on
    await rowSays('rejected');
    for (const trial of [4, 5, 6]) await runTrial(trial, 'a');

    const prompts = await rememberedOf(page, 'prompt');
    const words = prompts.map(({ value }) => value).join(' ');
    assert.match(words, /^waiting (ready go (back )?(waiting|finished) ?)+$/);
    assert.equal(words.match(/ready/g).length, starts);
    assert.ok(words.match(/back/g).length >= 5, `a reach is found in nearly every trial: ${words}`);
    const said = prompts.filter(({ text }) => text !== 'No data'); // a busy machine may be late
    assert.deepEqual([...new Set(said.map(({ value, text }) => `${value}: ${text}`))].sort(), ['back: Back', 'finished: Done', 'go: GO', 'ready: Ready', 'waiting: Wait']);
    // By the daemon's times, because the time for drawing depends on the machine.
    const timesOf = (step) => trialWatch.seen.filter(({ event }) => event.kind === 'trial' && event.step === step).map(({ host_time_ns }) => host_time_ns);
    await waitFor(() => trialWatch.seen.some(({ event }) => event.step === 'go' && event.trial === 6), 'dtsctl shows the last start');
    // dtsctl may subscribe after the first events: a Go without its Ready is the first one.
    const readyBefore = (go) => timesOf('ready').findLast((ready) => ready < go);
    const delaysS = timesOf('go').filter(readyBefore).map((go) => (go - readyBefore(go)) / 1e9);
    assert.ok(delaysS.length >= starts - 1, `${delaysS.length} of ${starts} starts were seen`);
    assert.ok(delaysS.every((delayS) => delayS > 0.98 && delayS < 1.52), `"Go" came ${delaysS} s after "Ready"; the protocol says 1 to 1.5 s`);
    await trialWatch.close();
  });

  test('its table is what dtsctl shows, also after the session', async () => {
    await by(page, 'trials-trials').click();
    await by(page, 'stop-session').click();
    await isStep('free').waitFor();
    const { sessions } = await daemon.json('session', 'list');
    const session = await daemon.endedSession(sessions[0].session_id);
    const rows = () =>
      page.evaluate(() => [...document.querySelectorAll('[data-testid="trial-table"] tbody tr')].map((row) => [...row.children].map((cell) => cell.textContent)));
    const withoutReasons = ([trial, target, outcome, word, deg]) => [trial, target, outcome, word.replace(/ \(.*\)$/, ''), deg];

    const onChair = (await rows()).map(withoutReasons);
    await page.goto(`${gateway.url}/#/sessions/${session.session_id}`);
    await by(page, 'trial-table').waitFor();
    const onSession = (await rows()).map(withoutReasons);

    assert.equal(session.state, 'complete');
    assert.equal(session.subject, 'P6');
    assert.deepEqual(session.trials.map(({ trial, attempt, outcome }) => [trial, attempt, outcome]), [
      [1, 1, 'done'],
      [2, 1, 'redone'],
      [2, 2, 'done'],
      [3, 1, 'rejected'],
      [4, 1, 'done'],
      [5, 1, 'done'],
      [6, 1, 'done'],
    ]);
    const expected = session.trials.map(rowOf).reverse();
    assert.deepEqual(onChair, expected);
    assert.deepEqual(onSession, expected);
    for (const { name, value } of session.results) assert.equal(await textOf(page, `result-${name}`), fixed(value, ['trials', 'targets'].includes(name) ? 0 : 3));
    const frame = page.frameLocator('[data-testid="report-frame"]');
    await frame.getByRole('heading', { name: 'Trunk class by target' }).waitFor();
    assert.match(await frame.locator('body').innerText(), /Live and recomputed values match in \d trials/);
    await by(page, 'report').getByRole('button', { name: 'Trial 1' }).click();
    await frame.getByRole('heading', { name: 'Points and features of the reach' }).waitFor();
  });

  test('no request went to another host, and nothing violated the policy', () => tabs.close());
});
