// Installs the npm package as a user does: packs it, and unpacks it in a folder that has only its peer dependencies.
//
//   CHRONORMAL_PROGRAM   the native program, to compare with
//   CHRONORMAL_NPM       the folder of the package
import { execFileSync, spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, rmSync, symlinkSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

export const program = resolve(process.env.CHRONORMAL_PROGRAM);

/** Installs the package and returns these functions: native() runs the native program, wasm() the program in the
 * package, and node() Node.js; load() imports a part of the package. */
export function install() {
  const folder = mkdtempSync(join(tmpdir(), 'chronormal-npm-'));
  const installed = join(folder, 'node_modules/chronormal');
  mkdirSync(join(folder, 'node_modules'));
  const packed = execFileSync('npm', ['pack', '--silent', '--pack-destination', folder], { cwd: resolve(process.env.CHRONORMAL_NPM) });
  const tarball = join(folder, packed.toString().trim().split('\n').at(-1));
  execFileSync('tar', ['-xzf', tarball, '-C', folder]);
  cpSync(join(folder, 'package'), installed, { recursive: true });
  mkdirSync(join(folder, 'node_modules/@types'));
  for (const name of ['@gltf-transform', 'three', '@types/three', '@babylonjs', 'playcanvas']) {
    symlinkSync(fileURLToPath(new URL(`node_modules/${name}`, import.meta.url)), join(folder, 'node_modules', name));
  }
  const run = (command, args, options) => {
    const all = { cwd: folder, encoding: 'utf8', maxBuffer: 1 << 28, ...options };
    const { status, stdout, stderr } = spawnSync(command, args, all);
    return { status, stdout, stderr };
  };
  return {
    folder,
    installed,
    tarball,
    remove: () => rmSync(folder, { recursive: true, force: true }),
    load: (part) => import(pathToFileURL(join(installed, 'src', part))),
    native: (args, options) => run(program, args, options),
    wasm: (args, options) => run(process.execPath, [join(installed, 'bin/chronormal.js'), ...args], options),
    node: (args, options) => run(process.execPath, args, options),
  };
}
