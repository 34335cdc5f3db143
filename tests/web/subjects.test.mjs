// SPDX-License-Identifier: Apache-2.0
// A subject with five visits of each rig: list, trend, plain words, session plan, notes, start of a session, erasure.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, waitFor } from './support.mjs';
import { Bench, by, textOf } from './support_browser.mjs';

const visits = 5;
const shortStanding = { 'blocks = 2': 'blocks = 1', 'settle_s = 5': 'settle_s = 0.5', 'duration_s = 30': 'duration_s = 3' };
const shortReaching = {
  'blocks = 3': 'blocks = 1',
  'cue_delay_max_s = 2.0': 'cue_delay_max_s = 1.5',
  'duration_s = 5': 'duration_s = 4',
  'block_rest_s = 2': 'block_rest_s = 0',
  'rest_s = 1': 'rest_s = 0',
};
const person = { sex: 'female', side: 'right', age_years: '52', weight_kg: '70', height_cm: '175', arm_length_cm: '68', max_reach_cm: '125' };

describe('a subject with five visits of each rig', () => {
  let bench;
  let daemon;
  let tabs;
  before(async () => {
    bench = await Bench.opened({
      daemon: {
        devices: { 'sim:chair?seed=5': 'sim:chair?seed=5&reaches=cued' },
        protocols: (folder) => {
          alteredProtocol(folder, 'romberg', shortStanding);
          alteredProtocol(folder, 'reaching-short', shortReaching);
        },
      },
    });
    ({ daemon, tabs } = bench);
  });
  after(() => bench?.close());

  const isDone = async (id, count) => (await daemon.session(id)).trials.filter(({ outcome }) => outcome === 'done').length >= count;
  const standing = async () => {
    const id = (await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg', '--subject', 'P017')).trim();
    for (const trial of [1, 2]) {
      await daemon.ctl('session', 'trial', 'next', '--rig', 'floor');
      await waitFor(() => isDone(id, trial), `trial ${trial} is over`);
    }
    await daemon.ctl('session', 'stop', '--rig', 'floor').catch(() => undefined); // it may have ended by itself
    return daemon.endedSession(id);
  };
  const reaching = async () => {
    const fields = Object.entries(person).flatMap(([name, value]) => ['--field', `${name}=${value}`]);
    const id = (await daemon.ctl('session', 'start', '--rig', 'chair', '--protocol', 'reaching-short', '--subject', 'P017', ...fields)).trim();
    await daemon.ctl('session', 'trial', 'next', '--rig', 'chair');
    await waitFor(() => isDone(id, 3), 'three trials are over', 180_000);
    await daemon.ctl('session', 'stop', '--rig', 'chair').catch(() => undefined);
    return daemon.endedSession(id);
  };
  const series = async (name) => {
    for (let visit = 0; visit < visits; ++visit) await name();
  };

  test('the page lists the subject with its visits and rigs', { timeout: 600_000 }, async () => {
    await waitFor(async () => (await daemon.json('status')).rigs.every(({ segment }) => segment >= 0), 'both rigs stream');
    await Promise.all([series(standing), series(reaching)]);

    const page = await tabs.open('subjects');
    await by(page, 'subject-row').waitFor();
    const cells = (await by(page, 'subject-row').locator('th, td').allInnerTexts()).map((text) => text.trim());
    assert.equal(cells[0], 'P017');
    assert.equal(cells[2], `${2 * visits}`);
    assert.equal(cells[3], 'chair, floor');
    await page.getByRole('link', { name: 'P017' }).click();
    await by(page, 'subject-facts').waitFor();
    await page.close();
  });

  test('the trend has the values of dtsctl, and the words say the same', async () => {
    const page = await tabs.open('subjects/P017');
    await by(page, 'subject-trend-plot').waitFor();
    const trend = await daemon.json('subject', 'trend', 'P017');
    const shown = async (group, measure) => {
      await by(page, 'subject-trend-group').selectOption(group);
      await by(page, 'subject-trend-measure').selectOption(measure);
      const values = await by(page, 'subject-trend-table').locator('tbody tr').evaluateAll((rows) => rows.map((row) => Number(row.dataset.value)));
      const recorded = trend.series.filter((one) => `${one.rig} ${one.protocol}` === group && one.measure === measure).flatMap(({ points }) => points.map(({ value }) => value));
      assert.deepEqual([...values].sort(), [...recorded].sort(), `${group} ${measure}`);
      return recorded.length;
    };
    assert.ok((await shown('floor romberg', 'PEA95_F')) >= 2 * visits, 'both conditions at each visit');
    assert.ok((await by(page, 'no-band').count()) === 1, 'no source, no band');
    await shown('floor romberg', 'MVELO_ML');
    assert.equal(await by(page, 'band').count(), 0, 'the published study has 45 s, these trials are shorter');
    assert.ok((await shown('chair reaching-short', 'trunk_mean_deg')) >= visits);
    await shown('chair reaching-short', 'trunk_class');

    const words = await textOf(page, 'plain-words');
    for (const rig of ['floor', 'chair']) {
      const { sentences } = trend.words.sessions.find(({ session }) => session.includes(`-${rig}`));
      for (const sentence of sentences) assert.ok(words.includes(sentence), sentence);
    }
    assert.match(words, /With eyes closed the ellipse is .* with eyes open \(\d+ against \d+ mm²\)\./);
    assert.ok(trend.words.changes.length > 0);
    for (const sentence of trend.words.changes) assert.ok(words.includes(sentence), sentence);
    await page.close();
  });

  test('a session is planned and started from the subject, and a note is kept', async () => {
    const page = await tabs.open('subjects/P017');
    await by(page, 'plan-protocol').selectOption('romberg');
    await by(page, 'plan-date').fill('2031-12-31');
    await by(page, 'plan-add').click();
    await by(page, 'planned').and(page.locator('[data-state="due"]')).waitFor();
    await by(page, 'note-text').fill('walks with a stick');
    await by(page, 'note-add').click();
    await by(page, 'note').filter({ hasText: 'walks with a stick' }).waitFor();
    const subject = await daemon.json('subject', 'show', 'P017');
    assert.deepEqual(subject.notes.map(({ text }) => text), ['walks with a stick']);
    assert.deepEqual(subject.plan.map(({ protocol, due_date: due }) => [protocol, due]), [['romberg', '2031-12-31']]);

    await by(page, 'start-planned').click();
    await waitFor(async () => (await by(page, 'start-protocol').inputValue()) === 'romberg', 'the planned protocol is chosen');
    assert.equal(await by(page, 'start-subject').inputValue(), 'P017');
    await by(page, 'start-submit').click();
    await by(page, 'plate').waitFor(); // the live page of the rig
    const [session] = (await daemon.json('session', 'list')).sessions;
    assert.deepEqual([session.subject, session.protocol, session.rig], ['P017', 'romberg', 'floor']);
    await daemon.ctl('session', 'stop', '--rig', 'floor');
    await daemon.endedSession(session.session_id);
    await waitFor(async () => (await daemon.json('subject', 'show', 'P017')).plan[0].session_id === session.session_id, 'the plan names the session');
    await page.close();
  });

  test('after an erasure nothing of the subject is left', async () => {
    await daemon.ctl('subject', 'erase', 'P017', '--yes');
    const page = await tabs.open('subjects');
    await by(page, 'no-subjects').waitFor();
    await page.close();
    await assert.rejects(daemon.ctl('subject', 'trend', 'P017'));
    await assert.rejects(daemon.ctl('subject', 'notes', 'P017'));
  });
});
