// SPDX-License-Identifier: Apache-2.0
// Starts the real programs as child processes, each daemon with its own folders. All of them end with this process, even if it is killed. Waiting is
// for conditions, with a deadline.
import assert from 'node:assert/strict';
import { execFile, spawn } from 'node:child_process';
import { appendFileSync, cpSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { once } from 'node:events';
import path from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';

export const source = path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../..');
const build = path.join(source, 'build/release');
const programs = process.env.DTS_BIN_DIR ?? path.join(build, 'bin');
const webRoot = process.env.DTS_WEB_ROOT ?? path.join(build, 'share/dts-gateway/web');
export const patienceMs = 60_000; // for two busy cores

/** A browser that draws in software, sends no requests of its own, and needs no sandbox. */
export const chromiumSwitches = [
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

export const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

/** Returns the value of `condition` as soon as it is truthy. `what` is a text for the error, or a function that returns one. */
export const waitFor = async (condition, what, timeoutMs = patienceMs) => {
  const deadline = performance.now() + timeoutMs;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (performance.now() > deadline) assert.fail(`waited ${timeoutMs} ms in vain: ${typeof what === 'function' ? what() : what}`);
    await pause(20);
  }
};

/**
 * Measures by how much a timer of 100 ms is late, for as long as the process lives. Runs in this process, or in a page by page.evaluate(); therefore it
 * uses nothing from outside.
 */
export const measureLateness = () => {
  const periodMs = 100;
  let lastMs = Date.now();
  const turns = [];
  const present = () => ({ atMs: Date.now(), lateMs: Date.now() - lastMs - periodMs });
  const timer = setInterval(() => {
    turns.push(present());
    lastMs = turns.at(-1).atMs;
  }, periodMs);
  timer.unref?.(); // node must not wait for it
  /** Returns the largest lateness from an instant of Date.now() until now, including the present turn. */
  globalThis.worstLatenessMs = (sinceMs) => Math.max(0, present().lateMs, ...turns.filter(({ atMs }) => atMs >= sinceMs).map(({ lateMs }) => lateMs));
};

/** Returns the environment with a daemon's folders in place of others. */
const environmentOf = (folder) => ({
  ...Object.fromEntries(Object.entries(process.env).filter(([name]) => !name.startsWith('DTSD_'))),
  DTSD_RUNTIME_DIR: folder,
  DTSD_STATE_DIR: path.join(folder, 'state'),
});

const running = new Set();
process.on('exit', () => {
  for (const child of running) child.kill('SIGKILL');
});

/** Starts a child that the kernel ends together with this process. */
const start = (name, words, options) => {
  const child = spawn('setpriv', ['--pdeathsig', 'KILL', path.join(programs, name), ...words], { stdio: ['ignore', 'pipe', 'pipe'], ...options });
  running.add(child);
  child.once('exit', () => running.delete(child));
  return child;
};

const isOver = (child) => child.exitCode !== null || child.signalCode !== null;

const stop = async (child, signal = 'SIGTERM') => {
  if (isOver(child)) return;
  const over = once(child, 'exit');
  child.kill(signal);
  await over;
};

/** Collects the objects of `dtsctl watch --jsonl`. */
class Watch {
  constructor(child) {
    this.seen = [];
    this.child = child;
    child.stderr.resume();
    createInterface({ input: child.stdout }).on('line', (line) => this.seen.push(JSON.parse(line)));
  }

  close() {
    return stop(this.child);
  }
}

/**
 * dtsd with the rigs of config/dtsd.toml. `devices` replaces their addresses; `protocols` is called with the folder of protocols. `recordings` is a
 * folder of sessions of other daemons, which this one finds at its start, as after the loss of a catalogue.
 */
export class Daemon {
  constructor({ devices = {}, protocols, recordings } = {}) {
    this.folder = mkdtempSync('/tmp/dts-web-'); // short, because a socket path has at most 107 bytes
    this.environment = environmentOf(this.folder);
    this.config = path.join(this.folder, 'config');
    this.watches = [];
    cpSync(path.join(source, 'config'), this.config, { recursive: true });
    protocols?.(path.join(this.config, 'protocols'));
    this.changeDevices(devices);
    if (recordings !== undefined) cpSync(recordings, this.sessions, { recursive: true });
  }

  /** The folder of its recordings. */
  get sessions() {
    return path.join(this.environment.DTSD_STATE_DIR, 'sessions');
  }

  /** Replaces addresses of devices, from the next start on. */
  changeDevices(devices) {
    const file = path.join(this.config, 'dtsd.toml');
    writeFileSync(file, replaced(readFileSync(file, 'utf8'), devices));
  }

  static async started(options) {
    const daemon = new Daemon(options);
    try {
      await daemon.start();
    } catch (problem) {
      await daemon.close();
      throw problem;
    }
    return daemon;
  }

  async start() {
    this.child = start('dtsd', ['--config', path.join(this.config, 'dtsd.toml'), '--foreground'], { env: this.environment });
    const log = path.join(this.folder, 'dtsd.log');
    for (const stream of [this.child.stdout, this.child.stderr]) stream.on('data', (bytes) => appendFileSync(log, bytes));
    await waitFor(async () => {
      if (isOver(this.child)) assert.fail(`dtsd ended: ${readFileSync(log, 'utf8')}`);
      return this.ctl('--timeout', '1', 'status').then(() => true, () => false);
    }, 'dtsd answers');
  }

  /** Returns what dtsctl prints. Fails with its error output. */
  ctl(...words) {
    const patient = words[0] === '--timeout' ? words : ['--timeout', `${patienceMs / 1000}`, ...words];
    return new Promise((resolve, reject) => {
      const options = { env: this.environment, timeout: 2 * patienceMs, maxBuffer: 1 << 26 };
      execFile(path.join(programs, 'dtsctl'), patient, options, (error, stdout) => (error === null ? resolve(stdout) : reject(error)));
    });
  }

  async json(...words) {
    return JSON.parse(await this.ctl(...words, '--json'));
  }

  async session(id) {
    return this.json('session', 'show', id);
  }

  /** Returns a session once its recording is closed. */
  async endedSession(id) {
    let session;
    await waitFor(async () => (session = await this.session(id)).state !== 'running', 'the recording is closed');
    return session;
  }

  /** Starts a session of quiet standing and measures its first trial. Returns the ID of the session, which still runs. */
  async measuredStanding(subject) {
    const id = (await this.ctl('session', 'start', '--rig', 'floor', '--protocol', 'quiet-standing', '--subject', subject)).trim();
    await this.ctl('session', 'trial', 'next');
    await waitFor(async () => (await this.session(id)).trials.some(({ outcome }) => outcome === 'done'), 'the trial is over');
    return id;
  }

  watch(...topics) {
    const watch = new Watch(start('dtsctl', ['watch', ...topics, '--jsonl'], { env: this.environment }));
    this.watches.push(watch);
    return watch;
  }

  async kill() {
    await stop(this.child, 'SIGKILL');
  }

  async close() {
    await Promise.all(this.watches.map((watch) => watch.close()));
    await stop(this.child);
    rmSync(this.folder, { recursive: true });
  }
}

/** Returns the text with all `changes`. Fails if one of them does not apply. */
export const replaced = (text, changes) =>
  Object.entries(changes).reduce((changed, [before, after]) => {
    assert.ok(changed.includes(before), `the text does not contain: ${before}`);
    return changed.replace(before, after);
  }, text);

/** Changes a shipped protocol. */
export const alteredProtocol = (folder, name, changes) => {
  const file = path.join(folder, `${name}.toml`);
  writeFileSync(file, replaced(readFileSync(file, 'utf8'), changes));
};

/** dts-gateway beside a daemon; `url` is where it listens. */
export class Gateway {
  static async started(daemon, ...words) {
    const gateway = new Gateway();
    gateway.daemon = daemon;
    await gateway.start('127.0.0.1:0', ...words);
    return gateway;
  }

  async start(listen, ...words) {
    this.words = words;
    let output = '';
    const serve = ['serve', '--listen', listen, '--web-root', webRoot, ...words];
    this.child = start('dts-gateway', serve, { env: { ...this.daemon.environment, XDG_CACHE_HOME: path.join(this.daemon.folder, 'cache') } });
    this.child.stdout.resume();
    this.child.stderr.on('data', (bytes) => (output = (output + bytes).slice(-10_000)));
    this.url = await waitFor(() => {
      if (isOver(this.child)) assert.fail(`dts-gateway ended: ${output}`);
      return /^listening on (http:\/\/\S+)\/\n/m.exec(output)?.[1];
    }, () => `dts-gateway says where it listens: ${output}`);
  }

  /** Starts the gateway again with the same options and address. */
  restart() {
    return this.start(new URL(this.url).host, ...this.words);
  }

  async kill() {
    await stop(this.child, 'SIGKILL');
  }

  async close() {
    await stop(this.child);
  }

  /** Adds a user with `password` to a file. */
  static async addUser(file, name, role, password) {
    const child = start('dts-gateway', ['user', 'add', name, '--role', role, '--users', file], { stdio: ['pipe', 'ignore', 'pipe'] });
    let output = '';
    child.stderr.on('data', (bytes) => (output += bytes));
    child.stdin.end(`${password}\n`);
    const [status] = await once(child, 'exit');
    assert.equal(status, 0, output);
  }
}

export const filesBelow = (folder) =>
  readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const file = path.join(folder, entry.name);
    return entry.isDirectory() ? filesBelow(file) : [file];
  });
