// SPDX-License-Identifier: Apache-2.0
// A clinician's whole day: once with the keyboard alone, once by touch on a phone. Start, Romberg's test with a rejected and a redone trial, undo,
// correction of a wrong subject ID, report, print, delete and restore, erase.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, waitFor } from './support.mjs';
import { Bench, by, textOf, waitForText } from './support_browser.mjs';

const shorter = { 'settle_s = 5': 'settle_s = 3', 'duration_s = 30': 'duration_s = 6' };
const wrongId = 'P071';
const rightId = 'P017';

const focused = (page) => page.evaluate(() => document.activeElement?.dataset?.testid ?? '');

/** Acts with the keyboard alone. */
class Keys {
  constructor(page) {
    this.page = page;
  }

  /** Presses Tab until the element has the focus. Returns how often. */
  async reach(testId) {
    await by(this.page, testId).waitFor();
    for (let presses = 0; presses < 80; presses += 1) {
      if ((await focused(this.page)) === testId) return presses;
      await this.page.keyboard.press('Tab');
    }
    return assert.fail(`Tab does not reach ${testId}`);
  }

  async press(testId) {
    await this.reach(testId);
    await this.page.keyboard.press('Enter');
  }

  async command(_testId, key) {
    await this.page.keyboard.press(key);
  }

  async enter(testId, text) {
    await this.reach(testId);
    await this.page.keyboard.press('Control+A');
    await this.page.keyboard.type(text);
  }

  async choose(testId, value) {
    await this.reach(testId);
    for (let presses = 0; presses < 20 && (await by(this.page, testId).inputValue()) !== value; presses += 1) await this.page.keyboard.press('ArrowDown');
    assert.equal(await by(this.page, testId).inputValue(), value);
  }

  async submit() {
    await this.page.keyboard.press('Enter');
  }
}

/** Acts by touch. */
class Touch {
  constructor(page) {
    this.page = page;
  }

  async reach() {}

  press(testId) {
    return by(this.page, testId).tap();
  }

  command(testId) {
    return this.press(testId);
  }

  enter(testId, text) {
    return by(this.page, testId).fill(text);
  }

  async choose(testId, value) {
    await by(this.page, testId).selectOption(value);
  }

  submit(testId) {
    return this.press(testId);
  }
}

