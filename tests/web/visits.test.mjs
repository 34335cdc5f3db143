// SPDX-License-Identifier: Apache-2.0
// A subject with five visits of each rig, who sways less and bends the trunk less from visit to visit: history, trend, plain words, reports, PDF and
// FHIR bundles, in English and in German. Then plan, notes, start of a session, erasure.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';

import { alteredProtocol, Daemon, filesBelow, pause, source, waitFor } from './support.mjs';
import { Bench, by, Tabs, textOf } from './support_browser.mjs';

// What is known of the person at each visit. The arm is measured as 68 cm; how much of it the person uses decides how far the trunk has to bend.
const visits = [
  { sway: 1, usedArmCm: 50 },
  { sway: 0.7, usedArmCm: 54 },
  { sway: 0.5, usedArmCm: 58 },
  { sway: 0.35, usedArmCm: 63 },
  { sway: 0.25, usedArmCm: 68 },
];
const shortStanding = { 'settle_s = 5': 'settle_s = 0.5' }; // and 30 s: long enough for the published variation between two days
const shortReaching = {
  'order = "randomised"': 'order = "as-listed"',
  'blocks = 3': 'blocks = 1',
  'cue_delay_max_s = 2.0': 'cue_delay_max_s = 1.5',
  'duration_s = 5': 'duration_s = 4',
  'block_rest_s = 2': 'block_rest_s = 0',
};
const person = { sex: 'female', side: 'right', age_years: '52', weight_kg: '70', height_cm: '175', arm_length_cm: '68', max_reach_cm: '125' };
const minutesMs = 240_000;

const languages = {
  en: {
    locale: 'en-GB',
    band: 'Known variation between two days, Eyes open: up to 65 % of the mean of both visits',
    steadier: /Eyes open: the mean velocity to the sides is (\d+) % lower than on/,
    within: 'This is within the variation between two days',
    beyond: 'This is more than the variation between two days',
    upright: /^150 % of arm length: the trunk bent [\d.]+° less than on/,
    pdf: { floor: 'Mean velocity', chair: /Trunk class/i },
    classHead: 'Trunk class',
    classes: ['none', 'minor', 'moderate', 'maximum'],
  },
  de: {
    locale: 'de-DE',
    band: 'Bekannte Streuung von Tag zu Tag, Augen offen: bis zu 65 % des Mittels beider Termine',
    steadier: /Augen offen: Die mittlere Geschwindigkeit in seitlicher Richtung ist (\d+) % niedriger als am/,
    within: 'Das liegt innerhalb der Streuung von Tag zu Tag',
    beyond: 'Das ist mehr als die Streuung von Tag zu Tag',
    upright: /^150 % der Armlänge: Der Rumpf beugte sich um [\d,]+° weniger als am/,
    pdf: { floor: 'Mittlere Geschwindigkeit', chair: /Rumpfklasse/i },
    classHead: 'Rumpfklasse',
    classes: ['keine', 'gering', 'mäßig', 'maximal'],
  },
};

/** Writes the COP of a person whose sway has this size: two tones in each direction. */
const writeSway = (file, size) => {
  const tone = (timeS, mm, hz, phase) => size * mm * Math.sin(2 * Math.PI * hz * timeS + phase);
  const rows = Array.from({ length: 2400 }, (_, index) => {
    const timeS = index / 20;
    return [timeS, tone(timeS, 5, 0.31, 0) + tone(timeS, 2, 0.83, 1), tone(timeS, 7, 0.23, 2) + tone(timeS, 2, 0.71, 3)].map((value) => value.toFixed(4)).join();
  });
  writeFileSync(file, ['t_s,x_mm,y_mm', ...rows, ''].join('\n'));
};

const protocols = (folder) => {
  alteredProtocol(folder, 'romberg', shortStanding);
  alteredProtocol(folder, 'reaching-short', shortReaching);
};

/** Starts a session and its first trial. Returns a function that waits until `count` trials are done and ends the session. */
const begun = async (daemon, rig, protocol, fields, count) => {
  const id = (await daemon.ctl('session', 'start', '--rig', rig, '--protocol', protocol, '--subject', 'P017', ...fields)).trim();
  await daemon.ctl('session', 'trial', 'next', '--rig', rig);
  return async () => {
    const done = async () => (await daemon.session(id)).trials.filter(({ outcome }) => outcome === 'done').length >= count;
    await waitFor(done, `${count} trials on ${rig}`, minutesMs);
    await daemon.ctl('session', 'stop', '--rig', rig).catch(() => undefined); // it may have ended by itself
    await daemon.endedSession(id);
  };
};

