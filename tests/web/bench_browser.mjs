// SPDX-License-Identifier: Apache-2.0
// Chromium over its debugging pipe, for measurements. Playwright would have every WebSocket frame reported to itself, which costs the page's main
// thread. Chromium draws in software (--disable-gpu): a machine with a graphics card is faster.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { EventEmitter, once } from 'node:events';
import { mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';

import { chromiumSwitches, patienceMs, waitFor } from './support.mjs';

const switches = ['--headless', '--remote-debugging-pipe', '--lang=en-GB', ...chromiumSwitches];

/** One window with one page. Emits the events of the debugging protocol under their names. */
export class Page extends EventEmitter {
  constructor(browser, session, target) {
    super();
    Object.assign(this, { browser, session, target });
  }

  send(method, parameters = {}) {
    return this.browser.send(method, parameters, this.session);
  }

  /** Runs a function in the page with `words` and returns its result. */
  async evaluate(task, ...words) {
    const expression = `(${task})(...${JSON.stringify(words)})`;
    const { result, exceptionDetails } = await this.send('Runtime.evaluate', { expression, returnByValue: true, awaitPromise: true });
    assert.equal(exceptionDetails, undefined, exceptionDetails?.exception?.description);
    return result.value;
  }

  async close() {
    await this.browser.send('Target.closeTarget', { targetId: this.target });
  }
}

export class Browser extends EventEmitter {
  #asked = new Map();
  #pages = new Map();
  #number = 0;
  #unread = [];

  static async opened() {
    const browser = new Browser();
    browser.folder = mkdtempSync('/tmp/dts-chromium-');
    const program = [process.env.DTS_CHROMIUM ?? '/usr/bin/chromium', ...switches, `--user-data-dir=${browser.folder}`];
    const stdio = ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'];
    browser.child = spawn('setpriv', ['--pdeathsig', 'KILL', ...program], { stdio });
    browser.child.stdio[4].on('data', (bytes) => browser.#receive(bytes));
    await browser.send('Browser.getVersion');
    return browser;
  }

  send(method, params = {}, sessionId = undefined) {
    const id = ++this.#number;
    this.child.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    return new Promise((resolve, reject) => this.#asked.set(id, { resolve, reject }));
  }

  /** Opens a page in a separate window: a page behind another in the same window is hidden and paints nothing. */
  async open(url, { width = 1280, height = 800 } = {}) {
    const { targetId } = await this.send('Target.createTarget', { url: 'about:blank', newWindow: true });
    const { sessionId } = await this.send('Target.attachToTarget', { targetId, flatten: true });
    const page = new Page(this, sessionId, targetId);
    this.#pages.set(sessionId, page);
    await page.send('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
    await page.send('Page.enable');
    await page.send('Page.navigate', { url });
    return page;
  }

  /** Returns the process id of the renderer with the most CPU time; with one page it is that page's. */
  async rendererId() {
    const { processInfo } = await this.send('SystemInfo.getProcessInfo');
    const renderers = processInfo.filter(({ type }) => type === 'renderer').sort((one, other) => other.cpuTime - one.cpuTime);
    return renderers[0].id;
  }

  async close() {
    const over = once(this.child, 'exit');
    this.child.kill('SIGTERM');
    await over;
    await waitFor(() => this.#isFolderGone(), `${this.folder} can be removed`);
  }

  /** Removes the folder. Fails while Chromium's child processes still write to it. */
  #isFolderGone() {
    try {
      rmSync(this.folder, { recursive: true, force: true });
      return true;
    } catch {
      return false;
    }
  }

  #receive(bytes) {
    let start = 0;
    for (let end = bytes.indexOf(0); end >= 0; start = end + 1, end = bytes.indexOf(0, start)) {
      this.#dispatch(JSON.parse(Buffer.concat([...this.#unread, bytes.subarray(start, end)]).toString()));
      this.#unread = [];
    }
    this.#unread.push(bytes.subarray(start));
  }

  #dispatch({ id, method, params, result, error, sessionId }) {
    if (id === undefined) return void (this.#pages.get(sessionId) ?? this).emit(method, params);
    const asked = this.#asked.get(id);
    this.#asked.delete(id);
    if (error === undefined) asked.resolve(result);
    else asked.reject(new Error(error.message));
  }
}

/** Opens a page of the dashboard that measures itself, and waits until it shows live data. */
export const openLive = async (browser, url, name) => {
  const page = await browser.open(`${url}/?measure#/${name}`);
  const isLive = () => (window.dtsMeasure?.().length ?? 0) > 100 && document.visibilityState === 'visible';
  await waitFor(() => page.evaluate(isLive), `the page ${name} paints`, 10 * patienceMs);
  return page;
};

export const quantile = (values, share) => {
  const sorted = values.filter((value) => !Number.isNaN(value)).sort((one, other) => one - other);
  return sorted[Math.floor(share * (sorted.length - 1))] ?? NaN;
};

/** Returns "12.3 / 45.6": median and 95th percentile. */
export const spread = (values) => `${quantile(values, 0.5).toFixed(1)} / ${quantile(values, 0.95).toFixed(1)}`;

export const loadAverage = () => readFileSync('/proc/loadavg', 'utf8').split(' ').slice(0, 2).join(' ');

/** Returns the CPU seconds (user and system) of all threads of a process. More exact than /proc/PID/stat, which counts in steps of 10 ms. */
export const cpuSeconds = (pid) => {
  const ofThread = (thread) => Number(readFileSync(`/proc/${pid}/task/${thread}/schedstat`, 'utf8').split(' ')[0]) / 1e9;
  return readdirSync(`/proc/${pid}/task`).reduce((sum, thread) => sum + ofThread(thread), 0);
};

export const printRow = (...cells) => console.log(`| ${cells.join(' | ')} |`);
