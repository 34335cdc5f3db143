// SPDX-License-Identifier: Apache-2.0
// Pages of the dashboard in Chromium: node pages.mjs URL RELOAD_SECONDS. Opens the live page of each rig, the patient screen, and the page Sessions,
// which it reloads every RELOAD_SECONDS. Prints "open" when all are open. After a line at its input with the IDs of the running sessions, prints as JSON
// what it has seen, and ends. A page that shows no present data then, or that threw an exception, is a fault.
import { once } from 'node:events';
import { createInterface } from 'node:readline';

import { Browser, openLive } from '../web/bench_browser.mjs';
import { pause, patienceMs, waitFor } from '../web/support.mjs';

const [url, reloadSeconds] = process.argv.slice(2);
const faults = [];

/** Reports exceptions of a page. */
const watch = async (page, name) => {
  page.on('Runtime.exceptionThrown', ({ exceptionDetails }) => faults.push(`${name}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`));
  await page.send('Runtime.enable');
};

/** Returns whether a live page has just painted, and neither says that there are no data nor that they are late. */
const showsPresent = () => {
  const isThere = (testId) => document.querySelector(`[data-testid="${testId}"]`) !== null;
  const paintedMs = window.dtsMeasure?.().at(-1)?.paintedMs ?? -Infinity;
  return document.querySelector('.live') !== null && !isThere('no-data') && !isThere('data-age') && performance.now() - paintedMs < 1000;
};

const isPatientLive = () => !['noData', undefined].includes(document.querySelector('[data-testid="patient"]')?.dataset.state);

const lists = (ids) => ids.every((id) => document.querySelector(`[data-testid="session-row"][data-session="${id}"]`) !== null);

const isCounted = () => window.isOld !== true && /\d/.test(document.querySelector('[data-testid="session-count"]')?.textContent ?? '');

const expect = async (condition, fault) => {
  await waitFor(condition, fault).catch((problem) => faults.push(problem.message));
};

let isOver = false;
let reloads = 0;

const reload = async (page) => {
  for (let nextMs = Date.now(); !isOver; await pause(200)) {
    if (Date.now() < nextMs) continue;
    nextMs = Date.now() + 1000 * Number(reloadSeconds);
    await page.evaluate(() => void (window.isOld = true)); // the document before the reload
    await page.send('Page.reload');
    await expect(() => page.evaluate(isCounted).catch(() => false), 'the page Sessions lists sessions after a reload');
    reloads += 1;
  }
};

const input = createInterface({ input: process.stdin });
const asked = once(input, 'line');
const browser = await Browser.opened();
try {
  const { product } = await browser.send('Browser.getVersion');
  const live = { floor: await openLive(browser, url, 'floor'), chair: await openLive(browser, url, 'chair') };
  const patient = await browser.open(`${url}/#/patient/floor`);
  await waitFor(() => patient.evaluate(isPatientLive), 'the patient screen is there', 10 * patienceMs);
  const sessions = await browser.open(`${url}/#/sessions`);
  for (const [name, page] of Object.entries({ ...live, patient, sessions })) await watch(page, name);
  console.log('open');
  const reloading = reload(sessions);
  const [line] = await asked;
  isOver = true;
  await reloading;
  for (const [name, page] of Object.entries(live)) await expect(() => page.evaluate(showsPresent), `the live page of ${name} shows present data`);
  await expect(() => patient.evaluate(isPatientLive), 'the patient screen shows present data');
  await expect(() => sessions.evaluate(lists, line.split(' ')), `the page Sessions lists ${line}`);
  console.log(JSON.stringify({ product, pages: 4, reloads, faults }));
} finally {
  await browser.close();
}
process.exit(0);
