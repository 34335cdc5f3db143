// SPDX-License-Identifier: Apache-2.0
// Layout on a phone, a tablet, a large screen and with large zoom: nothing is cut off, nothing overlaps, nothing scrolls across; on a tablet and a large
// screen live pages do not scroll. German words are longer: the German pages are checked on large screens too.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, waitFor } from './support.mjs';
import { Bench, by, goTo, Tabs, waitForText } from './support_browser.mjs';

const sizes = [
  { width: 1280, height: 800 },
  { width: 1920, height: 1080 },
];
// A phone, a tablet upright, and a window of 1280 x 1024 px at a zoom of 200 % and 400 % (WCAG 1.4.10): the page may scroll down, never across.
const narrowSizes = [
  { width: 390, height: 844 },
  { width: 768, height: 1024 },
  { width: 640, height: 512 },
  { width: 320, height: 256 },
];
const shorter = { 'settle_s = 5': 'settle_s = 1', 'duration_s = 20': 'duration_s = 3' };
const largestTarget = 48;

/** Returns by how many pixels the page is wider and higher than its window. */
const excess = (page) =>
  page.evaluate(() => {
    const { scrollWidth, scrollHeight, clientWidth, clientHeight } = document.documentElement;
    return { across: scrollWidth - clientWidth, down: scrollHeight - clientHeight };
  });

/** Returns named elements that overlap without one being inside the other, and those that extend beyond the window. */
const collisions = (page) =>
  page.evaluate(() => {
    const isAbove = (element) => getComputedStyle(element).position === 'absolute' || element.closest('.plate-corner, .live-age, .live-band, .floor-notices, .chair-notices, .shell-over') !== null;
    const named = [...document.querySelectorAll('[data-testid]')].filter((element) => element.checkVisibility() && !isAbove(element));
    // What the page has scrolled out of sight covers nothing.
    const boxOf = (element) => {
      const { left, right, top, bottom } = element.getBoundingClientRect();
      const scroller = element.closest('main')?.getBoundingClientRect() ?? { top, bottom };
      return { left, right, top: Math.max(top, scroller.top), bottom: Math.min(bottom, scroller.bottom) };
    };
    const boxes = named.map((element) => ({ element, name: element.dataset.testid, box: boxOf(element) })).filter(({ box }) => box.right > box.left && box.bottom > box.top);
    const found = [];
    for (const [index, one] of boxes.entries()) {
      if (one.box.left < -1 || one.box.right > innerWidth + 1) found.push(`${one.name} is cut off`);
      for (const other of boxes.slice(index + 1)) {
        if (one.element.contains(other.element) || other.element.contains(one.element)) continue;
        const across = Math.min(one.box.right, other.box.right) - Math.max(one.box.left, other.box.left);
        const down = Math.min(one.box.bottom, other.box.bottom) - Math.max(one.box.top, other.box.top);
        if (across > 2 && down > 2) found.push(`${one.name} on ${other.name}: ${Math.round(across)} x ${Math.round(down)} px`);
      }
    }
    return found;
  });

/** Returns controls that are lower than a finger needs. */
const smallTargets = (page, least) =>
  page.evaluate(
    (pixels) =>
      [...document.querySelectorAll('button, a.button, a.tab, select')]
        .filter((control) => control.checkVisibility())
        .filter((control) => control.getBoundingClientRect().height < pixels - 0.5)
        .map((control) => `${control.textContent.slice(0, 30)}: ${control.getBoundingClientRect().height} px`),
    least,
  );

/** Returns the words of table heads that are broken into two lines. */
const brokenWords = (page) =>
  page.evaluate(() => {
    const found = [];
    for (const head of document.querySelectorAll('th')) {
      const walker = document.createTreeWalker(head, NodeFilter.SHOW_TEXT);
      while (head.checkVisibility() && walker.nextNode()) {
        for (const { index, 0: word } of walker.currentNode.data.matchAll(/\p{Letter}+/gu)) {
          const range = document.createRange();
          range.setStart(walker.currentNode, index);
          range.setEnd(walker.currentNode, index + word.length);
          if (new Set([...range.getClientRects()].map(({ top }) => Math.round(top))).size > 1) found.push(`the head "${word}" is broken`);
        }
      }
    }
    return found;
  });

