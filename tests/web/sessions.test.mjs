// SPDX-License-Identifier: Apache-2.0
// A session from the start form to report, export and comparison; everything is compared with dtsctl.
import assert from 'node:assert/strict';
import { readFileSync, statSync } from 'node:fs';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, filesBelow, waitFor } from './support.mjs';
import { Bench, by, fixed, remember, rememberedOf, textOf, waitForText } from './support_browser.mjs';

const protocolNames = { free: 'Free recording', 'quiet-standing': 'Quiet standing' };
const shorter = { 'settle_s = 5': 'settle_s = 1', 'duration_s = 20': 'duration_s = 4' };

/** Returns "12.4 MB", like the dashboard. */
const sizeText = (count) => {
  const power = count < 999.5 ? 0 : count < 999_500 ? 1 : 2;
  const value = count / 1000 ** power;
  return `${fixed(value, power === 0 || value >= 99.95 ? 0 : 1)} ${['B', 'kB', 'MB'][power]}`;
};

describe('sessions', () => {
  let bench;
  let daemon;
  let gateway;
  let tabs;
  const ids = []; // of the two sessions with results, oldest first
  before(async () => {
    bench = await Bench.opened({ daemon: { protocols: (folder) => alteredProtocol(folder, 'quiet-standing', shorter) }, tabs: { acceptDownloads: true } });
    ({ daemon, gateway, tabs } = bench);
  });
  after(() => bench?.close());

  test('one is started, marked by button and by key, and stopped', async () => {
    const markers = daemon.watch('floor/marker');
    const page = await tabs.open('floor');
    await by(page, 'guidance').and(page.locator('[data-state="standing"]')).waitFor();
    await by(page, 'open-start').click();
    assert.equal(await page.evaluate(() => document.activeElement.dataset.testid), 'start-protocol');
    await page.keyboard.press('Escape');
    await by(page, 'start-session').waitFor({ state: 'detached' });
    await by(page, 'open-start').click();
    assert.equal(await by(page, 'start-protocol').inputValue(), '', 'no protocol is preselected on a rig without sessions');
    await by(page, 'start-protocol').selectOption('quiet-standing');
    await by(page, 'start-subject').fill('P017');
    await by(page, 'start-label').fill('from the browser');
    await by(page, 'field-sex').selectOption('female');
    await by(page, 'field-age_years').fill('52');
    await by(page, 'start-submit').click();
    await by(page, 'guidance').and(page.locator('[data-state="first"]')).waitFor();

    await remember(page, 'guidance', 'data-state');
    await remember(page, 'countdown', 'role');
    await page.keyboard.press('a');
    await by(page, 'mark-text').fill('by button');
    await by(page, 'mark').click();
    await waitForText(page, 'marked', 'Marker "by button" set at scan');
    await by(page, 'mark-text').fill('by key');
    await page.locator('h1').click(); // leave the text field, where Space types a space
    await page.keyboard.press('Space');
    await waitForText(page, 'marked', 'Marker "by key" set at scan');
    const marked = await textOf(page, 'marked');
    await by(page, 'guidance').and(page.locator('[data-state="done"]')).waitFor();
    const states = (await rememberedOf(page, 'guidance')).map(({ value }) => value);
    // On a busy machine the page may never show the second of settling. All other states appear once and in order.
    assert.deepEqual(states.filter((state) => state !== 'settling'), ['first', 'measuring', 'done']);
    assert.ok(!states.includes('settling') || states.indexOf('settling') === 1, states.join());
    assert.deepEqual((await rememberedOf(page, 'countdown')).map(({ value }) => value), ['', 'timer', '']);
    await waitForText(page, 'sway-note', 'final, trial 1');
    const velocity = await textOf(page, 'sway-MVELO');
    await by(page, 'stop-session').click();
    await waitForText(page, 'toast', 'Session stops in 5 s');
    await by(page, 'stop-session').click(); // Stop now
    await waitForText(page, 'last-session', 'Result: P017, Quiet standing');
    await by(page, 'open-start').click();
    await waitFor(async () => (await by(page, 'start-protocol').inputValue()) === 'quiet-standing', 'the last protocol of the rig is preselected');
    await page.keyboard.press('Escape');
    await by(page, 'open-start').waitFor();

    const { sessions } = await daemon.json('session', 'list');
    assert.equal(sessions.length, 1);
    const id = sessions[0].session_id;
    const session = await daemon.endedSession(id);
    assert.equal(session.state, 'complete');
    assert.equal(session.subject, 'P017');
    assert.equal(session.label, 'from the browser');
    assert.deepEqual(session.trials.map(({ trial, outcome }) => [trial, outcome]), [[1, 'done']]);
    assert.equal(velocity, fixed(session.trials[0].sway.measures.find(({ symbol }) => symbol === 'MVELO').value, 1));
    await waitFor(() => markers.seen.length >= 2, 'dtsctl shows both markers');
    assert.deepEqual(markers.seen.map(({ event }) => event.text), ['by button', 'by key']);
    assert.equal(marked.replaceAll(',', ''), `Marker "by key" set at scan ${markers.seen[1].first_scan}`);
    const tables = path.join(daemon.folder, 'csv');
    await daemon.ctl('session', 'export', id, '--format', 'csv', '--out', tables);
    const events = readFileSync(filesBelow(tables).find((file) => file.endsWith('_events.csv')), 'utf8').split('\n').map((line) => line.split(','));
    const recorded = events.filter(([, , , event]) => event === 'marker').map(([, , scan, , text]) => [text, Number(scan)]);
    assert.deepEqual(recorded, markers.seen.map(({ event, first_scan: scan }) => [event.text, scan]));
    ids.push(id);
    await page.close();
  });

  test('the list shows what dtsctl lists, and filters', async () => {
    const id = await daemon.measuredStanding('P017');
    await daemon.ctl('session', 'stop');
    await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'free', '--subject', 'Q2');
    const page = await tabs.open('sessions');
    await waitForText(page, 'session-count', '3 sessions');
    await by(page, 'session-row').filter({ hasText: 'running' }).waitFor();
    await daemon.ctl('session', 'abort', '--reason', 'a test');
    await by(page, 'session-row').filter({ hasText: 'aborted' }).waitFor(); // the list updates by itself

    const { sessions } = await daemon.json('session', 'list');
    const rows = await by(page, 'session-row').all();
    assert.equal(rows.length, sessions.length);
    for (const [index, session] of sessions.entries()) {
      const cells = (await rows[index].locator('td').allInnerTexts()).map((text) => text.trim());
      const lengthS = session.parts.reduce((sum, part) => sum + part.duration_s, 0);
      const started = new Date(Number(BigInt(session.started_utc_ns) / 1_000_000n));
      assert.equal(await rows[index].getAttribute('data-session'), session.session_id);
      const day = started.toLocaleString('en-GB', { day: 'numeric', month: 'short', timeZone: 'UTC' });
      assert.equal(cells[1], `${session.subject}, ${protocolNames[session.protocol]}, ${day}\n${session.session_id}`);
      assert.equal(cells[2], session.subject);
      assert.equal(cells[3], started.toLocaleString('en-GB', { dateStyle: 'short', timeStyle: 'short', timeZone: 'UTC' }));
      assert.deepEqual(cells.slice(4, 6), [session.rig, `${fixed(lengthS, 1)} s`]);
      const trials = session.planned_trials > 0 && session.state !== 'running' ? `\\n.*${session.valid_trials} of ${session.planned_trials} valid` : '';
      assert.match(cells[6], new RegExp(`^. ${session.state}${trials}$`));
      assert.equal(cells[7], session.label ?? '');
    }
    await by(page, 'filter-subject').fill('p0');
    await waitForText(page, 'session-count', '2 of 3 sessions');
    await by(page, 'filter-state').selectOption('aborted');
    await by(page, 'no-sessions').waitFor();
    ids.push(id);
    await page.close();
  });

  test('the page of a session shows its record and the report that dtsctl writes', async () => {
    const [id] = ids;
    const pages = path.join(daemon.folder, 'report');
    await daemon.ctl('report', id, '--format', 'html', '--out', pages);
    const session = await daemon.session(id);
    const page = await tabs.open(`sessions/${id}`);
    const frame = by(page, 'report-frame');
    await frame.waitFor();

    const head = await textOf(page, 'session-usefulness');
    for (const fact of ['complete', '1 of 12 valid']) assert.ok(head.includes(fact), `${fact} in ${head}`);
    const facts = await textOf(page, 'session-facts');
    for (const fact of ['P017', 'Quiet standing', 'floor', 'from the browser']) assert.ok(facts.includes(fact), `${fact} in ${facts}`);
    assert.match(await page.locator('h1').innerText(), /^P017, Quiet standing, \d/);
    assert.equal(await textOf(page, 'session-id'), `Session ID ${id}`);
    for (const { name, value } of session.results) assert.equal(await textOf(page, `result-${name}`), fixed(value, 3));
    assert.ok(session.results.length > 0);
    const parts = await textOf(page, 'part-table');
    assert.ok(parts.includes(session.parts[0].sha256) && parts.includes(session.parts[0].file), parts);

    const src = await frame.getAttribute('src');
    const served = await page.request.get(gateway.url + src);
    assert.deepEqual(await served.body(), readFileSync(path.join(pages, path.basename(src))));
    const heading = page.frameLocator('[data-testid="report-frame"]').locator('h1');
    await heading.waitFor();
    assert.match(await page.frameLocator('[data-testid="report-frame"]').locator('body').innerText(), /P017/);
    await by(page, 'report').getByRole('button', { name: 'Trial 1' }).click();
    const trial = await page.request.get(gateway.url + (await frame.getAttribute('src')));
    assert.deepEqual(await trial.body(), readFileSync(path.join(pages, 'trial-01.html')));
    await page.close();
  });

  test('the PDF of a report is made on request; it has the bytes of dtsctl', async () => {
    const [id] = ids;
    const pages = path.join(daemon.folder, 'pdf');
    await daemon.ctl('report', id, '--format', 'pdf', '--out', pages);
    const expected = readFileSync(path.join(pages, 'report.pdf'));
    const page = await tabs.open(`sessions/${id}`);
    await by(page, 'report-pdf-prepare').click();
    const button = by(page, 'report-pdf');
    await button.waitFor();
    assert.ok((await button.innerText()).endsWith(`, ${sizeText(expected.length)}`), await button.innerText());
    const [download] = await Promise.all([page.waitForEvent('download'), button.click()]);
    assert.equal(download.suggestedFilename(), `${id}-report.pdf`);
    assert.deepEqual(readFileSync(await download.path()), expected);
    await page.close();
  });

  test('an export button shows the size of its file', async () => {
    const [id] = ids;
    const page = await tabs.open(`sessions/${id}`);
    const { parts } = await daemon.session(id);

    const taken = {};
    for (const name of ['xdf-1', 'csv', 'bids']) {
      const button = by(page, `export-${name}`);
      const label = await button.innerText();
      const [download] = await Promise.all([page.waitForEvent('download'), button.click()]);
      taken[name] = await download.path();
      const size = statSync(taken[name]).size;
      assert.ok(label.endsWith(`, ${sizeText(size)}`), `"${label}" for ${size} bytes`);
    }

    assert.deepEqual(readFileSync(taken['xdf-1']), readFileSync(parts[0].file));
    for (const name of ['csv', 'bids']) assert.equal(readFileSync(taken[name]).subarray(0, 4).toString('latin1'), 'PK\x03\x04');
    await page.close();
  });

  test('a stop is undone with U, and sent at once when the page is left', async () => {
    const id = (await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'free', '--subject', 'Q3')).trim();
    const page = await tabs.open('floor');
    await by(page, 'stop-session').click();
    await waitForText(page, 'toast', 'Session stops in 5 s');
    await page.keyboard.press('u');
    await by(page, 'toast').waitFor({ state: 'detached' });
    assert.equal((await daemon.session(id)).state, 'running');
    await by(page, 'stop-session').click();
    await by(page, 'toast').waitFor();
    await by(page, 'tab-health').click();
    assert.equal((await daemon.endedSession(id)).state, 'complete');
    await page.close();
  });

  test('two sessions side by side differ as dtsctl says', async () => {
    const [one, other] = ids;
    const { figures } = await daemon.json('session', 'compare', one, other);
    const page = await tabs.open('sessions');
    for (const id of [one, other]) await page.locator(`[data-session="${id}"] input`).check();
    await by(page, 'compare-two').click();
    await by(page, 'comparison-table').waitFor();

    const shown = await page.evaluate(() =>
      [...document.querySelectorAll('[data-testid="comparison-row"]')].map((row) =>
        [row.dataset.result, ...[...row.children].slice(1).map((cell) => cell.textContent)],
      ),
    );
    const signed = (value, digits) => (Number(value.toFixed(digits)) > 0 ? '+' : '') + fixed(value, digits);
    const byName = ([one], [other]) => (one < other ? -1 : 1);
    const expected = figures.map(({ name, unit, values, differences, percent }) => [
      name,
      ...values.map((value) => fixed(value, 3)),
      unit.replace('mm2', 'mm²'),
      signed(differences[0], 3),
      percent[0] === null ? '' : `${percent[0] > 0 ? '+' : ''}${fixed(percent[0], 0)} %`,
    ]);
    assert.ok(figures.length >= 10);
    assert.deepEqual(shown.sort(byName), expected.sort(byName));
    for (const index of [1, 2]) await by(page, `report-${index}-frame`).waitFor();
    const frames = await Promise.all([1, 2].map((index) => by(page, `report-${index}-frame`).getAttribute('src')));
    assert.deepEqual(frames.map((src) => src.split('/')[3]), [one, other]);
    await page.close();
  });

  test('no request went to another host, and nothing violated the policy', () => tabs.close());
});
