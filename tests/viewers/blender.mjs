// Runs a script of this folder in Blender, without a window.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';

export function runBlender(script, ...args) {
  return runBlenderAs({}, fileURLToPath(new URL(script, import.meta.url)), ...args);
}

// Runs the script at a path, and returns what Blender printed. `how` has options of spawnSync(), such as `env` and
// `uid`. Blender uses one thread: with several threads, the sums of normals may differ from run to run, and so may the
// bytes of its exports.
export function runBlenderAs(how, path, ...args) {
  const options = ['--background', '--factory-startup', '--threads', '1', '--python-exit-code', '1', '--python', path];
  const { status, stdout, stderr, error } = spawnSync('blender', [...options, '--', ...args], {
    encoding: 'utf8',
    maxBuffer: 1 << 28,
    ...how,
    env: { ...process.env, PYTHONDONTWRITEBYTECODE: '1', ...how.env },
  });
  if (error) throw error;
  assert.equal(status, 0, stderr + stdout);
  return stdout;
}
