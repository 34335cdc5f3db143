// SPDX-License-Identifier: Apache-2.0
// Checks every page in both themes with axe-core, and by keyboard alone.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, waitFor } from './support.mjs';
import { axeFile, Bench, by, goTo, textOf, waitForText } from './support_browser.mjs';

const shorter = { 'settle_s = 5': 'settle_s = 1', 'duration_s = 20': 'duration_s = 3' };

const standards = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa'];

/** Returns all findings of axe against WCAG 2.2 AA, one line each. */
const findings = (page) =>
  page.evaluate(async (values) => {
    const { violations } = await window.axe.run(document, { resultTypes: ['violations'], runOnly: { type: 'tag', values } });
    return violations.flatMap(({ id, nodes }) => nodes.map(({ html, failureSummary }) => `${id}: ${html.slice(0, 160)} ${failureSummary}`));
  }, standards);

describe('accessibility', () => {
  let bench;
  let daemon;
  let page;
  const ids = [];
  before(async () => {
    // The Content-Security-Policy allows only the dashboard's own scripts. It is bypassed here alone, to load axe.
    bench = await Bench.opened({ daemon: { protocols: (folder) => alteredProtocol(folder, 'quiet-standing', shorter) }, gateway: () => ['--local-role', 'engineer'], tabs: { bypassCSP: true } });
    ({ daemon } = bench);
    page = await bench.tabs.open('floor');
    await page.addScriptTag({ content: readFileSync(axeFile, 'utf8') });
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
    for (let count = 0; count < 2; count += 1) {
      ids.push(await daemon.measuredStanding('P1'));
      await daemon.ctl('session', 'stop');
    }
  });
  after(() => bench?.close());

  const pages = {
    floor: async () => void (await waitForText(page, 'sway-MVELO', /\d/)),
    chair: async () => void (await by(page, 'prompt').waitFor()),
    sessions: async () => void (await by(page, 'session-row').first().waitFor()),
    'sessions/ID': async () => void (await by(page, 'report-frame').waitFor()),
    'compare/ID/ID': async () => void (await by(page, 'comparison-table').waitFor()),
    subjects: async () => void (await by(page, 'subject-row').first().waitFor()),
    'subjects/P1': async () => void (await by(page, 'session-row').first().waitFor()),
    health: async () => void (await waitForText(page, 'volts-floor-w4', /\d/)),
    'patient/floor': async () => void (await by(page, 'patient').and(page.locator('[data-state="idle"]')).waitFor()),
  };
  const show = async (name) => {
    await goTo(page, ids.reduce((path, id) => path.replace('ID', id), name));
    await pages[name]();
  };

  for (const theme of ['light', 'dark']) {
    test(`axe finds nothing on any page, ${theme}`, async () => {
      await show('floor'); // the patient screen has no choice of colours
      await by(page, 'theme').selectOption(theme);
      const found = {};
      for (const name of Object.keys(pages)) {
        await show(name);
        const here = await findings(page);
        if (here.length > 0) found[name] = here;
      }
      assert.deepEqual(found, {});
    });
  }

  // requirement: UI-4
  test('axe finds nothing in the forms and during a session', async () => {
    await show('floor');
    await by(page, 'open-start').click();
    await by(page, 'start-protocol').selectOption('quiet-standing');
    await by(page, 'field-weight_kg').fill('5');
    await by(page, 'start-submit').click();
    await waitForText(page, 'start-session', 'Body weight: enter 10 to 250 kg');
    assert.equal(await page.evaluate(() => document.activeElement.dataset.testid), 'field-weight_kg', 'the wrong field has the focus');
    assert.deepEqual(await findings(page), []);
    await by(page, 'show-keys').click();
    await by(page, 'key-help').waitFor();
    await page.keyboard.press('Escape');
    await by(page, 'key-help').waitFor({ state: 'detached' });
    assert.equal(await by(page, 'start-session').count(), 1, 'Escape closes the list of keys first');
    await by(page, 'start-session-close').click();
    await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'quiet-standing');
    await by(page, 'stop-session').waitFor();
    assert.deepEqual(await findings(page), []);
    for (const rig of ['floor', 'chair']) {
      await goTo(page, `patient/${rig}`);
      await by(page, 'patient').and(page.locator(`[data-kind="${rig}"]`)).waitFor();
      assert.deepEqual(await findings(page), [], `patient screen, ${rig}`);
    }
    await goTo(page, 'floor');
    await daemon.ctl('session', 'abort', '--reason', 'a test');
    await by(page, 'open-start').waitFor();
    await show('sessions/ID');
    for (const form of ['correct', 'delete']) {
      await by(page, `open-${form}`).click();
      await by(page, form).waitFor();
      assert.deepEqual(await findings(page), []);
      await page.keyboard.press('Escape');
      await by(page, form).waitFor({ state: 'detached' });
    }
    await show('subjects/P1');
    await by(page, 'open-erase').click();
    await by(page, 'erase-confirm').waitFor();
    assert.deepEqual(await findings(page), []);
  });

  // requirement: UI-4
  test('Tab reaches every control of every page, and shows where it is', async () => {
    for (const name of Object.keys(pages)) {
      await show(name);
      const seen = await page.evaluate(() => {
        document.activeElement?.blur();
        const isShown = (element) => element.checkVisibility() && element.tabIndex >= 0 && !element.disabled;
        const controls = [...document.querySelectorAll('button, a[href], input, select, textarea, summary, [tabindex]')].filter(isShown);
        controls.forEach((control, index) => (control.dataset.testControl = String(index)));
        return controls.length;
      });
      const reached = new Map();
      for (let press = 0; press < 3 * seen + 10 && reached.size < seen; press += 1) {
        await page.keyboard.press('Tab');
        const { index, mark } = await page.evaluate(() => {
          const { outlineStyle, outlineWidth, boxShadow } = getComputedStyle(document.activeElement);
          const isOutlined = (outlineStyle !== 'none' && Number.parseFloat(outlineWidth) >= 1) || boxShadow !== 'none';
          return { index: document.activeElement.dataset?.testControl, mark: isOutlined ? '' : document.activeElement.outerHTML.slice(0, 160) };
        });
        if (index !== undefined) reached.set(index, mark);
      }
      const missed = await page.evaluate(
        (all) => [...document.querySelectorAll('[data-test-control]')].filter(({ dataset }) => !all.includes(dataset.testControl)).map((control) => control.outerHTML.slice(0, 120)),
        [...reached.keys()],
      );
      assert.deepEqual(missed, [], `${name}: not reached`);
      assert.deepEqual([...reached.values()].filter((mark) => mark !== ''), [], `${name}: focus is not seen`);
      await page.evaluate(() => document.querySelectorAll('[data-test-control]').forEach((control) => delete control.dataset.testControl));
    }
  });

  test('"?" lists the keys, digits choose pages, Escape closes', async () => {
    await show('floor'); // the patient screen has no keys
    await page.evaluate(() => document.activeElement?.blur());
    await page.keyboard.press('?');
    await by(page, 'key-help').waitFor();
    const help = await textOf(page, 'key-help');
    for (const key of ['Space', 'A', 'R', 'X', 'Esc', 'Tab']) assert.match(help, new RegExp(`^${key}\\b`, 'm'), key);
    assert.deepEqual(await findings(page), []);
    await page.keyboard.press('Escape');
    await by(page, 'key-help').waitFor({ state: 'detached' });
    for (const [key, name] of [['1', 'floor'], ['2', 'chair'], ['3', 'sessions'], ['4', 'subjects'], ['5', 'health']]) {
      await page.keyboard.press(key);
      await by(page, `tab-${name}`).and(page.locator('[aria-current="page"]')).waitFor();
      assert.equal(new URL(page.url()).hash, `#/${name}`);
    }
  });

  // requirement: UI-4
  test('axe finds nothing on any page when the daemon is dead, in both themes', async () => {
    await show('health');
    await daemon.kill();
    await by(page, 'status-line').and(page.locator('[data-state="no-daemon"]')).waitFor();
    const found = {};
    for (const theme of ['light', 'dark']) {
      await by(page, 'theme').selectOption(theme);
      for (const name of ['floor', 'chair', 'sessions', `sessions/${ids[0]}`, 'subjects/P1', 'health']) {
        await goTo(page, name);
        await by(page, ['floor', 'chair'].includes(name) ? 'no-data' : 'loud-status').first().waitFor();
        const here = await findings(page);
        if (here.length > 0) found[`${name}, ${theme}`] = here;
      }
    }
    assert.deepEqual(found, {});
  });

  test('no request went to another host', () => bench.tabs.close());
});
