// SPDX-License-Identifier: Apache-2.0
// Generates TypeScript from the .proto files into src/generated. It is not committed: every build makes it.
import { spawnSync } from 'node:child_process';
import { mkdirSync, renameSync, rmSync } from 'node:fs';
import { dirname, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const web = resolve(dirname(fileURLToPath(import.meta.url)), '..');
const proto = resolve(web, '../../proto');
const out = resolve(web, 'src/generated');
const fresh = `${out}.${process.pid}`; // so that another build at the same time always finds all files
mkdirSync(fresh, { recursive: true });
const result = spawnSync(
  'protoc',
  [
    `--plugin=protoc-gen-es=${resolve(web, 'node_modules/.bin/protoc-gen-es')}`,
    `--es_out=${fresh}`,
    '--es_opt=target=ts',
    `--proto_path=${proto}`,
    ...['options', 'stream', 'sessions', 'control', 'gateway'].map((name) => `dts/v1/${name}.proto`),
  ],
  { stdio: 'inherit' },
);
if (result.error) console.error(`cannot run protoc: ${result.error.message}; it is in Debian's protobuf-compiler`);
if (result.status !== 0) {
  rmSync(fresh, { recursive: true, force: true });
  process.exit(result.status ?? 1);
}
rmSync(out, { recursive: true, force: true });
renameSync(fresh, out);
