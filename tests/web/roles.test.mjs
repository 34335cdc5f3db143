// SPDX-License-Identifier: Apache-2.0
// Roles: a viewer can look and cannot act, not even with forged messages; with users, a login is required.
import assert from 'node:assert/strict';
import path from 'node:path';
import { after, before, describe, test } from 'node:test';

import { Gateway, pause, waitFor } from './support.mjs';
import { Bench, by, goTo, Tabs, textOf, waitForText } from './support_browser.mjs';

const password = 'correct horse battery';
const notAllowed = 4; // ErrorCode of control.proto

// Enough of protobuf for a forged request: fields shorter than 128 bytes.
const field = (number, bytes) => [...key(number), bytes.length, ...bytes];
/** Returns the key of a field with bytes; from field 16 on it has two bytes. */
const key = (number) => (number < 16 ? [(number << 3) | 2] : [0x80 | (((number << 3) | 2) & 0x7f), number >> 4]);
const text = (words) => [...Buffer.from(words)];
/** Returns FromBrowser.request with a command: its field number in Request, and its content. */
const forged = (requestId, command, content) => field(4, [...field(1, text(requestId)), ...field(command, content)]);
const commands = {
  startSession: [4, [...field(1, text('floor')), ...field(2, text('free'))]],
  stopSession: [5, field(1, text('floor'))],
  mark: [6, field(1, text('forged'))],
  tare: [7, field(1, text('floor'))],
  testDevice: [9, field(1, text('floor'))],
  trial: [13, [...field(1, text('floor')), 0x10, 1]],
  resumeSession: [14, field(1, text('20260101T000000Z-floor-1'))],
  getAudit: [15, []],
  correctSession: [21, field(1, text('20260101T000000Z-floor-1'))],
  deleteSession: [22, field(1, text('20260101T000000Z-floor-1'))],
  eraseSubject: [25, field(1, text('P1'))],
};

const keepSockets = () => {
  window.sockets = [];
  window.WebSocket = class extends WebSocket {
    constructor(...words) {
      super(...words);
      window.sockets.push(this);
    }
  };
};

/** Sends bytes over the page's own connection. Returns the bytes of the next FromGateway.response as text. */
const answerTo = (page, bytes) =>
  page.evaluate(
    (sent) =>
      new Promise((resolve, reject) => {
        const socket = window.sockets.at(-1);
        const receive = ({ data }) => {
          const received = new Uint8Array(data);
          if (received[0] !== 0x22) return; // field 4: a response
          socket.removeEventListener('message', receive);
          resolve(String.fromCharCode(...received));
        };
        socket.addEventListener('message', receive);
        setTimeout(() => reject(new Error('no answer')), 60_000);
        socket.send(new Uint8Array(sent));
      }),
    bytes,
  );

