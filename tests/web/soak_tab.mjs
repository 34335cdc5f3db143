// SPDX-License-Identifier: Apache-2.0
// Measures whether a tab that stays open for hours needs more memory: node tests/web/soak_tab.mjs [--minutes 30]
// Half the time on Live floor, half on Live chair, each in a separate tab. Prints a line per minute, then the slope of each value.
import { readdirSync, readFileSync } from 'node:fs';
import { parseArgs } from 'node:util';

import { Browser, loadAverage, openLive, printRow } from './bench_browser.mjs';
import { Daemon, Gateway, pause } from './support.mjs';

const { values: options } = parseArgs({ options: { minutes: { type: 'string', default: '30' } } });

const residentMib = (pid) => Number(/^VmRSS:\s+(\d+) kB/m.exec(readFileSync(`/proc/${pid}/status`, 'utf8'))[1]) / 1024;

/** Returns sizes after a forced garbage collection, so that only memory in use counts. */
const look = async (page, renderer, gateway) => {
  await page.send('HeapProfiler.collectGarbage');
  const { metrics } = await page.send('Performance.getMetrics');
  const metric = (wanted) => metrics.find(({ name }) => name === wanted).value;
  return {
    'heap MiB': metric('JSHeapUsedSize') / 2 ** 20,
    'renderer MiB': residentMib(renderer),
    nodes: metric('Nodes'),
    listeners: metric('JSEventListeners'),
    'gateway MiB': residentMib(gateway.child.pid),
    descriptors: readdirSync(`/proc/${gateway.child.pid}/fd`).length,
  };
};

/** Returns the slope per hour by least squares. */
const slope = (values, minutes) => {
  const mean = (numbers) => numbers.reduce((sum, number) => sum + number, 0) / numbers.length;
  const [middle, average] = [mean(minutes), mean(values)];
  const spread = minutes.reduce((sum, minute) => sum + (minute - middle) ** 2, 0);
  return (60 * values.reduce((sum, value, index) => sum + (minutes[index] - middle) * (value - average), 0)) / spread;
};

const number = (value) => (Number.isInteger(value) ? String(value) : value.toFixed(2));

/** Returns the minutes to skip at the start, while caches and rings fill. */
const warmUpMinutes = (minutes) => Math.min(3, Math.floor(minutes / 3));

const soak = async (browser, gateway, name, minutes) => {
  const page = await openLive(browser, gateway.url, name);
  await page.send('Performance.enable');
  await page.send('HeapProfiler.enable');
  const renderer = await browser.rendererId();
  const rows = [];
  console.log(`\n## Live ${name}\n`);
  for (let minute = 0; minute <= minutes; minute += 1) {
    const row = await look(page, renderer, gateway);
    if (minute === 0) printRow('minute', ...Object.keys(row), 'load');
    if (minute === 0) printRow('---', ...Object.keys(row).map(() => '---'), '---');
    printRow(minute, ...Object.values(row).map(number), loadAverage());
    rows.push({ minute, ...row });
    if (minute < minutes) await pause(60_000);
  }
  await page.close();
  const warm = rows.slice(warmUpMinutes(minutes));
  if (warm.length < 3) return;
  const perHour = Object.keys(rows[0]).slice(1).map((name) => slope(warm.map((row) => row[name]), warm.map(({ minute }) => minute)).toFixed(2));
  printRow(`per hour, from minute ${warm[0].minute}`, ...perHour, '');
};

const main = async () => {
  const daemon = await Daemon.started();
  const browser = await Browser.opened();
  try {
    const gateway = await Gateway.started(daemon);
    const half = Number(options.minutes) / 2;
    await soak(browser, gateway, 'floor', Math.ceil(half));
    await soak(browser, gateway, 'chair', Math.floor(half));
    await gateway.close();
  } finally {
    await browser.close();
    await daemon.close();
  }
};

await main();
process.exit(0);
