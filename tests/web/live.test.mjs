// SPDX-License-Identifier: Apache-2.0
// Compares every number on the live pages with dtsctl.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { waitFor } from './support.mjs';
import { Bench, by, fixed, shownRecentScan, textOf, waitForText } from './support_browser.mjs';

const gravity = 9.80665;
const swayTiles = { MVELO: 1, PEA95_F: 0, RANGE_AP: 1, RANGE_ML: 1 };

/** Returns the texts of several elements at the same instant; null for an absent one. */
const textsOf = (page, testIds) =>
  page.evaluate((ids) => Object.fromEntries(ids.map((id) => [id, document.querySelector(`[data-testid="${id}"]`)?.textContent ?? null])), testIds);

describe('live pages', () => {
  let bench;
  let daemon;
  let tabs;
  before(async () => {
    bench = await Bench.opened();
    ({ daemon, tabs } = bench);
  });
  after(() => bench?.close());

  test('floor: centre of pressure and load are a scan of the last second', async () => {
    const watch = daemon.watch('floor/cop');
    const page = await tabs.open('floor');
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();

    await waitFor(() => watch.seen.length > 50, 'dtsctl shows a second of scans');

    const { shown, values } = await shownRecentScan(page, watch);

    const [ml, ap, loadN] = values;
    assert.equal(shown.kg, fixed(loadN / gravity, 0));
    const across = `${fixed(Math.abs(ml), 1)} mm ${ml >= 0 ? 'right' : 'left'}`;
    const along = `${fixed(Math.abs(ap), 1)} mm ${ap >= 0 ? 'front' : 'back'}`;
    assert.equal(shown.words, `Centre of pressure ${across}, ${along}. Load ${shown.kg} kg.`);
    await watch.close();
    await page.close();
  });

  // requirement: UI-3
  test('floor: tiles of steadiness are those of one sway event', async () => {
    const watch = daemon.watch('floor/sway');
    const page = await tabs.open('floor');
    const ids = Object.keys(swayTiles).map((symbol) => `sway-${symbol}`);
    const wordsOf = ({ event: { measures } }) =>
      Object.fromEntries(Object.entries(swayTiles).map(([symbol, digits]) => [`sway-${symbol}`, fixed(measures.find((one) => one.symbol === symbol).value, digits)]));

    let shown;
    let expected;
    await waitFor(
      async () => {
        shown = await textsOf(page, ids);
        expected = watch.seen.slice(-60).map(wordsOf); // the last half minute, because the page may be late
        return expected.some((words) => ids.every((id) => words[id] === shown[id]));
      },
      () => `shown ${JSON.stringify(shown)}, events ${JSON.stringify(expected)}`,
    );

    assert.match(await textOf(page, 'sway-note'), /^preliminary, last \d+ s$/);
    assert.equal(await by(page, 'sway').getAttribute('data-kind'), 'preliminary');
    await watch.close();
    await page.close();
  });

  // requirement: UI-3
  test('chair: points, class and angle of a reach are those of its events', async () => {
    const watch = daemon.watch('chair/reach', 'chair/class');
    const page = await tabs.open('chair');
    const classes = ['none', 'minor', 'moderate', 'maximum'];
    /** Returns what the page must show for the newest final reach with a trunk class. */
    const expectation = () => {
      const judged = watch.seen.filter(({ event }) => event.kind === 'class').at(-1)?.event;
      const reach = watch.seen.filter(({ event }) => event.kind === 'reach' && event.number === judged?.number && event.step === 'final').at(-1)?.event;
      if (reach === undefined) return undefined;
      const isMinor = judged.reasons.includes('minor');
      const word = judged.trunk_class < 0 ? 'uncertain' : judged.trunk_class === 1 && isMinor ? 'none or minor' : classes[judged.trunk_class];
      return {
        word,
        // Without a class the angle would be a guess.
        deg: judged.trunk_class < 0 ? '–' : fixed(judged.trunk_deg, 1),
        interval: judged.trunk_class < 0 ? '' : `${fixed(judged.trunk_lo_deg, 0)} to ${fixed(judged.trunk_hi_deg, 0)}° (90 %)`,
        share: judged.probability.map((share) => `${fixed(100 * share, 0)} %`),
        points: ['p1', 'p2', 'p3'].map((name) => `${name.toUpperCase()} ${fixed(reach[name].value_mm, 2)} mm, final`).join('; '),
      };
    };

    let shown;
    let expected;
    await waitFor(
      async () => {
        const texts = await textsOf(page, ['trunk-class', 'trunk-deg', 'trunk-interval', 'class-probability-1', 'class-probability-2', 'class-probability-3']);
        const picture = await by(page, 'transient-picture').getAttribute('aria-label').catch(() => '');
        shown = {
          word: texts['trunk-class'],
          deg: texts['trunk-deg'],
          interval: texts['trunk-interval'],
          share: [1, 2, 3].map((step) => texts[`class-probability-${step}`]),
          points: /now\. (.*)$/.exec(picture)?.[1],
        };
        expected = expectation();
        return expected !== undefined && JSON.stringify(shown) === JSON.stringify(expected);
      },
      () => `shown ${JSON.stringify(shown)}, expected ${JSON.stringify(expected)}`,
    );
    await watch.close();
    await page.close();
  });

  test('health: counters, rates, versions and volts are those of status and stream', async () => {
    const watch = daemon.watch('floor/raw');
    await waitFor(() => watch.seen.length > 50, 'dtsctl shows scans');
    const page = await tabs.open('health');
    await waitForText(page, 'volts-floor-w4', /\d/);
    const earlier = await daemon.json('status');
    const ids = ['scans-floor', 'scans-chair', 'lost-floor', 'lost-chair', 'rate-floor', 'daemon-version', 'device-state-chair', 'volts-floor-w1', 'disk-state'];
    // A status arrives once a second. The page must show one that is later than the first, to lie between both.
    const scansOf = (status, name) => status.rigs.find(({ rig }) => rig.name === name).scans_total;
    const numberOf = (text) => Number(text.replaceAll(',', ''));
    const shown = await waitFor(async () => {
      const texts = await textsOf(page, ids);
      return numberOf(texts['scans-floor']) > scansOf(earlier, 'floor') ? texts : undefined;
    }, 'the page counts on');
    const later = await daemon.json('status');

    for (const name of ['floor', 'chair']) {
      const scans = numberOf(shown[`scans-${name}`]);
      assert.ok(scansOf(earlier, name) <= scans && scans <= scansOf(later, name), `${name}: ${scansOf(earlier, name)} <= ${scans} <= ${scansOf(later, name)}`);
      assert.equal(numberOf(shown[`lost-${name}`].replace('! ', '')), later.rigs.find(({ rig }) => rig.name === name).lost_scans_total);
    }
    assert.match(shown['rate-floor'], /^\d+\.\d\d \/ 100\.00 Hz$/);
    // The rate is measured for every status. The page may show the previous one, and rates vary on a busy machine.
    let rates;
    await waitFor(
      async () => {
        const measured = (await daemon.json('status')).rigs.find(({ rig }) => rig.name === 'floor').measured_rate_hz;
        rates = [Number.parseFloat(await textOf(page, 'rate-floor')), measured];
        return Math.abs(rates[0] - rates[1]) < 2;
      },
      () => `shown and measured rate: ${rates}`,
    );
    assert.equal(shown['daemon-version'], later.version);
    assert.equal(shown['device-state-chair'], 'streaming');
    assert.equal(shown['disk-state'], later.disk.state);
    const scansSeen = watch.seen.length;
    await waitFor(() => watch.seen.length > scansSeen + 50, 'dtsctl shows the scans that the page has shown');
    const volts = watch.seen.flatMap(({ values }) => values.map(([w1]) => w1));
    assert.ok(Math.min(...volts) <= Number(shown['volts-floor-w1']) && Number(shown['volts-floor-w1']) <= Math.max(...volts), `${shown['volts-floor-w1']} V`);
    await watch.close();
    await page.close();
  });

  // requirement: UI-5
  test('no request went to another host, and nothing violated the policy', () => tabs.close());
});
