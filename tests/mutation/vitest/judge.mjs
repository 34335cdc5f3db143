// SPDX-License-Identifier: Apache-2.0
// Reads lines "MUTANT FILE...", runs the test files (all, if none is named) with the mutant ("-": without one) in one vitest, and answers each
// line with JSON: {ok, ran, failed}.
import path from 'node:path';
import readline from 'node:readline';
import { createVitest } from 'vitest/node';

const vitest = await createVitest('test', { watch: false, bail: 1, reporters: [{}], setupFiles: ['./switch.mjs'], pool: 'threads',
  poolOptions: { threads: { singleThread: true } } });
const tests = await vitest.globTestSpecifications();
for await (const line of readline.createInterface({ input: process.stdin })) {
  const [mutant, ...files] = line.split(' ');
  vitest.provide('mutant', mutant);
  const chosen = tests.filter((test) => files.length === 0 || files.includes(path.relative(process.cwd(), test.moduleId)));
  const { testModules } = await vitest.runTestSpecifications(chosen);
  const failed = testModules.filter((module) => !module.ok()).map((module) => module.moduleId);
  console.log(JSON.stringify({ ok: failed.length === 0, ran: testModules.length, failed }));
}
