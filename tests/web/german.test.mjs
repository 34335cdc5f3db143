// SPDX-License-Identifier: Apache-2.0
// The dashboard in German. The same pages are opened in both languages: no text of the English page is on the German one.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, waitFor } from './support.mjs';
import { Bench, by, goTo, Tabs, textOf, waitForText } from './support_browser.mjs';

const shorter = { 'settle_s = 5': 'settle_s = 1', 'duration_s = 20': 'duration_s = 3' };

/** Returns every text of a page that a person reads or hears. */
const textsOf = (page) =>
  page.evaluate(() => {
    const texts = new Set();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) texts.add(walker.currentNode.data.trim());
    for (const element of document.querySelectorAll('[aria-label], [title], [placeholder], [data-label]')) {
      for (const name of ['aria-label', 'title', 'placeholder', 'data-label']) texts.add((element.getAttribute(name) ?? '').trim());
    }
    for (const option of document.querySelectorAll('option')) texts.add(option.textContent.trim());
    return [...texts];
  });

// The same in both languages: names, keys, units, and words that German has too.
const shared =
  /^(English|Deutsch|Auto|Esc|Tab|Name|Sensor|Position \(mm\)|Signal \(V\)|System|Text|Export|Median|Minimum|Maximum|Version|SHA-256|BIDS \(zip\)|Live|local|floor|chair|sim[:-].*|Simulated .*|P1|Text|RMS.*|[0-9a-f]{10,}.*|\/.*|.*\.xdf|[a-z_]+ [a-z_]+=.*|[a-z-]+\/[A-Z0-9_]+|ch\d, .*|[a-z_]+|[A-Z0-9_]+|[0-9T]+Z-.*|.* (ms|mm|kB|MB|GB|Hz|µs|kg)|[0-9:]+( (s|min|h))?|Filter)$/;
const isWords = (text) => /\p{Letter}{3}/u.test(text) && !shared.test(text);

describe('german', () => {
  let bench;
  let daemon;
  let page;
  let english;
  let englishTabs;
  let id;
  before(async () => {
    bench = await Bench.opened({
      daemon: { protocols: (folder) => alteredProtocol(folder, 'quiet-standing', shorter) },
      gateway: () => ['--local-role', 'engineer'],
      tabs: { locale: 'de-DE' },
    });
    ({ daemon } = bench);
    page = await bench.tabs.open('floor');
    englishTabs = await Tabs.opened(bench.browser, bench.gateway);
    english = await englishTabs.open('floor');
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
    id = await daemon.measuredStanding('P1');
    await daemon.ctl('session', 'stop');
  });
  after(async () => {
    await englishTabs?.close();
    await bench?.close();
  });

  /** Fails if both pages share a sentence. */
  const assertGerman = async (name) => {
    const known = new Set((await textsOf(english)).filter(isWords));
    assert.ok(known.size > 5, `${name}: the English page has texts`);
    const left = (await textsOf(page)).filter((text) => isWords(text) && known.has(text));
    assert.deepEqual(left, [], `${name}: still English`);
  };

  const pages = {
    floor: (one) => by(one, 'open-start').waitFor(),
    chair: (one) => by(one, 'prompt').waitFor(),
    sessions: (one) => by(one, 'session-row').first().waitFor(),
    'sessions/ID': (one) => by(one, 'report-frame').waitFor(),
    'subjects/P1': (one) => by(one, 'session-row').first().waitFor(),
    health: (one) => waitForText(one, 'volts-floor-w4', /\d/),
  };

  for (const [name, isShown] of Object.entries(pages)) {
    test(`no English sentence is left: ${name}`, async () => {
      for (const one of [page, english]) {
        await goTo(one, name.replace('ID', id));
        await isShown(one);
      }
      await assertGerman(name);
    });
  }

  // requirement: UI-12
  test('the form of a session is German: protocols, fields and choices too', async () => {
    for (const one of [page, english]) {
      await goTo(one, 'floor');
      await by(one, 'open-start').click();
      await by(one, 'start-protocol').selectOption('quiet-standing');
      await by(one, 'field-sex').waitFor();
    }
    await assertGerman('the form');
    const form = await textOf(page, 'start-session');
    for (const words of ['Ruhiges Stehen', 'Körpergewicht (kg)', 'Alter (Jahre)', 'weiblich', 'Untersuchung starten']) assert.ok(form.includes(words), words);
    await by(page, 'start-session-close').click();
    await by(english, 'start-session-close').click();
  });

  test('a rejected command says in German what is wrong', async () => {
    await by(page, 'open-start').click();
    await by(page, 'start-protocol').selectOption('quiet-standing');
    await by(page, 'start-subject').fill('a b');
    await by(page, 'start-submit').click();
    await waitForText(page, 'start-session', /Die Personen-ID darf höchstens 64 Buchstaben/);
    await by(page, 'start-session-close').click();
  });

  test('the report is German, with a decimal comma, and its figures are those of the English one', async () => {
    const textOfReport = async (one) => {
      await goTo(one, `sessions/${id}`);
      await by(one, 'report-frame').waitFor();
      const frame = one.frameLocator('[data-testid="report-frame"]');
      await frame.locator('table').first().waitFor();
      return { language: await frame.locator('html').getAttribute('lang'), text: await frame.locator('body').innerText() };
    };
    const german = await textOfReport(page);
    const other = await textOfReport(english);
    assert.deepEqual([german.language, other.language], ['de', 'en']);
    assert.match(german.text, /Mittlere Geschwindigkeit/);
    assert.doesNotMatch(german.text, /Mean velocity/);
    const figures = (text) => text.match(/(?<=^|\t)\d+[.,]\d{2,}(?=\t|$)/gm)?.map((number) => number.replace(',', '.')) ?? [];
    assert.ok(figures(other.text).length > 5, other.text); // the cells of a row have tabs between them
    assert.deepEqual(figures(german.text), figures(other.text));
  });

  test('the choice in the header changes the language, and the browser keeps it', async () => {
    assert.equal(await page.evaluate(() => document.documentElement.lang), 'de');
    assert.match(await page.title(), /Taktile Messung/);
    await goTo(page, 'floor');
    await by(page, 'language').selectOption('en');
    await waitForText(page, 'tab-floor', 'Live floor');
    await page.reload();
    await waitForText(page, 'tab-floor', 'Live floor');
    assert.equal(await page.evaluate(() => document.documentElement.lang), 'en');
    await by(page, 'language').selectOption('de');
    await waitForText(page, 'tab-floor', 'Boden live');
  });

  test('no request went to another host, and nothing violated the policy', async () => {
    await bench.tabs.close();
  });
});

