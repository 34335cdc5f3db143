// SPDX-License-Identifier: Apache-2.0
// Text that wants to do harm, in every text field: it is rejected with a message, or shown as plain text. The page stays as it is.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, waitFor } from './support.mjs';
import { Bench, by, goTo, textOf } from './support_browser.mjs';

const shorter = { 'settle_s = 5': 'settle_s = 1', 'duration_s = 20': 'duration_s = 3' };
const texts = {
  'ten thousand characters': 'x'.repeat(10_000),
  'right to left': '\u202e\u2066ABC\u2069 שלום',
  'control characters': 'a\u0007\u001b[31mred\u0000\u009b2J',
  HTML: '<img src=x onerror="window.harmed=1"><script>window.harmed=1</script>',
  formula: '=cmd|\' /C calc\'!A0',
};

describe('hostile text', () => {
  let bench;
  let daemon;
  let page;
  let id;
  before(async () => {
    bench = await Bench.opened({
      daemon: { protocols: (folder) => alteredProtocol(folder, 'quiet-standing', shorter) },
      gateway: () => ['--local-role', 'engineer'],
    });
    ({ daemon } = bench);
    page = await bench.tabs.open('floor');
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
    id = await daemon.measuredStanding('P1');
  });
  after(() => bench?.close());

  /** Fails if a text became part of the page, or made it wider than its window. */
  const checkUnharmed = async (where) => {
    const found = await page.evaluate(() => ({
      harmed: window.harmed ?? 0,
      images: document.querySelectorAll('img, main script').length,
      excess: document.documentElement.scrollWidth - document.documentElement.clientWidth,
    }));
    assert.deepEqual(found, { harmed: 0, images: 0, excess: 0 }, where);
  };

  test('in a marker', async () => {
    await by(page, 'mark-text').waitFor();
    for (const [name, text] of Object.entries(texts)) {
      await by(page, 'mark-text').fill(text);
      const before = await textOf(page, 'marked');
      await by(page, 'mark').click();
      const isAnswered = async () => (await by(page, 'mark-error').count()) > 0 || (await textOf(page, 'marked')) !== before;
      await waitFor(isAnswered, `an answer to ${name}`);
      await checkUnharmed(`marker, ${name}`);
    }
    await daemon.ctl('session', 'stop');
  });

  test('in the start form', async () => {
    await by(page, 'open-start').waitFor();
    for (const field of ['start-subject', 'start-label']) {
      for (const [name, text] of Object.entries(texts)) {
        await by(page, 'open-start').click();
        await by(page, 'start-protocol').selectOption('free');
        await by(page, field).fill(text);
        await by(page, 'start-submit').click();
        const wrong = page.locator('[data-testid="start-session"] [aria-invalid="true"]');
        await wrong.or(by(page, 'start-error')).or(by(page, 'stop-session')).first().waitFor();
        await checkUnharmed(`${field}, ${name}`);
        if ((await by(page, 'start-session').count()) > 0) {
          assert.ok((await by(page, 'start-session').innerText()).length < 4000, `${field}, ${name}: the message is short`);
          await page.keyboard.press('Escape');
        } else {
          await daemon.ctl('session', 'abort', '--reason', 'a test');
        }
        await by(page, 'open-start').waitFor();
      }
    }
  });

  test('in a correction: shown as plain text, or rejected', async () => {
    for (const field of ['subject', 'label', 'notes', 'reason']) {
      for (const [name, text] of Object.entries(texts)) {
        await goTo(page, 'sessions');
        await by(page, 'session-count').waitFor();
        await goTo(page, `sessions/${id}`);
        await by(page, 'open-correct').click();
        await by(page, 'correct-notes').fill(`notes for ${field} ${name}`);
        await by(page, 'correct-reason').fill('a test');
        await by(page, `correct-${field}`).fill(text);
        await by(page, 'correct-submit').click();
        await by(page, 'correct-saved').or(by(page, 'correct-error')).first().waitFor();
        await checkUnharmed(`correct-${field}, ${name}`);
      }
    }
    await goTo(page, 'sessions');
    await by(page, 'session-row').first().waitFor();
    await checkUnharmed('list');
    await by(page, 'filter-subject').fill(texts.HTML);
    await by(page, 'no-sessions').waitFor();
    await checkUnharmed('filter');
  });

  test('in the address', async () => {
    for (const text of Object.values(texts)) {
      for (const place of ['sessions', 'subjects']) {
        await goTo(page, 'health'); // so that nothing of the page before is taken for an answer
        await by(page, 'disk-state').waitFor();
        await goTo(page, `${place}/${encodeURIComponent(text)}`);
        await (place === 'sessions' ? by(page, 'session-error') : by(page, 'subject-error').or(by(page, 'no-subject'))).first().waitFor();
        await checkUnharmed(`${place}/${text.slice(0, 40)}`);
      }
    }
  });

  test('no request went to another host, and nothing violated the policy', () => bench.tabs.close());
});