describe('roles', () => {
  let bench;
  let daemon;
  let tabs;
  before(async () => {
    bench = await Bench.opened({ gateway: () => ['--local-role', 'viewer'] });
    ({ daemon, tabs } = bench);
  });
  after(() => bench?.close());

  const isDisabled = async (page, testId, why) => {
    const button = by(page, testId);
    await button.waitFor();
    assert.equal(await button.getAttribute('aria-disabled'), 'true', testId);
    assert.equal(await page.locator(`[id="${await button.getAttribute('aria-describedby')}"]`).innerText(), why, testId);
    await button.click({ force: true }); // nothing happens
  };

  test('a viewer sees everything and can start nothing', async () => {
    const page = await tabs.open('floor');
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
    assert.equal(await textOf(page, 'who'), 'local, viewer');
    for (const name of ['open-start', 'tare']) await isDisabled(page, name, 'Requires the role operator');
    assert.equal(await by(page, 'start-session').count(), 0);
    await goTo(page, 'chair');
    for (const name of ['open-start', 'tare']) await isDisabled(page, name, 'Requires the role operator');
    await goTo(page, 'health');
    await isDisabled(page, 'test-device-floor', 'Requires the role engineer');
    await isDisabled(page, 'tare-floor', 'Requires the role operator');
    await waitForText(page, 'volts-floor-w1', /\d/);

    const id = (await daemon.ctl('session', 'start', '--rig', 'floor', '--protocol', 'quiet-standing', '--subject', 'V1')).trim();
    const markers = daemon.watch('floor/marker');
    await goTo(page, 'floor');
    for (const name of ['trial-next', 'trial-redo', 'trial-reject', 'stop-session', 'mark']) await isDisabled(page, name, 'Requires the role operator');
    await page.locator('h1').click();
    for (const key of ['a', 'r', 'x', 'Space']) await page.keyboard.press(key);
    await goTo(page, `sessions/${id}`);
    await waitForText(page, 'session-facts', 'V1');
    for (const name of ['open-correct', 'open-delete']) await isDisabled(page, name, 'Requires the role operator');
    await goTo(page, 'subjects/V1');
    await page.getByText(/role operator/).first().waitFor();
    assert.equal(await by(page, 'open-erase').count(), 0);
    await daemon.ctl('mark', 'the end');
    const session = (await daemon.json('status')).rigs.find(({ rig }) => rig.name === 'floor').session;
    assert.equal(session.trial.phase, 'waiting');
    assert.equal(session.trial.trial, 0);
    await daemon.ctl('session', 'stop');
    await waitFor(() => markers.seen.length > 0, 'dtsctl shows the marker'); // events arrive in order, so an earlier one would be here by now
    assert.deepEqual(markers.seen.map(({ event }) => event.text), ['the end']);
    await page.close();
  });

  // requirement: SEC-6
  test('forged commands over the connection of the page are rejected', async () => {
    const before = (await daemon.json('session', 'list')).sessions.length;
    const page = await tabs.context.newPage();
    await page.addInitScript(keepSockets);
    await page.goto(`${bench.gateway.url}/#/floor`);
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();

    for (const [name, [command, content]] of Object.entries(commands)) {
      const answer = Buffer.from(await answerTo(page, forged(`forged-${name}`, command, content)), 'latin1');
      // Response: field 1 is the request's id, field 2 an Error whose field 1 is its code.
      const id = text(`forged-${name}`);
      const at = answer.indexOf(Buffer.from(field(1, id)));
      assert.ok(at > 0, `${name} is answered`);
      const error = answer.subarray(at + 2 + id.length);
      assert.equal(error[0], 0x12, `${name} is rejected`);
      assert.ok(error.indexOf(Buffer.from([0x08, notAllowed])) > 0, `${name} is not allowed`);
    }

    assert.equal((await daemon.json('session', 'list')).sessions.length, before);
    await waitForText(page, 'status-line', '2 rigs OK'); // the connection still works
    await page.close();
  });

  test('no request went to another host, and nothing violated the policy', () => tabs.close());

  test('with users a login is required, and a logout ends it', async () => {
    const users = path.join(daemon.folder, 'users');
    await Gateway.addUser(users, 'anna', 'operator', password);
    const gateway = await Gateway.started(daemon, '--users', users);
    const own = await Tabs.opened(bench.browser, gateway);
    const page = await own.open('floor');
    const logIn = async (word) => {
      await by(page, 'login-user').fill('anna');
      await by(page, 'login-password').fill(word);
      await by(page, 'login-submit').click();
    };
    await by(page, 'login').waitFor();
    assert.equal(await by(page, 'plate').count(), 0);

    await logIn('wrong password');
    await waitForText(page, 'login-error', 'Name or password is wrong.');
    assert.deepEqual(await own.context.cookies(), []);
    await waitForLogin(page, logIn);
    assert.equal(await textOf(page, 'who'), 'anna, operator');
    await by(page, 'load-kg').filter({ hasText: /^(6|7)\d$/ }).waitFor();
    assert.equal(await by(page, 'open-start').getAttribute('aria-disabled'), 'false');
    const [cookie, ...others] = await own.context.cookies();
    assert.deepEqual(others, []);
    assert.equal(cookie.httpOnly, true);
    assert.equal(cookie.sameSite, 'Strict');
    assert.equal(await page.evaluate(() => document.cookie), '');
    await page.reload();
    await waitForText(page, 'who', 'anna, operator'); // remembered

    await by(page, 'log-out').click();
    await by(page, 'login').waitFor();
    assert.equal(await by(page, 'plate').count(), 0);
    const replay = await fetch(`${gateway.url}/api/me`, { headers: { Cookie: `${cookie.name}=${cookie.value}` } });
    const me = await replay.json().catch(() => ({}));
    assert.ok(replay.status === 401 || me.role === 'none', `the cookie is worth nothing any more: ${JSON.stringify(me)}`);
    await own.close();
    await gateway.close();
  });
});

/** Logs in. After a wrong password the gateway may require some seconds of waiting. */
const waitForLogin = async (page, logIn) => {
  for (let tries = 0; tries < 60; tries += 1) {
    await logIn(password);
    const outcome = by(page, 'plate').or(by(page, 'login-error').filter({ hasText: 'Too many tries' }));
    await outcome.first().waitFor();
    if ((await by(page, 'plate').count()) > 0) return;
    await pause(1000);
  }
  assert.fail('the right password does not let in');
};
