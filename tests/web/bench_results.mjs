// SPDX-License-Identifier: Apache-2.0
// Measures the time from the end of a trial of quiet standing to its final values on the screen:
//   node tests/web/bench_results.mjs [--seconds 60] [--rates 100,1500] [--trials 5]
// Prints a table without a limit. The end of the trial is the host time of its event "done"; the values are on the screen in the first frame after
// the page has written them.
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';

import { Browser, loadAverage, openLive, printRow, spread } from './bench_browser.mjs';
import { realtimeOffsetMs } from './bench_pixels.mjs';
import { alteredProtocol, Daemon, Gateway, replaced, waitFor } from './support.mjs';

const { values: options } = parseArgs({
  options: { seconds: { type: 'string', default: '60' }, rates: { type: 'string', default: '100,1500' }, trials: { type: 'string', default: '5' } },
});
const patientMs = 1000 * Number(options.seconds) + 120_000;

/** Runs in the page. Keeps the wall time of the first frame with each final result: { note, atMs }. */
const rememberResults = () => {
  window.results = [];
  const look = () => {
    const isFinal = document.querySelector('[data-testid="sway"]')?.dataset.kind === 'final';
    const note = isFinal ? document.querySelector('[data-testid="sway-note"]').textContent : '';
    if (note === window.lastNote) return;
    window.lastNote = note;
    if (note !== '') requestAnimationFrame(() => setTimeout(() => window.results.push({ note, atMs: Date.now() })));
  };
  new MutationObserver(look).observe(document.body, { subtree: true, childList: true, characterData: true, attributes: true, attributeFilter: ['data-kind'] });
};

const measure = async (browser, rate) => {
  const daemon = await Daemon.started({
    protocols: (folder) => {
      alteredProtocol(folder, 'romberg', { 'settle_s = 5': 'settle_s = 0', 'duration_s = 30': `duration_s = ${options.seconds}`, 'blocks = 2': 'blocks = 20' });
      const rig = path.join(folder, '../rigs/floor-sim.toml');
      writeFileSync(rig, replaced(readFileSync(rig, 'utf8'), { 'rate_hz = 100.0': `rate_hz = ${rate}.0` }));
    },
  });
  try {
    const gateway = await Gateway.started(daemon);
    const page = await openLive(browser, gateway.url, 'floor');
    await page.evaluate(rememberResults);
    const events = daemon.watch('floor/trial');
    await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg');
    const offsetMs = realtimeOffsetMs();
    const tookMs = [];
    for (let trial = 1; trial <= Number(options.trials); trial += 1) {
      await waitFor(() => daemon.ctl('session', 'trial', 'next').then(() => true, () => false), `trial ${trial} starts`, patientMs);
      const isDone = ({ event }) => event.step === 'done' && event.trial === trial;
      const done = await waitFor(() => events.seen.find(isDone), `trial ${trial} ends`, patientMs);
      const shown = await waitFor(() => page.evaluate((number) => window.results.find(({ note }) => note.includes(`trial ${number}`)), trial), `result ${trial}`, patientMs);
      tookMs.push(shown.atMs - (done.host_time_ns / 1e6 + offsetMs));
    }
    printRow(`${rate} Hz x ${options.seconds} s`, tookMs.length, spread(tookMs), Math.max(...tookMs).toFixed(0), loadAverage());
    await page.close();
    await gateway.close();
  } finally {
    await daemon.close();
  }
};

const browser = await Browser.opened();
printRow('trial', 'how many', 'ms from its end to its values on the screen: median / 95th percentile', 'longest', 'load');
printRow('---', '---', '---', '---', '---');
for (const rate of options.rates.split(',')) await measure(browser, Number(rate));
await browser.close();
process.exit(0);
