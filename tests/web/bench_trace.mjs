// SPDX-License-Identifier: Apache-2.0
// The cost of frames for a page's main thread, from Chromium's own trace: it contains everything that ran, not only what the page measures.
import assert from 'node:assert/strict';
import { once } from 'node:events';

import { pause } from './support.mjs';

const traceFor = async (browser, durationMs) => {
  const events = [];
  const collect = ({ value }) => events.push(...value);
  browser.on('Tracing.dataCollected', collect);
  const includedCategories = ['devtools.timeline', 'disabled-by-default-devtools.timeline', 'toplevel'];
  await browser.send('Tracing.start', { transferMode: 'ReportEvents', traceConfig: { includedCategories } });
  await pause(durationMs);
  const complete = once(browser, 'Tracing.tracingComplete');
  await browser.send('Tracing.end');
  await complete;
  browser.off('Tracing.dataCollected', collect);
  return events;
};

const threadOf = ({ pid, tid }) => `${pid}/${tid}`;

/** Returns the events of the page's main thread: the thread with the most animation frames. */
const mainThread = (events) => {
  const frames = new Map();
  for (const event of events) if (event.name === 'FireAnimationFrame') frames.set(threadOf(event), (frames.get(threadOf(event)) ?? 0) + 1);
  const [thread] = [...frames].sort((one, other) => other[1] - one[1])[0] ?? [];
  assert.ok(thread !== undefined, 'the trace shows no animation frame');
  return events.filter((event) => threadOf(event) === thread).sort((one, other) => one.ts - other.ts);
};

/**
 * Returns the time per animation frame in ms: all tasks after the previous frame, up to and including the task that ran it. `wallMs` includes waiting
 * for a core, `cpuMs` does not.
 */
export const mainThreadOfFrames = async (browser, durationMs) => {
  const events = mainThread(await traceFor(browser, durationMs));
  const frames = events.filter(({ name }) => name === 'FireAnimationFrame').map(({ ts }) => ts);
  const tasks = events.filter(({ name, dur }) => name === 'RunTask' && dur !== undefined);
  assert.ok(tasks.length >= frames.length, 'the trace shows fewer tasks than frames');
  const result = { wallMs: [], cpuMs: [] };
  let [wall, cpu, frame] = [0, 0, 0];
  for (const { ts, dur, tdur } of tasks) {
    wall += dur / 1000;
    cpu += (tdur ?? NaN) / 1000;
    if (frame >= frames.length || frames[frame] > ts + dur) continue;
    if (frame > 0) result.wallMs.push(wall), result.cpuMs.push(cpu); // the time before the first frame is unknown
    while (frames[frame] <= ts + dur) frame += 1;
    [wall, cpu] = [0, 0];
  }
  return result;
};