describe('the whole day', () => {
  let bench;
  let daemon;
  before(async () => {
    bench = await Bench.opened({
      daemon: { protocols: (folder) => alteredProtocol(folder, 'romberg', shorter) },
      gateway: () => ['--local-role', 'engineer'],
      tabs: { hasTouch: true },
    });
    ({ daemon } = bench);
  });
  after(() => bench?.close());

  const is = (page, state) => by(page, 'guidance').and(page.locator(`[data-state="${state}"]`)).waitFor();
  /** A trial runs: on a busy machine, the page may show one of its two states only. */
  const begins = (page) => by(page, 'guidance').and(page.locator('[data-state="settling"], [data-state="measuring"]')).waitFor();
  const chip = (page, trial, outcome) => page.locator(`[data-trial="${trial}"][data-outcome="${outcome}"]`).waitFor();
  const fits = async (page, where) => {
    const [wide, window] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
    assert.ok(wide <= window, `${where}: ${wide} px in a window of ${window} px`);
  };

  const start = async (page, by_) => {
    await is(page, 'standing');
    await by_.press('open-start');
    assert.equal(await focused(page), 'start-protocol', 'the form opens focused');
    await by_.choose('start-protocol', 'romberg');
    await by_.enter('start-subject', wrongId);
    await fits(page, 'start form');
    if (by_ instanceof Keys) assert.ok((await by_.reach('start-submit')) + 1 <= 3, 'Start is at most three tabs from the first field');
    await by_.press('start-submit');
    await is(page, 'first');
  };

  /** Trial 1 is rejected while it runs, and the rejection undone: at once, for an undo is possible for 5 s. */
  const undoneRejection = async (page, by_) => {
    await by_.command('trial-next', 'a');
    await begins(page);
    await by_.command('trial-reject', 'x');
    await waitForText(page, 'toast', 'Trial 1 rejected');
    await by_.command('undo', 'u');
    await by(page, 'toast').waitFor({ state: 'detached' });
    await is(page, 'done');
    await chip(page, 1, 'done');
    assert.match(await textOf(page, 'trial-next'), /^Accept/);
  };

  const rejected = async (page, by_) => {
    await by_.command('trial-next', 'a');
    await begins(page);
    await by_.command('trial-reject', 'x');
    await is(page, 'rejected');
    assert.match(await textOf(page, 'guidance'), /^Trial 2 rejected/);
    await by(page, 'toast').waitFor({ state: 'detached' }); // its time is over: it stays rejected
    await chip(page, 2, 'rejected');
    assert.doesNotMatch(await textOf(page, 'trial-next'), /Accept/);
    for (const testId of ['trial-redo', 'trial-reject']) assert.equal(await by(page, testId).getAttribute('aria-disabled'), 'true', testId);
    if (by_ instanceof Keys) await waitForText(page, 'status-line', 'floor: trial 2 rejected');
  };

  const redone = async (page, by_) => {
    await by_.command('trial-next', 'a');
    await begins(page);
    await by_.command('trial-redo', 'r');
    await waitForText(page, 'toast', 'Trial 3 redone');
    await waitForText(page, 'guidance', 'Redo of trial 3, attempt 2');
    await is(page, 'done');
    await waitForText(page, 'session-id', 'attempt 2');
    await chip(page, 3, 'done');
    await fits(page, 'session');
  };

  const stopped = async (page, by_) => {
    await by_.command('trial-next', 'a');
    await is(page, 'finished'); // on a busy machine, the page may not show "measuring" before the short trial has ended
    await by_.press('stop-session');
    await waitForText(page, 'toast', 'Session stops in 5 s');
    await by_.command('undo', 'u');
    await by(page, 'toast').waitFor({ state: 'detached' });
    assert.equal(await by(page, 'guidance').getAttribute('data-state'), 'finished');
    await by_.press('stop-session');
    await waitForText(page, 'last-session', `Result: ${wrongId}, Romberg's test`); // it stops by itself after 5 s
  };

  const corrected = async (page, by_) => {
    await by_.press('last-session');
    await waitForText(page, 'session-usefulness', '3 of 4 valid');
    await by_.press('open-correct');
    await by(page, 'correct').waitFor();
    assert.equal(await focused(page), 'correct-subject', 'the form opens focused');
    await fits(page, 'correction');
    await by_.enter('correct-subject', rightId);
    await by_.submit('correct-submit');
    await waitForText(page, 'correct', 'Reason is required');
    await by_.enter('correct-reason', 'typed the wrong ID');
    await by_.submit('correct-submit');
    await by(page, 'correct-saved').waitFor();
    await waitForText(page, 'session-facts', `corrected, before: ${wrongId}`);
    assert.match(await page.locator('h1').innerText(), new RegExp(`^${rightId}, Romberg's test, `));
    const { sessions } = await daemon.json('session', 'list');
    assert.equal(sessions[0].subject, rightId);
    return sessions[0].session_id;
  };

  const printed = async (page, by_) => {
    await by(page, 'report-frame').waitFor();
    const [paper] = await Promise.all([page.context().waitForEvent('page'), by_.press('report-print')]);
    await paper.waitForLoadState();
    assert.match(await paper.locator('body').innerText(), new RegExp(rightId));
    if (by_ instanceof Keys) assert.ok((await paper.pdf({ preferCSSPageSize: true })).length > 10_000);
    await paper.close();
  };

  const deletedAndRestored = async (page, by_, id) => {
    await by_.press('open-delete');
    await by_.enter('delete-reason', 'a test');
    await by_.submit('delete-submit');
    await by(page, 'is-deleted').waitFor();
    assert.equal((await daemon.json('session', 'list')).sessions.length, 0);
    await by_.press('restore');
    await by(page, 'open-delete').waitFor();
    assert.deepEqual((await daemon.json('session', 'list')).sessions.map(({ session_id: one }) => one), [id]);
  };

  const erased = async (page, by_) => {
    await by_.press('subject-page');
    await waitForText(page, 'subject-facts', /Sessions\s*1/);
    await by_.press('open-erase');
    await by(page, 'erase').waitFor();
    assert.equal(await focused(page), 'erase-confirm', 'the form opens focused');
    await by_.enter('erase-confirm', 'P01');
    await by_.submit('erase-submit');
    await waitForText(page, 'erase', `Type exactly ${rightId}`);
    await by_.enter('erase-confirm', rightId);
    await by_.submit('erase-submit');
    await waitForText(page, 'erased', `Subject ${rightId} erased: 1 session`);
    await fits(page, 'erased');
    assert.equal((await daemon.json('session', 'list')).sessions.length, 0);
  };

  for (const [name, viewport, How] of [
    ['with the keyboard alone', { width: 1280, height: 800 }, Keys],
    ['by touch at 390 x 844', { width: 390, height: 844 }, Touch],
  ]) {
    test(name, { timeout: 600_000 }, async () => {
      const page = await bench.tabs.open('floor');
      await page.setViewportSize(viewport);
      const how = new How(page);
      await start(page, how);
      await undoneRejection(page, how);
      await rejected(page, how);
      await redone(page, how);
      await stopped(page, how);
      const id = await corrected(page, how);
      await printed(page, how);
      await deletedAndRestored(page, how, id);
      await erased(page, how);
      await waitFor(async () => (await daemon.json('session', 'list')).sessions.length === 0, 'nothing is left');
      await page.close();
    });
  }

  test('no request went to another host, and nothing violated the policy', () => bench.tabs.close());
});