describe('layout', () => {
  let bench;
  let daemon;
  let page;
  let germanTabs;
  let german;
  let id;
  before(async () => {
    bench = await Bench.opened({ daemon: { protocols: (folder) => alteredProtocol(folder, 'quiet-standing', shorter) } });
    ({ daemon } = bench);
    page = await bench.tabs.open('floor');
    germanTabs = await Tabs.opened(bench.browser, bench.gateway, { locale: 'de-DE' });
    german = await germanTabs.open('floor');
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
    id = await daemon.measuredStanding('P1');
  });
  after(async () => {
    await germanTabs?.close();
    await bench?.close();
  });

  /** Does the same on the English and the German page. */
  const onBoth = async (act) => {
    for (const one of [page, german]) await act(one);
  };

  const check = async (name, mayScrollDown) => {
    const found = [...(await checkOne(page, name, [...sizes, ...narrowSizes], mayScrollDown)), ...(await checkOne(german, `German ${name}`, sizes, mayScrollDown))];
    assert.deepEqual(found, []);
  };

  const checkOne = async (page, name, wanted, mayScrollDown) => {
    const found = [];
    for (const size of wanted) {
      await page.setViewportSize(size);
      const where = `${name} at ${size.width} x ${size.height}`;
      let now;
      // A resized page has its final layout after a frame or two.
      await waitFor(
        async () => {
          const { across, down } = await excess(page);
          now = [...(across > 0 ? [`${across} px too wide`] : []), ...(down > 0 && !mayScrollDown && sizes.includes(size) ? [`${down} px too high`] : [])];
          const broken = sizes.includes(size) ? await brokenWords(page) : []; // a narrow page may have to break one
          now = [...now, ...broken, ...(await collisions(page)), ...(await smallTargets(page, largestTarget))].map((words) => `${where}: ${words}`);
          return now.length === 0;
        },
        'a good layout',
      ).catch(() => found.push(...now));
    }
    await page.setViewportSize(sizes[0]);
    return found;
  };

  test('floor, while a session waits after a trial', async () => {
    await onBoth((one) => by(one, 'stop-session').waitFor());
    await waitForText(page, 'sway-note', /final, trial 1/);
    await waitForText(german, 'sway-note', /endgültig, Durchgang 1/);
    await check('floor in a session', false);
    await onBoth(async (one) => {
      const [inside, shown] = await one.locator('.floor-side').evaluate((side) => [side.scrollHeight, side.clientHeight]);
      assert.ok(inside <= shown, `the numbers and buttons need ${inside} px and have ${shown} px`);
    });
  });

  test('floor, between sessions and with the start form', async () => {
    await daemon.ctl('session', 'stop');
    await onBoth((one) => by(one, 'open-start').waitFor());
    await check('floor', false);
    await onBoth(async (one) => {
      await by(one, 'open-start').click();
      await by(one, 'start-protocol').selectOption('quiet-standing');
    });
    await check('floor with the start form', true);
    await onBoth((one) => by(one, 'start-session-close').click());
  });

  test('chair, with a reach', async () => {
    await onBoth(async (one) => {
      await goTo(one, 'chair');
      await waitForText(one, 'trunk-deg', /\d/);
    });
    await check('chair', false);
  });

  test('sessions: list, one, comparison; a subject', async () => {
    const pages = {
      sessions: ['sessions', 'session-row'],
      'a session': [`sessions/${id}`, 'export-bids'],
      comparison: [`compare/${id}/${id}`, 'comparison-table'],
      'a subject': ['subjects/P1', 'session-row'],
    };
    for (const [name, [hash, shown]] of Object.entries(pages)) {
      await onBoth(async (one) => {
        await goTo(one, hash);
        await by(one, shown).first().waitFor();
      });
      if (name === 'a session') await onBoth((one) => by(one, 'report-frame').waitFor());
      await check(name, true);
    }
  });

  test('health', async () => {
    await onBoth(async (one) => {
      await goTo(one, 'health');
      await waitForText(one, 'volts-floor-w4', /\d/);
    });
    await check('health', true);
  });

  test('patient screen, before a session and before a trial', async () => {
    await onBoth(async (one) => {
      await goTo(one, 'patient/floor');
      await by(one, 'patient').and(one.locator('[data-state="idle"]')).waitFor();
    });
    await check('patient screen', false);
    await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'quiet-standing');
    await onBoth((one) => by(one, 'patient').and(one.locator('[data-state="wait"]')).waitFor());
    await check('patient screen before a trial', false);
    const share = await by(page, 'patient-word').evaluate((word) => Number.parseFloat(getComputedStyle(word).fontSize) / innerHeight);
    assert.ok(share > 0.12, `the word has ${share} of the height of the screen; from 3 m it needs an eighth`);
    await daemon.ctl('session', 'stop', '--rig', 'floor');
  });

  test('the report is as high as its page: nothing scrolls within the page', async () => {
    for (const size of [sizes[0], narrowSizes[0]]) {
      await page.setViewportSize(size);
      await goTo(page, `sessions/${id}`);
      await by(page, 'report-frame').waitFor();
      await waitFor(
        () =>
          by(page, 'report-frame').evaluate((frame) => {
            const inner = frame.contentDocument.documentElement;
            return inner.scrollHeight > 100 && inner.scrollHeight <= frame.clientHeight + 1;
          }),
        `the report fits its frame at ${size.width} px`,
      );
      await goTo(page, 'sessions');
    }
    await page.setViewportSize(sizes[0]);
  });

  test('the main number of a live page is at least 48 px high', async () => {
    const main = { floor: ['sway-MVELO'], chair: ['prompt', 'trunk-deg', 'trunk-class'] };
    for (const [name, testIds] of Object.entries(main)) {
      await goTo(page, name);
      for (const testId of testIds) {
        await by(page, testId).waitFor();
        const pixels = await by(page, testId).evaluate((element) => Number.parseFloat(getComputedStyle(element).fontSize));
        assert.ok(pixels >= 48, `${testId}: ${pixels} px`);
      }
    }
  });

  test('a dead daemon: its message covers neither what to do now nor a button', async () => {
    await germanTabs.close();
    germanTabs = undefined;
    await daemon.kill();
    for (const size of [sizes[0], narrowSizes[0], narrowSizes[3]]) {
      await page.setViewportSize(size);
      for (const [name, shown] of [['floor', ['guidance', 'open-start', 'status-line']], ['chair', ['prompt', 'open-start', 'status-line']]]) {
        await goTo(page, name);
        await by(page, 'no-data').waitFor();
        for (const testId of shown) {
          const cover = await by(page, testId).evaluate((element) => {
            element.scrollIntoView({ block: 'center' });
            const { left, top, width, height } = element.getBoundingClientRect();
            const above = document.elementFromPoint(left + width / 2, top + height / 2);
            return element === above || element.contains(above) || above?.contains(element) === true ? '' : (above?.outerHTML.slice(0, 120) ?? 'outside');
          });
          assert.equal(cover, '', `${name} at ${size.width} px: ${testId} is covered`);
        }
        assert.equal(await by(page, 'loud-status').count(), 0, 'the picture says it once');
      }
      assert.ok((await excess(page)).across <= 0, `${size.width} px`);
    }
  });

  test('no request went to another host, and nothing violated the policy', () => bench.tabs.close());
});
