// Runs the tests in real hosts: what they say goes to standard output, and as TAP to a file.
//
//   CHRONORMAL_PROGRAM=build/release/chronormal node tests/hosts/run.mjs build/release/hosts.tap
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const here = (name) => fileURLToPath(new URL(name, import.meta.url));

if (!existsSync(here('node_modules/three'))) {
  console.error('The npm packages of tests/hosts are missing: run ./test once, or `npm ci --ignore-scripts` there');
  process.exit(1);
}
const tap = process.argv[2] ? ['--test-reporter=tap', `--test-reporter-destination=${process.argv[2]}`] : [];
const spec = ['--test-reporter=spec', '--test-reporter-destination=stdout'];
const options = ['--test', ...spec, ...tap, here('hosts.test.mjs'), here('filters.test.mjs')];
const { status } = spawnSync(process.execPath, options, { stdio: 'inherit' });
process.exit(status ?? 1);
