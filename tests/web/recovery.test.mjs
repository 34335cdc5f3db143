// SPDX-License-Identifier: Apache-2.0
// Daemon, gateway or rig go away: the page says so in time, never looks alive meanwhile, and comes back by itself.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { waitFor } from './support.mjs';
import { Bench, by, shownScan, textOf, waitForText } from './support_browser.mjs';

const promiseMs = 2000;
const slackMs = 700; // a tick of the page, and a busy machine

/** Keeps when the state of the status line changed, and when the band came and went: Date.now() of the same clock as ours. */
const rememberStates = (page) =>
  page.evaluate(() => {
    window.states = [];
    let before = '';
    const look = () => {
      const now = [document.querySelector('[data-testid="status-line"]').dataset.state, document.querySelector('[data-testid="no-data"]') === null ? '' : 'band'].join(' ').trim();
      if (now !== before) window.states.push({ state: now, atMs: Date.now() });
      before = now;
    };
    new MutationObserver(look).observe(document.body, { subtree: true, childList: true, attributes: true, attributeFilter: ['data-state'] });
    look();
  });

const statesSince = (page, sinceMs) => page.evaluate((from) => window.states.filter(({ atMs }) => atMs >= from), sinceMs);

/** How long after `sinceMs` the page first was in such a state. */
const delayTo = async (page, sinceMs, isIt, what) => {
  let seen;
  const first = await waitFor(async () => {
    seen = await statesSince(page, sinceMs);
    return seen.find(({ state }) => isIt(state));
  }, () => `${what}; seen: ${JSON.stringify(seen)}`);
  return first.atMs - sinceMs;
};

const hasBand = (state) => state.endsWith('band');
/** Seconds of the day in "No data since 12:03:07". */
const sinceOf = async (page) => {
  const [, hours, minutes, seconds] = /since (\d\d):(\d\d):(\d\d)/.exec(await textOf(page, 'no-data'));
  return 3600 * Number(hours) + 60 * Number(minutes) + Number(seconds);
};

const isDimmed = (page) => page.locator('.live-old').evaluate((live) => Number(getComputedStyle(live.querySelector('.live-picture')).opacity) < 1);

describe('recovery', () => {
  let bench;
  let daemon;
  let gateway;
  let tabs;
  let page;
  before(async () => {
    bench = await Bench.opened();
    ({ daemon, gateway, tabs } = bench);
    page = await tabs.open('floor');
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
    await rememberStates(page);
  });
  after(() => bench?.close());

  const checkLive = async () => {
    const watch = daemon.watch('floor/cop');
    await waitFor(() => watch.seen.length > 50, 'dtsctl shows a second of scans');
    const { scan, newest } = await shownScan(page, watch);
    assert.ok(Math.abs(newest - scan) <= 100, `shown is scan ${scan}, newest was ${newest}`);
    await watch.close();
  };

  test('the daemon is killed: said within 2 s, and live again with the new one', async (context) => {
    const killedMs = Date.now();
    await daemon.kill();
    const saidMs = await delayTo(page, killedMs, (state) => state.startsWith('no-daemon'), 'the status line tells of the daemon');
    const bandMs = await delayTo(page, killedMs, hasBand, 'the picture is covered by a band');
    context.diagnostic(`status line after ${saidMs} ms, band after ${bandMs} ms`);
    assert.ok(saidMs < promiseMs + slackMs, `the status line needed ${saidMs} ms`);
    assert.ok(bandMs < promiseMs + slackMs, `the band needed ${bandMs} ms`);
    assert.match(await textOf(page, 'status-line'), /dtsd is silent since/);
    const lastDataS = (killedMs / 1000) % 86_400;
    assert.ok(Math.abs((await sinceOf(page)) - lastDataS) < 2, `${await textOf(page, 'no-data')}, killed at ${new Date(killedMs).toISOString()}`);
    assert.ok(await isDimmed(page));
    assert.equal(await by(page, 'open-start').getAttribute('aria-disabled'), 'true');

    // The new one has a rig that will be unplugged.
    daemon.changeDevices({ 'sim:floor?seed=7': 'sim:floor?seed=8&fault=unplug&fault_at_s=14&fault_for_s=4' });
    await daemon.start();
    await by(page, 'no-data').waitFor({ state: 'detached' });
    await waitForText(page, 'status-line', '2 rigs run');
    await checkLive();
  });

  test('a rig is unplugged: "no data since", and the gap is told when it is back', async () => {
    const gaps = daemon.watch('floor/gap');
    await by(page, 'no-data').waitFor();
    const textIs = await textOf(page, 'no-data');
    const sinceS = await sinceOf(page);
    const nowS = (Date.now() / 1000) % 86_400;
    assert.ok(nowS - sinceS > 1 && nowS - sinceS < 8, `${textIs} at ${new Date().toISOString()}`);
    assert.ok(await isDimmed(page));
    await waitForText(page, 'status-line', 'floor: device lost');
    assert.equal(await by(page, 'guidance').getAttribute('data-state'), 'noData');

    await by(page, 'no-data').waitFor({ state: 'detached' });
    await by(page, 'gap').waitFor();
    const told = Number.parseFloat(/Missing: ([\d.]+) s/.exec(await textOf(page, 'gap'))[1]);
    const gap = gaps.seen.at(-1).event;
    assert.ok(Math.abs(told - gap.missing_scans / 100) < 0.06, `${told} s for ${JSON.stringify(gap)}`);
    await waitForText(page, 'status-line', '2 rigs run');
    await checkLive();
    await gaps.close();
  });

  test('the gateway is killed: said at once, and live again with the new one', async (context) => {
    const killedMs = Date.now();
    await gateway.kill();
    const saidMs = await delayTo(page, killedMs, (state) => state.startsWith('no-gateway'), 'the status line tells of the gateway');
    const bandMs = await delayTo(page, killedMs, hasBand, 'the picture is covered by a band');
    context.diagnostic(`status line after ${saidMs} ms, band after ${bandMs} ms`);
    assert.ok(saidMs < promiseMs, `the status line needed ${saidMs} ms`);
    assert.ok(bandMs < promiseMs + slackMs, `the band needed ${bandMs} ms`);
    assert.match(await textOf(page, 'status-line'), /No connection since/);
    assert.ok(await isDimmed(page));

    await gateway.restart();
    const upMs = Date.now();
    await by(page, 'no-data').waitFor({ state: 'detached' });
    assert.ok(Date.now() - upMs < 10_000, 'it is tried again at least every two seconds');
    await waitForText(page, 'status-line', '2 rigs run');
    await checkLive();
  });

  test('nothing was asked of another host, nothing broke the policy', () => tabs.close());
});
