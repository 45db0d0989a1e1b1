// Runs tests of this folder. Writes their results to standard output, and in the format TAP to a file.
//
//   CHRONORMAL_PROGRAM=build/release/chronormal node tests/viewers/run.mjs build/release/viewers.tap viewers.test.mjs
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const here = (name) => fileURLToPath(new URL(name, import.meta.url));

if (!existsSync(here('node_modules/three'))) {
  console.error('The npm packages of tests/viewers are missing: run ./test --full browser once, or `npm ci --ignore-scripts` there');
  process.exit(1);
}
const [log, ...files] = process.argv.slice(2);
const tap = ['--test-reporter=tap', `--test-reporter-destination=${log}`];
const spec = ['--test-reporter=spec', '--test-reporter-destination=stdout'];
const options = ['--test', ...spec, ...tap, ...files.map(here)];
const { status } = spawnSync(process.execPath, options, { stdio: 'inherit' });
process.exit(status ?? 1);
