// Checks that the npm package and the native program write the same bytes and print the same text for files of real
// data. ./test --full npm checks a few files; CHRONORMAL_FULL=1 checks all files.
import assert from 'node:assert/strict';
import { mkdirSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { basename, extname, join, relative } from 'node:path';
import { after, test } from 'node:test';
import { install } from './installed.mjs';

const FULL = process.env.CHRONORMAL_FULL === '1';
const DATA = process.env.CHRONORMAL_DATA;
const NO_DATA = DATA ? false : 'set CHRONORMAL_DATA to the folder of the real data to run this test';

const { folder, remove, native, wasm } = install();
after(remove);

// Returns the paths of all files in a folder and its subfolders, relative to the folder.
const filesOf = (root) =>
  readdirSync(root, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => relative(root, join(entry.parentPath ?? entry.path, entry.name)))
    .sort();

// Runs a command with the native program and with the npm package, each in a separate folder that contains a folder
// `out`.
function both(args) {
  const [expected, found] = [['native', native], ['wasm', wasm]].map(([name, run]) => {
    const cwd = join(folder, name);
    rmSync(cwd, { recursive: true, force: true });
    mkdirSync(join(cwd, 'out'), { recursive: true });
    const said = run(args, { cwd });
    return { ...said, files: filesOf(cwd).map((path) => ({ path, bytes: readFileSync(join(cwd, path)) })) };
  });
  return { expected, found };
}

// Checks that the native program and the npm package give the same results. Returns the number of files that they
// wrote.
function assertSame(args) {
  const { expected, found } = both(args), what = args.join(' ');
  assert.equal(found.status, expected.status, `${what}\n${found.stderr}`);
  assert.equal(found.stderr, expected.stderr, what);
  assert.equal(found.stdout, expected.stdout, what);
  assert.deepEqual(found.files.map(({ path }) => path), expected.files.map(({ path }) => path), what);
  found.files.forEach(({ path, bytes }, f) => {
    const other = expected.files[f].bytes, at = bytes.findIndex((byte, b) => byte !== other[b]);
    assert.ok(bytes.equals(other), `${what}: ${path} is another from byte ${at} of ${other.length}`);
  });
  return found.files.length;
}

const found = DATA
  ? ['gltf', 'rigs', 'attack'].flatMap((part) => filesOf(join(DATA, part)).map((path) => join(DATA, part, path)))
  : [];
// The glTF files of the real data, without the captured face, which takes minutes and which captured_face.test.mjs
// tests.
const models = found.filter((path) => /^\.(gltf|glb|vrm)$/.test(extname(path)) && basename(path) !== 'ict_capture.glb');
const quick = ['AnimatedMorphCube.gltf', '01_cs_morph.gltf', 'wild_times.in.glb'];
const dance = DATA ? join(DATA, 'sequences/rumba_13') : '';

const claim = (what, check) => test(`the package and the program are the same ${what}`, { skip: NO_DATA }, check);

for (const model of FULL ? models : models.filter((path) => quick.includes(basename(path)))) {
  const name = basename(model);
  claim(`in what they bake and say of ${name}`, () => {
    assertSame(['bake', model, '--json', '-o', 'out/baked.glb']);
    assertSame(['audit', model, '--json', '--for', 'all']);
    assertSame(['inspect', model, '--json']);
  });
  if (FULL) claim(`in the other encodings of ${name}`, () => {
    for (const encode of ['harmless', 'exact', 'endpoint']) assertSame(['bake', model, '--encode', encode, '--json', '-o', 'out/baked.glb']);
  });
}

if (FULL) {
  claim('in a baked dance, its audit, and normals of it', () => {
    assert.equal(assertSame(['bake', dance, '--json', '-o', 'out/dance.glb']), 1);
    assert.equal(assertSame(['sample', dance, '--times', '0.3,1.7', '-o', 'out/normals.npz']), 1);
    assertSame(['audit', dance, '--json']);
    assertSame(['inspect', dance, '--json']);
  });

  claim('in normals of each weighting, and in comparing the ways to interpolate', () => {
    const cloth = join(DATA, 'sequences/thick_cloth');
    for (const weighting of ['area', 'uniform', 'angle', 'area-angle', 'max']) {
      assert.equal(assertSame(['sample', cloth, '--weighting', weighting, '--times', '0.25', '-o', 'out/n.npy']), 1);
    }
    assertSame(['compare', cloth, '--json', '--no-times']);
  });
}
