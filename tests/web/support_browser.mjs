// SPDX-License-Identifier: Apache-2.0
// Chromium without a screen. Every page is watched: a request to another host, a violation of the Content-Security-Policy or an exception is a fault.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import path from 'node:path';

import { chromiumSwitches, Daemon, Gateway, patienceMs, source, waitFor } from './support.mjs';

const webRequire = createRequire(path.join(source, 'clients/web/package.json'));
const { chromium } = webRequire('playwright-core');
export const axeFile = webRequire.resolve('axe-core/axe.min.js');

export const openBrowser = (options = {}) => chromium.launch({ executablePath: process.env.DTS_CHROMIUM ?? '/usr/bin/chromium', args: chromiumSwitches, ...options });

const rememberViolations = () => {
  window.violations = [];
  document.addEventListener('securitypolicyviolation', (event) => window.violations.push(`${event.violatedDirective}: ${event.blockedURI}`));
};

/** A browser context on a gateway's dashboard. Collects faults of all its pages; close() fails if there are any. */
export class Tabs {
  constructor(context, url) {
    this.context = context;
    this.url = url;
    this.faults = [];
    context.on('page', (page) => this.#watch(page));
  }

  static async opened(browser, gateway, options = {}) {
    const context = await browser.newContext({ locale: 'en-GB', timezoneId: 'UTC', viewport: { width: 1280, height: 800 }, ...options });
    context.setDefaultTimeout(patienceMs);
    await context.addInitScript(rememberViolations);
    return new Tabs(context, gateway.url);
  }

  #watch(page) {
    page.on('request', (request) => {
      const { origin, protocol } = new URL(request.url());
      if (origin !== this.url && protocol !== 'about:') this.faults.push(`requests ${request.url()}`);
    });
    page.on('websocket', (socket) => {
      if (new URL(socket.url()).host !== new URL(this.url).host) this.faults.push(`connects to ${socket.url()}`);
    });
    page.on('console', (message) => {
      if (/Content.Security.Policy|Refused to/i.test(message.text())) this.faults.push(message.text());
    });
    page.on('pageerror', (error) => this.faults.push(String(error.stack)));
  }

  /** Opens a page: "floor", "sessions/ID". */
  async open(page) {
    const tab = await this.context.newPage();
    await tab.goto(`${this.url}/#/${page}`);
    return tab;
  }

  async close() {
    for (const page of this.context.pages()) this.faults.push(...(await page.evaluate(() => window.violations ?? [])));
    await this.context.close();
    assert.deepEqual(this.faults, []);
  }
}

/** Everything that the tests of one file share. If one part cannot be opened, the others are closed. */
export class Bench {
  static async opened({ daemon = {}, gateway = () => [], browser = {}, tabs = {} } = {}) {
    const bench = new Bench();
    try {
      bench.daemon = await Daemon.started(daemon);
      bench.gateway = await Gateway.started(bench.daemon, ...(await gateway(bench.daemon)));
      bench.browser = await openBrowser(browser);
      bench.tabs = await Tabs.opened(bench.browser, bench.gateway, tabs);
    } catch (problem) {
      await bench.close();
      throw problem;
    }
    return bench;
  }

  async close() {
    // Each is closed, also if the one before cannot be.
    try {
      await this.browser?.close();
    } finally {
      try {
        await this.gateway?.close();
      } finally {
        await this.daemon?.close();
      }
    }
  }
}

const scansOfASecond = 100; // of the simulated floor

export const by = (page, testId) => page.getByTestId(testId);
export const textOf = async (page, testId) => (await by(page, testId).innerText()).trim();

/**
 * Returns the scan of `watch` (of floor/cop) that the page shows, with the shown numbers, all read at the same moment. Page or watch may be late on a
 * busy machine, so the scan is searched among all received ones.
 */
const shownScan = async (page, watch, timeoutMs) => {
  const shown = await waitFor(
    () =>
      page.evaluate(() => {
        const plate = document.querySelector('[data-testid="plate"]');
        const ml = Number(plate?.dataset.mlMm ?? NaN);
        const kg = document.querySelector('[data-testid="load-kg"]')?.textContent;
        return Number.isFinite(ml) ? { ml, ap: Number(plate.dataset.apMm), words: plate.ariaLabel, kg } : undefined;
      }),
    'the page shows a position',
  );
  const scans = () => watch.seen.flatMap((block) => block.values.map((values, index) => ({ scan: block.first_scan + index, values })));
  const newest = scans().at(-1)?.scan;
  const isIt = ({ values: [ml, ap] }) => ml !== null && Math.abs(ml - shown.ml) < 0.0051 && Math.abs(ap - shown.ap) < 0.0051;
  const found = await waitFor(() => scans().findLast(isIt), () => `no scan is ${JSON.stringify(shown)}`, timeoutMs);
  return { ...found, shown, newest };
};

/** Waits until the page shows a scan of the last second, and returns it. A busy machine and a page that was hidden need some time. */
export const shownRecentScan = async (page, watch) => {
  const triedMs = 3000;
  let last;
  const isRecent = ({ newest, scan }) => Math.abs(newest - scan) <= scansOfASecond;
  return waitFor(
    async () => {
      const found = await shownScan(page, watch, triedMs).catch((problem) => void (last = problem.message));
      if (found === undefined || isRecent(found)) return found;
      last = `the page shows scan ${found.scan}, the newest was ${found.newest}`;
      return undefined;
    },
    () => last,
  );
};

/** Goes to another page of the dashboard without a reload. */
export const goTo = (page, hash) => page.evaluate((to) => void (location.hash = `#/${to}`), hash);

/** Records every value of an attribute from now on, however short it lasts; rememberedOf() returns them. */
export const remember = (page, testId, attribute) =>
  page.evaluate(
    ([id, name]) => {
      const kept = [];
      window.remembered = { ...window.remembered, [id]: kept };
      const look = () => {
        const element = document.querySelector(`[data-testid="${id}"]`);
        const value = element?.getAttribute(name) ?? '';
        if (kept.at(-1)?.value !== value) kept.push({ value, text: element?.textContent ?? '', atMs: Date.now() });
      };
      new MutationObserver(look).observe(document.body, { subtree: true, childList: true, attributes: true, attributeFilter: [name] });
      look();
    },
    [testId, attribute],
  );
export const rememberedOf = (page, testId) => page.evaluate((id) => window.remembered[id], testId);

/** Waits until an element contains a text. */
export const waitForText = (page, testId, pattern, timeoutMs = patienceMs) =>
  by(page, testId)
    .filter({ hasText: pattern })
    .first()
    .waitFor({ timeout: timeoutMs })
    .catch(async (problem) => {
      const now = await by(page, testId).allInnerTexts();
      throw new Error(`"${testId}" never said ${pattern}; it says: ${JSON.stringify(now)}`, { cause: problem });
    });

/** Formats a number in en-GB, like fixed() of the dashboard. */
export const fixed = (value, digits) => {
  const rounded = Number(value.toFixed(digits));
  return (rounded === 0 ? 0 : rounded).toLocaleString('en-GB', { minimumFractionDigits: digits, maximumFractionDigits: digits });
};