/** Keeps every text that the page shows from now on, also those that are gone again. */
const rememberTexts = (page) =>
  page.evaluate(() => {
    window.texts = new Set();
    const look = () => {
      const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
      while (walker.nextNode()) window.texts.add(walker.currentNode.data.trim());
    };
    new MutationObserver(look).observe(document.body, { subtree: true, childList: true, characterData: true });
    look();
  });

const rememberedTexts = (page) => page.evaluate(() => [...window.texts]);

/** Waits until the page has shown a text. */
const hasShown = (page, pattern) => {
  let texts;
  return waitFor(
    async () => {
      texts = await rememberedTexts(page);
      return texts.some((text) => pattern.test(text));
    },
    () => `${pattern}; shown: ${texts.join(' | ')}`,
    240_000,
  );
};

describe('german, when something is wrong', () => {
  let bench;
  let daemon;
  let englishTabs;
  let pages; // [German, English]
  let id;
  before(async () => {
    const devices = {
      'sim:floor?seed=7': 'sim:floor?seed=7&fault=unplug&fault_at_s=90&fault_for_s=6',
      'sim:chair?seed=5': 'sim:chair?seed=5&fault=stuck&fault_channel=0&fault_at_s=1&fault_for_s=3600',
    };
    bench = await Bench.opened({
      daemon: { devices, protocols: (folder) => alteredProtocol(folder, 'quiet-standing', shorter) },
      gateway: () => ['--local-role', 'engineer'],
      tabs: { locale: 'de-DE' },
    });
    ({ daemon } = bench);
    englishTabs = await Tabs.opened(bench.browser, bench.gateway);
    pages = [await bench.tabs.open('floor'), await englishTabs.open('floor')];
    for (const one of pages) {
      await by(one, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
      await rememberTexts(one);
    }
  });
  after(async () => {
    await englishTabs?.close();
    await bench?.close();
  });

  const onBoth = async (act) => {
    for (const one of pages) await act(one);
  };

  test('a tare is rejected, a trial is rejected, a rig is unplugged and comes back, a sensor does not measure', async () => {
    const [german, english] = pages;
    await onBoth((one) => by(one, 'tare').click());
    await hasShown(german, /^Tarieren abgelehnt: Die Platte des Messplatzes „floor“ ist belastet/);
    await hasShown(english, /^Tare rejected: the plate of rig 'floor' is loaded/);

    id = await daemon.measuredStanding('P1');
    await daemon.ctl('session', 'trial', 'reject');
    await hasShown(german, /^Durchgang 1 verworfen/);
    await hasShown(english, /^Trial 1 rejected/);

    await hasShown(german, /Gerät getrennt; wieder einstecken|lässt sich nicht öffnen: nicht eingesteckt/);
    await hasShown(english, /Device disconnected; plug it in again|not plugged in/);
    await hasShown(german, /^Lücke von .* in den Daten/);
    await hasShown(english, /^Gap of .* in the data/);
    await daemon.ctl('session', 'stop', '--rig', 'floor');

    await onBoth((one) => goTo(one, 'health'));
    await hasShown(german, /^Sensoren, die nicht messen: .* \(unverändert\): Stecker, Versorgung und Abstand zur Platte prüfen/);
    await hasShown(english, /^Sensors that do not measure: .* \(unchanged\)/);
    await onBoth((one) => by(one, 'test-device-floor').click());
    await onBoth((one) => by(one, 'device-channels').first().waitFor());
    await onBoth((one) => by(one, 'tare-chair').click());
    await hasShown(german, /^Tarieren abgelehnt: /);

    await daemon.endedSession(id);
    await onBoth((one) => goTo(one, `sessions/${id}`));
    await onBoth((one) => by(one, 'part-table').waitFor());
    await hasShown(german, /Gerät abgezogen/);
    await hasShown(english, /device unplugged/);
  });

  // requirement: UI-12
  test('the German page showed no sentence that the English page showed', async () => {
    const known = new Set((await rememberedTexts(pages[1])).filter(isWords));
    assert.ok(known.size > 50, `the English page showed ${known.size} texts`);
    const left = (await rememberedTexts(pages[0])).filter((text) => isWords(text) && known.has(text) && !text.includes('sim:'));
    assert.deepEqual(left, []);
  });

  test('no request went to another host, and nothing violated the policy', async () => {
    await bench.tabs.close();
  });
});
