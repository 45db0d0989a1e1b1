// Runs a script of this folder in Blender, without a window.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';

export function runBlender(script, ...args) {
  return runBlenderAs({}, fileURLToPath(new URL(script, import.meta.url)), ...args);
}

// Runs the script at a path in Blender, and returns what Blender printed. `how` has options for spawnSync(), such as
// `env` and `uid`. Blender uses one thread: with several threads, the sums of normals and the bytes of exported files
// may differ from run to run.
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
