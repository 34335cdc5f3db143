// SPDX-License-Identifier: Apache-2.0
// What a person at the centre's browser sees: dashboard.mjs URL SESSION. Prints "ok WHAT" or "FAILED WHAT"; "cut" and "restore" are requests to
// dashboard.py, which answers each line with a line.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createInterface } from 'node:readline';

import { patienceMs, waitFor } from '../web/support.mjs';
import { axeFile, by, goTo, openBrowser, Tabs, textOf } from '../web/support_browser.mjs';

const [url, session] = process.argv.slice(2);
const answers = createInterface({ input: process.stdin })[Symbol.asyncIterator]();
const ask = async (line) => {
  console.log(line);
  await answers.next();
};

/** Carries out a check and reports it. */
const check = async (what, carryOut) => {
  try {
    await carryOut();
    await ask(`ok ${what}`);
  } catch (problem) {
    await ask(`FAILED ${what}: ${String(problem.message).split('\n').slice(0, 3).join(' ')}`);
  }
};

const browser = await openBrowser();
// The Content-Security-Policy allows only the dashboard's own scripts. It is bypassed here to load axe.
const tabs = await Tabs.opened(browser, { url }, { bypassCSP: true });
const page = await tabs.context.newPage();
await page.goto(`${url}/?measure#/`);
await page.addScriptTag({ content: readFileSync(axeFile, 'utf8') });

const standards = ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa'];
const expectAccessible = async () => {
  for (const theme of ['light', 'dark']) {
    await by(page, 'theme').selectOption(theme);
    const found = await page.evaluate(async (values) => {
      const { violations } = await window.axe.run(document, { resultTypes: ['violations'], runOnly: { type: 'tag', values } });
      return violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 160)}`));
    }, standards);
    assert.deepEqual(found, [], theme);
  }
};
const expectNarrow = async () => {
  await page.setViewportSize({ width: 390, height: 800 });
  await waitFor(() => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing scrolls across');
  await page.setViewportSize({ width: 1280, height: 800 });
};
const row = (name) => page.locator(`[data-testid="clinic-row"][data-clinic="${name}"]`);
const position = () => page.evaluate(() => Number(document.querySelector('[data-testid="plate"]')?.dataset.mlMm ?? NaN));
const moves = async () => {
  const before = await waitFor(async () => ((value) => Number.isFinite(value) && value)(await position()), 'the page shows a position');
  await waitFor(async () => (await position()) !== before, 'the position changes');
};

await check('the clinic is on the first page, with its rigs', async () => {
  await row('kent').waitFor();
  await waitFor(async () => (await row('kent').getAttribute('data-wrong')) === '', 'nothing is wrong with kent');
  assert.match(await row('kent').innerText(), /Kent and Canterbury/);
  assert.deepEqual(await page.getByRole('navigation').first().getByRole('link').allInnerTexts(), ['Clinics', 'Sessions', 'Trends']);
});
await check('no finding of axe on Clinics, nothing scrolls across', async () => {
  await expectAccessible();
  await expectNarrow();
});

await check('the page of the clinic has its rigs and the receipt', async () => {
  await row('kent').getByRole('link').click();
  await by(page, 'watch-floor').waitFor();
  await by(page, 'receipts').getByText(session).waitFor();
});
await check('no finding of axe on the page of a clinic', async () => {
  await expectAccessible();
  await expectNarrow();
});

await check('the session is in the list, and a filter hides it', async () => {
  await goTo(page, 'sessions');
  await page.locator(`[data-session="${session}"]`).waitFor();
  await by(page, 'filter-subject').fill('P018');
  await by(page, 'no-sessions').waitFor();
  await by(page, 'filter-subject').fill('P017');
  await page.locator(`[data-session="${session}"]`).waitFor();
});
await check('no finding of axe on Sessions', async () => {
  await expectAccessible();
  await expectNarrow();
});

await check('the trend has a line and a table', async () => {
  await goTo(page, 'trends');
  await by(page, 'trend-plot').waitFor();
  assert.match(await by(page, 'trend-table').innerText(), /kent/);
});
await check('no finding of axe on Trends', async () => {
  await expectAccessible();
  await expectNarrow();
});

await check('the floor of the clinic is live', async () => {
  await goTo(page, 'clinics/kent');
  await by(page, 'watch-floor').waitFor();
  await page.evaluate(() => {
    window.askedMs = performance.now();
    const look = () => {
      const ml = document.querySelector('[data-testid="plate"]')?.dataset.mlMm;
      if (ml !== undefined && Number.isFinite(Number(ml))) window.firstMs = performance.now();
      else requestAnimationFrame(look);
    };
    look();
  });
  await by(page, 'watch-floor').click();
  await moves();
  const [firstMs, ages] = await page.evaluate(() => [
    window.firstMs - window.askedMs,
    window.dtsMeasure().map(({ newestMs, paintedMs }) => paintedMs - newestMs).filter(Number.isFinite),
  ]);
  ages.sort((one, other) => one - other);
  console.log(`        first position after ${firstMs.toFixed(0)} ms; age of the newest scan when painted: median ${ages[ages.length >> 1]?.toFixed(0)} ms`);
  assert.ok(ages.length > 0 && ages.every((age) => Math.abs(age) < patienceMs), `ages in ms: ${ages.slice(0, 9)}`);
});
/** A remote rig can only be watched: no button but those that change the picture, no key, no advice to press one. */
const expectNothingToCommand = async () => {
  const text = await page.locator('main').innerText();
  assert.match(text, /can only look/);
  assert.doesNotMatch(text, /start a|start session|press|tare plate|redo|accept|stop session|place the|step onto/i);
  const buttons = await page.locator('main button').allInnerTexts();
  assert.deepEqual(buttons.filter((label) => !/zoom|whole plate|^by /i.test(label)), []);
  for (const key of ['a', 'r', 'x', 's', ' ']) await page.keyboard.press(key);
  assert.equal(await page.getByRole('dialog').count(), 0);
  assert.equal(await by(page, 'command-error').count(), 0);
  await waitFor(async () => /\d/.test(await by(page, 'data-age').innerText()), 'the age of the data is shown');
};
await check('the page of the floor offers no command, and shows the age of the data', expectNothingToCommand);
await check('no finding of axe on a live page', expectAccessible);

await check('a cut line is shown, and the page is live again after it', async () => {
  await ask('cut');
  await waitFor(async () => (await by(page, 'status-line').getAttribute('data-state')) === 'no-daemon', 'the status line shows the silence');
  await by(page, 'clinic-problem').waitFor();
  await ask('restore');
  await waitFor(async () => (await by(page, 'status-line').getAttribute('data-state')) === 'up', 'the status line is well again');
  await moves();
});
await check('the chair of the clinic is live', async () => {
  await goTo(page, 'clinics/kent/chair/chair');
  await by(page, 'prompt').waitFor();
  await waitFor(async () => (await by(page, 'status-line').getAttribute('data-state')) === 'up', 'the status line is well');
});
await check('the page of the chair offers no command, and shows the age of the data', expectNothingToCommand);
await check('nothing was requested elsewhere, and no script failed', () => tabs.close());
await browser.close();
process.exit(0);
