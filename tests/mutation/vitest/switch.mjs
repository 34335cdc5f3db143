// SPDX-License-Identifier: Apache-2.0
// Before each test file: the switch of the mutants that are woven into the sources. Without a mutant, writes down which ones the file comes by.
import fs from 'node:fs';
import path from 'node:path';
import { afterAll, expect, inject } from 'vitest';

const active = inject('mutant');
const reached = new Set();
globalThis.mutant = (name) => {
  reached.add(name);
  return name === active;
};
if (active === '-') {
  afterAll(() => {
    const folder = path.join(process.cwd(), 'reach');
    const test = path.relative(process.cwd(), expect.getState().testPath);
    fs.mkdirSync(folder, { recursive: true });
    fs.writeFileSync(path.join(folder, `${test.replaceAll('/', '_')}.json`), JSON.stringify({ test, reached: [...reached] }));
  });
}