/** Records all visits into `folder`. They begin one after the other and then run at the same time, each with a daemon and a person of its own. */
const recordVisits = async (folder) => {
  const ends = [];
  for (const [number, { sway, usedArmCm }] of visits.entries()) {
    const cop = path.join(folder, `sway-${number}.csv`);
    writeSway(cop, sway);
    const chair = `sim:chair?seed=5&reaches=cued&people_spread=0&arm_length_cm=${usedArmCm}`;
    const floor = `sim:floor?seed=7&noise_mv=0.3&bits=16&loop=1&cop=${cop}`; // noise would add to the velocity of a small sway
    const daemon = await Daemon.started({ devices: { 'sim:floor?seed=7': floor, 'sim:chair?seed=5': chair }, protocols });
    const fields = Object.entries(person).flatMap(([name, value]) => ['--field', `${name}=${value}`]);
    try {
      const running = daemon.watch('floor/sway');
      await waitFor(() => running.seen.length > 0, 'a person stands, and by then the other one sits');
      const rigs = await Promise.all([begun(daemon, 'floor', 'romberg', [], 1), begun(daemon, 'chair', 'reaching-short', fields, 3)]);
      const ended = Promise.all(rigs.map((end) => end())).then(() => cpSync(daemon.sessions, path.join(folder, 'sessions'), { recursive: true }));
      ends.push(ended.finally(() => daemon.close()));
    } catch (problem) {
      await daemon.close();
      await Promise.allSettled(ends);
      throw problem;
    }
    await pause(1000); // the ID of a session is its second
  }
  await Promise.all(ends);
};

/** Returns what the validator of tests/fhir finds in bundles. */
const findingsOf = (files) => {
  const modules = process.env.DTS_FHIR_MODULES ?? path.join(source, 'build/release/tests/fhir/node_modules');
  const words = [path.join(source, 'tests/fhir/validate.cjs'), path.join(source, 'docs/fhir-codes.json'), ...files];
  const found = Object.entries(JSON.parse(execFileSync(process.execPath, words, { env: { ...process.env, NODE_PATH: modules } })));
  return found.flatMap(([file, checks]) => Object.entries(checks).flatMap(([check, texts]) => texts.map((text) => `${file}: ${check}: ${text}`)));
};

const isFalling = (values) => values.every((value, index) => index === 0 || value < values[index - 1]);

