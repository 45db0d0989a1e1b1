// Blender without a window, which runs a script of this folder.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';

export function runBlender(script, ...args) {
  const path = fileURLToPath(new URL(script, import.meta.url));
  const options = ['--background', '--factory-startup', '--python-exit-code', '1', '--python', path];
  const { status, stdout, stderr, error } = spawnSync('blender', [...options, '--', ...args], {
    encoding: 'utf8',
    maxBuffer: 1 << 28,
  });
  if (error) throw error;
  assert.equal(status, 0, stderr + stdout);
}
