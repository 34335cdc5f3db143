// SPDX-License-Identifier: Apache-2.0
// Measures latency from outside: a simulated person jumps from foot to foot, dtsctl gives the time of each jump (CLOCK_MONOTONIC), and frames of the
// screen show when the dot has jumped. The page's own measurement is not used.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';

import { pause, waitFor } from './support.mjs';

const halfMm = 8;
const restS = 0.83; // not a multiple of a block or a frame
const jumps = 100;

/** Returns the address of a device whose centre of pressure jumps between two places. */
export const stepsDevice = () => {
  const rows = Array.from({ length: jumps }, (_, jump) => {
    const [from, x] = [jump * restS, jump % 2 === 0 ? -halfMm : halfMm];
    return `${from.toFixed(4)},${x},0\n${(from + restS - 0.0005).toFixed(4)},${x},0\n`;
  });
  const folder = mkdtempSync('/tmp/dts-steps-');
  process.on('exit', () => rmSync(folder, { recursive: true }));
  const file = path.join(folder, 'steps.csv');
  writeFileSync(file, `t_s,x_mm,y_mm\n${rows.join('')}`);
  return `sim:floor?seed=7&cop=${file}&loop=1`;
};

/** Returns CLOCK_REALTIME minus CLOCK_MONOTONIC in ms. */
export const realtimeOffsetMs = () => {
  const before = Date.now();
  let now = before;
  while (now === before) now = Date.now();
  return now - Number(process.hrtime.bigint()) / 1e6;
};

/** Returns, for each block in which the centre of pressure changed sides, the host time of its newest scan in ms and the new side. */
const jumpsIn = (blocks) => {
  const found = [];
  let side = 0;
  for (const { values, channels, host_time_ns: firstNs, rate_hz: rateHz } of blocks) {
    const newest = values.at(-1)[channels.indexOf('ml_mm')];
    if (newest === null || Math.abs(newest) < halfMm / 2) continue;
    if (side !== 0 && Math.sign(newest) !== side) found.push({ timeMs: firstNs / 1e6 + ((values.length - 1) * 1000) / rateHz, side: Math.sign(newest) });
    side = Math.sign(newest);
  }
  return found;
};

/** Runs in a page. Returns the x of the vermillion dot in each picture, or null without a dot. The dot of the inset is a tenth of its size. */
const findDots = async (pictures) => {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d', { willReadFrequently: true });
  const found = [];
  for (const picture of pictures) {
    const image = await createImageBitmap(await (await fetch(`data:image/jpeg;base64,${picture}`)).blob());
    [canvas.width, canvas.height] = [image.width, image.height];
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    let [sum, count] = [0, 0];
    for (let at = 0; at < data.length; at += 4) {
      if (data[at] < 170 || data[at + 1] > 120 || data[at + 2] > 60) continue;
      sum += (at / 4) % image.width;
      count += 1;
    }
    found.push(count > 20 ? sum / count : null);
  }
  return found;
};

const recordScreen = async (page, forMs) => {
  const frames = [];
  page.on('Page.screencastFrame', ({ data, metadata, sessionId }) => {
    frames.push({ data, shownMs: metadata.timestamp * 1000, heldMs: Number(process.hrtime.bigint()) / 1e6 });
    void page.send('Page.screencastFrameAck', { sessionId });
  });
  await page.send('Page.startScreencast', { format: 'jpeg', quality: 80, maxWidth: 640, maxHeight: 400 });
  await pause(forMs);
  await page.send('Page.stopScreencast');
  return frames;
};

/** Finds for each jump the first frame within half a second that shows the dot on the new side. */
const match = (found, frames, middle) => {
  const result = { shownMs: [], heldMs: [] };
  for (const { timeMs, side } of found) {
    const isShown = ({ x, shownMs }) => shownMs > timeMs && shownMs < timeMs + 500 && x !== null && Math.sign(x - middle) === side;
    const first = frames.find(isShown);
    if (first === undefined) continue;
    result.shownMs.push(first.shownMs - timeMs);
    result.heldMs.push(first.heldMs - timeMs);
  }
  return result;
};

/** Measures the latencies of all jumps in `seconds`, by the browser's time of the frame and by its arrival here. */
export const measurePixels = async (daemon, page, seconds) => {
  await pause(25_000); // the picture's zoom follows the ellipse of 20 s
  const watch = daemon.watch('floor/cop');
  await waitFor(() => watch.seen.length > 0, 'dtsctl receives data of the plate');
  const offsetMs = realtimeOffsetMs();
  const frames = await recordScreen(page, 1000 * seconds);
  await watch.close();
  for (const frame of frames) frame.shownMs -= offsetMs;
  const reader = await page.browser.open('about:blank');
  for (let from = 0; from < frames.length; from += 100) {
    const part = frames.slice(from, from + 100);
    (await reader.evaluate(findDots, part.map(({ data }) => data))).forEach((x, index) => (part[index].x = x));
  }
  await reader.close();
  const places = frames.map(({ x }) => x).filter((x) => x !== null);
  assert.ok(places.length > 0, 'no frame of the screen shows the dot');
  const middle = (Math.min(...places) + Math.max(...places)) / 2;
  const isFilmed = ({ timeMs }) => timeMs > frames[0].shownMs && timeMs < frames.at(-1).shownMs - 500;
  const found = jumpsIn(watch.seen).filter(isFilmed);
  return { jumps: found.length, framesPerSecond: frames.length / seconds, ...match(found, frames, middle) };
};
