// SPDX-License-Identifier: Apache-2.0
// Measures scan to pixel of the patient screen beside the live page, both open in one trial with feedback:
//   node tests/web/bench_patient.mjs [--seconds 30]
// First by the pages themselves, at the same time. Then from outside, one page after the other: the person jumps from foot to foot, and frames of the
// screen show when the dot has jumped. Prints tables without a limit; exit status 1 means that it could not measure. The numbers depend on the load.
import { cpus } from 'node:os';
import { parseArgs } from 'node:util';

import { Browser, loadAverage, openLive, printRow, quantile } from './bench_browser.mjs';
import { measurePixels, stepsDevice } from './bench_pixels.mjs';
import { alteredProtocol, Daemon, Gateway, pause, waitFor } from './support.mjs';

const { values: options } = parseArgs({ options: { seconds: { type: 'string', default: '30' } } });
const seconds = Number(options.seconds);
const untilNext = { 'duration_s = 30 ': 'duration_s = 0 ', 'settle_s = 5 ': 'settle_s = 0 ' };

const ends = (values) => `${quantile(values, 0.5).toFixed(1)} / ${quantile(values, 0.99).toFixed(1)}`;

/** Starts a trial with feedback that lasts until a command. */
const startFeedback = async (daemon) => {
  const next = () => waitFor(() => daemon.ctl('session', 'trial', 'next', '--rig', 'floor').then(() => true, () => false), 'the trial');
  await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'romberg-feedback', '--subject', 'P1');
  for (let command = 0; command < 3; command += 1) await next(); // start and end the trial without feedback, start the one with it
};

/** Returns the ages of the newest scan of the floor when each frame was painted. */
const agesOf = async (page, fromMs) => {
  const frames = await page.evaluate((from) => window.dtsMeasure().filter(({ paintedMs }) => paintedMs > from), fromMs);
  return frames.filter(({ newestMs }) => newestMs !== null).map(({ newestMs, paintedMs }) => paintedMs - newestMs);
};

const daemon = await Daemon.started({ devices: { 'sim:floor?seed=7': stepsDevice() }, protocols: (folder) => alteredProtocol(folder, 'romberg-feedback', untilNext) });
const browser = await Browser.opened();
const gateway = await Gateway.started(daemon);
const { product } = await browser.send('Browser.getVersion');
console.log(`# Scan to pixel: ${product}, drawing in software, ${cpus().length} x ${cpus()[0].model.trim()}, load ${loadAverage()}`);
await startFeedback(daemon);
const pages = { 'live floor': await openLive(browser, gateway.url, 'floor'), 'patient screen': await openLive(browser, gateway.url, 'patient/floor') };
const all = Object.entries(pages);
const isFeedback = () => document.querySelector('[data-testid="patient-target"]')?.dataset.feedback === 'true';
await waitFor(() => pages['patient screen'].evaluate(isFeedback), 'the patient screen shows feedback');
const fromMs = await Promise.all(all.map(([, page]) => page.evaluate(() => performance.now())));
await pause(1000 * seconds);
console.log('\n## By the pages themselves, at the same time: age of the newest scan when painted, median / 99th percentile, ms\n');
printRow('page', 'blocks', 'ms', 'load');
printRow('---', '---', '---', '---');
for (const [index, [name, page]] of all.entries()) {
  const ages = await agesOf(page, fromMs[index]);
  printRow(name, ages.length, ends(ages), loadAverage());
}
for (const [, page] of all) await page.close();
console.log('\n## From outside, one page after the other: from the newest scan of the block to the browser having the frame, median / 99th percentile, ms\n');
printRow('page', 'jumps', 'seen', 'ms', 'frames/s of the screen', 'load');
printRow('---', '---', '---', '---', '---', '---');
for (const [name, address] of [['live floor', 'floor'], ['patient screen', 'patient/floor']]) {
  const page = await openLive(browser, gateway.url, address);
  const seen = await measurePixels(daemon, page, seconds);
  printRow(name, seen.jumps, seen.shownMs.length, ends(seen.shownMs), seen.framesPerSecond.toFixed(0), loadAverage());
  await page.close();
}
await gateway.close();
await daemon.close();
await browser.close();
process.exit(0);
