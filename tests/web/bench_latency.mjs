// SPDX-License-Identifier: Apache-2.0
// Measures the age of a scan when it is painted, the cost of a picture in the page, and the cost of a tab in the gateway:
//   node tests/web/bench_latency.mjs [--blocks 1000] [--seconds 20]
// Prints tables without a limit; exit status 1 means that it could not measure. The numbers depend on the load of the machine, which is printed.
import { cpus } from 'node:os';
import { parseArgs } from 'node:util';

import { Browser, cpuSeconds, loadAverage, openLive, printRow, quantile, spread } from './bench_browser.mjs';
import { measurePixels, stepsDevice } from './bench_pixels.mjs';
import { openSockets } from './bench_sockets.mjs';
import { mainThreadOfFrames } from './bench_trace.mjs';
import { Daemon, Gateway, pause, waitFor } from './support.mjs';

const { values: options } = parseArgs({ options: { blocks: { type: 'string', default: '1000' }, seconds: { type: 'string', default: '20' } } });
const blocks = Number(options.blocks);
const seconds = Number(options.seconds);

/** Returns the frames that the page measured since `fromMs` of its performance.now(). */
const framesSince = (page, fromMs) => page.evaluate((from) => window.dtsMeasure().filter(({ paintedMs }) => paintedMs > from), fromMs);
const nowIn = (page) => page.evaluate(() => performance.now());

const collectFrames = async (page, enough) => {
  const frames = [];
  let fromMs = await nowIn(page);
  await waitFor(
    async () => {
      await pause(2000);
      frames.push(...(await framesSince(page, fromMs)));
      fromMs = frames.at(-1)?.paintedMs ?? fromMs;
      return enough(frames);
    },
    () => `enough frames; ${frames.length} came`,
    600_000,
  );
  return frames;
};

/** Returns the ages of frames with a scan of the floor; the others have null, because JSON has no NaN. */
const agesOf = (frames) => frames.filter(({ newestMs }) => newestMs !== null).map(({ newestMs, paintedMs }) => paintedMs - newestMs);

const measurePage = async (browser, gateway, name, enough) => {
  const page = await openLive(browser, gateway.url, name);
  const begunMs = performance.now();
  const frames = await collectFrames(page, enough);
  const perSecond = (1000 * frames.length) / (performance.now() - begunMs);
  const ages = agesOf(frames);
  const fromMs = await nowIn(page);
  const traced = await mainThreadOfFrames(browser, 10_000);
  const meanwhile = await framesSince(page, fromMs);
  printRow(
    name,
    frames.length,
    perSecond.toFixed(0),
    ages.length > 0 ? `${ages.length}: ${spread(ages)}` : '-',
    spread(frames.map(({ scriptMs }) => scriptMs)),
    spread(frames.map(({ mainThreadMs }) => mainThreadMs)),
    spread(meanwhile.map(({ mainThreadMs }) => mainThreadMs)),
    spread(traced.wallMs),
    spread(traced.cpuMs),
    loadAverage(),
  );
  await page.close();
};

const measurePages = async (browser, gateway) => {
  console.log('\n## A page alone: median / 95th percentile, ms\n');
  printRow('page', 'frames', 'per s', 'blocks: age of newest scan when painted', 'script', 'main thread', 'the same while traced', 'traced, wall', 'traced, CPU', 'load');
  printRow('---', '---', '---', '---', '---', '---', '---', '---', '---', '---');
  await measurePage(browser, gateway, 'floor', (frames) => agesOf(frames).length >= blocks);
  await measurePage(browser, gateway, 'chair', (frames) => frames.length >= blocks);
};

const printCpu = async (what, count, gateway, framesPerSecond) => {
  await pause(2000);
  const [cpuS, begunMs] = [cpuSeconds(gateway.child.pid), performance.now()];
  const rate = await framesPerSecond();
  const percent = (100 * (cpuSeconds(gateway.child.pid) - cpuS)) / ((performance.now() - begunMs) / 1000);
  printRow(what, count, rate.toFixed(0), percent.toFixed(2), count > 0 ? (percent / count).toFixed(2) : '-', loadAverage());
};

/** Returns the mean frames per second of these pages, over `seconds`. */
const rateOf = async (pages) => {
  const fromMs = await Promise.all(pages.map(nowIn));
  await pause(1000 * seconds);
  const counts = await Promise.all(pages.map(async (page, index) => (await framesSince(page, fromMs[index])).length));
  return counts.reduce((sum, count) => sum + count, 0) / pages.length / seconds;
};

const measureTabs = async (browser, gateway, name, count) => {
  const pages = [];
  for (let tab = 0; tab < count; tab += 1) pages.push(await openLive(browser, gateway.url, name));
  await printCpu(`Live ${name}`, count, gateway, () => rateOf(pages));
  for (const page of pages) await page.close();
};

const measureSockets = async (browser, gateway, topics, count) => {
  const page = await browser.open(`${gateway.url}/icon.svg`);
  const framesSoFar = await openSockets(page, topics, count);
  await printCpu(`socket ${topics.join(' ')}`, count, gateway, async () => {
    const before = await framesSoFar();
    await pause(1000 * seconds);
    return ((await framesSoFar()) - before) / count / seconds;
  });
  await page.close();
};

const measureGateway = async (browser, gateway) => {
  console.log('\n## The gateway: % of a core\n');
  console.log('Tabs that draw in software share these cores, get fewer frames than they want and so cost less; sockets acknowledge at once.\n');
  printRow('what', 'how many', 'frames/s each', 'all', 'each', 'load');
  printRow('---', '---', '---', '---', '---', '---');
  await printCpu('no tab', 0, gateway, async () => (await pause(1000 * seconds), 0));
  for (const count of [1, 8]) await measureTabs(browser, gateway, 'floor', count);
  await measureTabs(browser, gateway, 'chair', 1);
  for (const topic of ['floor/', 'chair/']) await measureSockets(browser, gateway, [topic], 8);
};

const measureSight = async (browser) => {
  const daemon = await Daemon.started({ devices: { 'sim:floor?seed=7': stepsDevice() } });
  try {
    const gateway = await Gateway.started(daemon);
    const page = await openLive(browser, gateway.url, 'floor');
    const fromMs = await nowIn(page);
    const seen = await measurePixels(daemon, page, 60);
    const ages = agesOf(await framesSince(page, fromMs));
    console.log('\n## From outside: the dot on the plate jumps, and frames of the screen show where it is\n');
    printRow('jumps', 'seen', 'ms from newest scan of the block to the browser having the frame', 'to this program having it', 'frames/s of the screen', 'meanwhile by the page itself', 'load');
    printRow('---', '---', '---', '---', '---', '---', '---');
    printRow(seen.jumps, seen.shownMs.length, spread(seen.shownMs), spread(seen.heldMs), seen.framesPerSecond.toFixed(0), spread(ages), loadAverage());
    await gateway.close();
  } finally {
    await daemon.close();
  }
};

const main = async () => {
  const daemon = await Daemon.started();
  const browser = await Browser.opened();
  const { product } = await browser.send('Browser.getVersion');
  console.log(`# The dashboard: ${product}, drawing in software, ${cpus().length} x ${cpus()[0].model.trim()}, load ${loadAverage()}`);
  try {
    const gateway = await Gateway.started(daemon);
    await measurePages(browser, gateway);
    await measureGateway(browser, gateway);
    await gateway.close();
  } finally {
    await daemon.close();
  }
  await measureSight(browser);
  await browser.close();
};

await main();
process.exit(0);