describe('a subject with five visits of each rig', () => {
  let bench;
  let daemon;
  let folder;
  let newest; // session of each rig
  before(async () => {
    folder = mkdtempSync('/tmp/dts-visits-');
    await recordVisits(folder);
    bench = await Bench.opened({ daemon: { protocols, recordings: path.join(folder, 'sessions') } });
    ({ daemon } = bench);
    const { sessions } = await daemon.json('session', 'list');
    newest = Object.fromEntries(['floor', 'chair'].map((rig) => [rig, sessions.find((session) => session.rig === rig)?.session_id]));
  }, { timeout: 600_000 });
  after(async () => {
    await bench?.close();
    rmSync(folder, { recursive: true });
  });

  test('the page lists the subject with its visits and rigs', async () => {
    const page = await bench.tabs.open('subjects');
    await by(page, 'subject-row').waitFor();
    const cells = (await by(page, 'subject-row').locator('th, td').allInnerTexts()).map((text) => text.trim());
    assert.deepEqual([cells[0], cells[2], cells[3]], ['P017', `${2 * visits.length}`, 'chair, floor']);
    await page.getByRole('link', { name: 'P017' }).click();
    await by(page, 'session-row').first().waitFor();
    const rows = await by(page, 'session-row').evaluateAll((all) => all.map((row) => row.dataset.session));
    for (const rig of ['floor', 'chair']) assert.equal(rows.filter((id) => id.includes(`-${rig}`)).length, visits.length, rig);
    await page.close();
  });

  for (const [language, words] of Object.entries(languages)) {
    describe(language, () => {
      let tabs;
      before(async () => (tabs = await Tabs.opened(bench.browser, bench.gateway, { locale: words.locale, acceptDownloads: true })));
      after(() => tabs?.close());

      const downloadOf = async (page, testId) => {
        await by(page, `${testId}-prepare`).click();
        await by(page, testId).waitFor();
        const [download] = await Promise.all([page.waitForEvent('download'), by(page, testId).click()]);
        return download.path();
      };

      // requirement: UI-13 UI-14
      test('sway and trunk angle fall from visit to visit, in the trend and in words', async () => {
        const page = await tabs.open('subjects/P017');
        await by(page, 'subject-trend-plot').waitFor();
        const trend = await daemon.json('subject', 'trend', 'P017');
        /** Returns the shown values, oldest first and of one condition if it is named, after a comparison with those of dtsctl. */
        const shown = async (group, measure, condition) => {
          await by(page, 'subject-trend-group').selectOption(group);
          await by(page, 'subject-trend-measure').selectOption(measure);
          const all = await by(page, 'subject-trend-table').locator('tbody tr').evaluateAll((rows) => rows.map((row) => Number(row.dataset.value)).reverse());
          const series = trend.series.filter((one) => `${one.rig} ${one.protocol}` === group && one.measure === measure);
          const recorded = series.flatMap(({ points }) => points.map(({ value }) => value));
          assert.deepEqual([...all].sort(), [...recorded].sort(), `${group} ${measure}`);
          if (condition === undefined) return all;
          const values = series.find((one) => one.condition === condition).points.map(({ value }) => value);
          assert.deepEqual(all.filter((value) => values.includes(value)), values, 'from the oldest to the newest');
          assert.equal(values.length, visits.length);
          return values;
        };
        const velocity = await shown('floor romberg', 'MVELO_ML', 'eyes-open');
        assert.equal(await textOf(page, 'band'), words.band);
        assert.ok(isFalling(velocity), `${velocity}`);
        for (const [visit, { sway }] of visits.entries()) assert.ok(Math.abs(velocity[visit] / velocity[0] - sway) < 0.1, `${velocity}`);
        await shown('floor romberg', 'PEA95_F', 'eyes-open');
        assert.equal(await by(page, 'band').count(), 0);
        assert.equal(await by(page, 'no-band').count(), 1, 'no source, no band');
        const trunk = await shown('chair reaching-short', 'trunk_mean_deg', '150');
        assert.ok(trunk.at(-1) < trunk[0] - 5, `${trunk}`);
        assert.ok((await shown('chair reaching-short', 'trunk_class')).length > 0); // some reaches have no class

        const changes = await by(page, 'change-words').locator('li').allInnerTexts();
        const steadier = changes.filter((sentence) => words.steadier.test(sentence));
        assert.equal(steadier.length, 2, `since the last and since the first visit: ${changes.join('\n')}`);
        for (const [index, [since, remark]] of [[visits.length - 2, words.within], [0, words.beyond]].entries()) {
          const percent = Math.round(100 * (1 - velocity.at(-1) / velocity[since]));
          assert.equal(words.steadier.exec(steadier[index])[1], `${percent}`);
          assert.ok(steadier[index].includes(remark), steadier[index]);
        }
        assert.equal(changes.filter((sentence) => words.upright.test(sentence)).length, 2, changes.join('\n'));
        if (language === 'en') {
          const plain = await textOf(page, 'plain-words');
          for (const sentence of [...trend.words.changes, ...trend.words.sessions.find(({ session }) => session === newest.chair).sentences])
            assert.ok(plain.includes(sentence), sentence);
        }
        await page.close();
      });

      test('reports and bundles of both rigs open, and other programs read them', async () => {
        const bundles = [];
        for (const rig of ['floor', 'chair']) {
          const id = newest[rig];
          const page = await tabs.open(`sessions/${id}`);
          const frame = page.frameLocator('[data-testid="report-frame"]');
          await frame.locator('h1').waitFor();
          assert.equal(await frame.locator('html').getAttribute('lang'), language);
          assert.match(await frame.locator('body').innerText(), /P017/);

          const pdf = await downloadOf(page, 'report-pdf');
          assert.equal(readFileSync(pdf).subarray(0, 5).toString('latin1'), '%PDF-');
          const text = execFileSync('pdftotext', ['-layout', pdf, '-']).toString();
          assert.match(text, /P017/);
          assert.match(text, new RegExp(words.pdf[rig]));
          if (rig === 'chair') {
            const { trials } = await daemon.session(id);
            const cellsOf = await frame.locator('tr').evaluateAll((rows) => rows.map((row) => [...row.children].map((cell) => cell.textContent.trim())));
            const columns = cellsOf.find((cells) => cells.includes(words.classHead));
            assert.ok(columns, `a table with the column ${words.classHead}`);
            const classed = trials.filter(({ result }) => result.movement?.trunk_class >= 0);
            assert.ok(classed.length > 0, 'a trial with a class');
            for (const { trial, result } of classed) {
              const name = words.classes[result.movement.trunk_class];
              const rows = cellsOf.filter((cells) => cells.length === columns.length && cells[0] === `${trial}`);
              assert.ok(rows.some((cells) => cells[columns.indexOf(words.classHead)] === name), `trial ${trial} is ${name}: ${rows.join('; ')}`);
              const line = text.split('\n').find((one) => new RegExp(`^\\s*${trial}\\s.*\\s${name}\\s`).test(one));
              assert.ok(line, `trial ${trial} is ${name} in the PDF`);
            }
          }

          const unpacked = path.join(folder, `fhir-${language}-${rig}`);
          execFileSync('/usr/bin/python3', ['-m', 'zipfile', '-e', await downloadOf(page, 'export-fhir'), unpacked]);
          const [file] = filesBelow(unpacked).filter((name) => name.endsWith('.json'));
          const bundle = JSON.parse(readFileSync(file));
          const resources = (type) => bundle.entry.map(({ resource }) => resource).filter(({ resourceType }) => resourceType === type);
          assert.equal(resources('Patient')[0].identifier[0].value, 'P017');
          const name = rig === 'floor' ? 'standing-trial' : 'reaching-trial';
          assert.equal(resources('Observation').filter(({ code }) => code.coding?.[0].code === name).length, rig === 'floor' ? 1 : 3);
          bundles.push(file);
          await page.close();
        }
        assert.deepEqual(findingsOf(bundles), []);
      });
    });
  }

  test('a session is planned and started from the subject, and a note is kept', async () => {
    const page = await bench.tabs.open('subjects/P017');
    await by(page, 'plan-protocol').selectOption('romberg');
    await by(page, 'plan-date').fill('2031-12-31');
    await by(page, 'plan-add').click();
    await by(page, 'planned').and(page.locator('[data-state="due"]')).waitFor();
    await by(page, 'note-text').fill('walks with a stick');
    await by(page, 'note-add').click();
    await by(page, 'note').filter({ hasText: 'walks with a stick' }).waitFor();
    const subject = await daemon.json('subject', 'show', 'P017');
    assert.deepEqual(subject.notes.map(({ text }) => text), ['walks with a stick']);
    assert.deepEqual(subject.plan.map(({ protocol, due_date: due }) => [protocol, due]), [['romberg', '2031-12-31']]);

    await by(page, 'start-planned').click();
    await waitFor(async () => (await by(page, 'start-protocol').inputValue()) === 'romberg', 'the planned protocol is chosen');
    assert.equal(await by(page, 'start-subject').inputValue(), 'P017');
    await by(page, 'start-submit').click();
    await by(page, 'plate').waitFor(); // the live page of the rig
    const [session] = (await daemon.json('session', 'list')).sessions;
    assert.deepEqual([session.subject, session.protocol, session.rig], ['P017', 'romberg', 'floor']);
    await daemon.ctl('session', 'trial', 'next', '--rig', 'floor');
    await waitFor(async () => (await daemon.session(session.session_id)).trials.some(({ outcome }) => outcome === 'done'), 'a trial is done', minutesMs);
    await daemon.ctl('session', 'stop', '--rig', 'floor');
    await daemon.endedSession(session.session_id);
    await waitFor(async () => (await daemon.json('subject', 'show', 'P017')).plan[0].session_id === session.session_id, 'the plan names the session');
    await page.close();
  });

  test('after an erasure nothing of the subject is left', async () => {
    await daemon.ctl('subject', 'erase', 'P017', '--yes');
    const page = await bench.tabs.open('subjects');
    await by(page, 'no-subjects').waitFor();
    await page.close();
    await assert.rejects(daemon.ctl('subject', 'trend', 'P017'));
    await assert.rejects(daemon.ctl('subject', 'notes', 'P017'));
  });

  test('no request went to another host, and nothing violated the policy', () => bench.tabs.close());
});
