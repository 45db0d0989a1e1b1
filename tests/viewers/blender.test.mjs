// Imports baked files into Blender, and bakes files that Blender exports. ctest runs this file as `blender` if Blender
// is installed (`./test --full pipelines` installs it).
//
// Blender computes normals by itself, so a bake changes no picture in Blender. The bake must not change the shape
// either, and it must be possible to bake an exported file again.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { runBlender } from './blender.mjs';
import { fixtures } from './fixtures.mjs';
import { chronormal } from './program.mjs';
import { newIO } from './reader.mjs';
import { newComplaints } from './validator.mjs';

const DATA = process.env.CHRONORMAL_DATA;
const NO_DATA = DATA ? false : 'set CHRONORMAL_DATA to the folder of the real data to run this test';
const SUZANNE = join(DATA ?? '', 'rigs/blender_suzanne_two_keys.glb');

let folder;
before(() => (folder = mkdtempSync(join(tmpdir(), 'chronormal_blender_'))));
after(() => rmSync(folder, { recursive: true, force: true }));

// Imports a file into Blender and exports it as the file `again`. Returns the report of blender.py.
function throughBlender(input, again) {
  const report = `${again}.json`;
  runBlender('blender.py', input, report, again);
  return JSON.parse(readFileSync(report, 'utf8'));
}

const audited = (path) => JSON.parse(chronormal('audit', path, '--json', '--quiet'));
const kinds = (path) => audited(path).findings.map(({ kind }) => kind);

// Returns the largest distance between the positions of a vertex in two reports of blender.py, `before` and `after`.
// Fails if the names of shape keys have changed.
function distance(before, after) {
  assert.equal(after.meshes.length, before.meshes.length);
  let worst = 0;
  before.meshes.forEach(({ keys, positions }, m) => {
    const now = after.meshes[m];
    assert.deepEqual(now.keys.slice(0, keys.length), keys);
    assert.ok(positions.length > 0);
    assert.equal(now.positions.length, positions.length);
    positions.forEach((x, i) => (worst = Math.max(worst, Math.abs(x - now.positions[i]))));
  });
  return worst;
}

// Gives the targets of a file names, since Blender 3.4 does not import a target without a name.
async function nameTargets(path) {
  const document = await newIO().read(path);
  for (const mesh of document.getRoot().listMeshes())
    for (const primitive of mesh.listPrimitives())
      primitive.listTargets().forEach((target, k) => target.setName(`shape ${k}`));
  await newIO().write(path, document);
}

async function checkRoundTrip(context, original) {
  const before = throughBlender(original, join(folder, 'original_again.glb'));
  context.diagnostic(`Blender ${before.version}`);
  for (const encoding of ['harmless', 'exact']) {
    const [baked, again, anew] = ['baked', 'again', 'anew'].map((name) => join(folder, `${encoding}_${name}.glb`));
    const bake = (from, to) => JSON.parse(chronormal('bake', from, '-o', to, '--encode', encoding, '--force', '--json', '--quiet')).audit;
    const first = bake(original, baked);
    const extras = before.meshes.map(({ keys }) => keys.length);
    const imported = throughBlender(baked, again);
    const apart = distance(before, imported);
    context.diagnostic(`${encoding}: vertices are up to ${apart.toPrecision(2)} from where they were`);
    // Blender 3.4 imports the values of a cubic spline, but not its tangents, so the test compares positions only for
    // the encoding `harmless`.
    if (encoding === 'harmless') assert.ok(apart < 1e-5);
    assert.ok(imported.meshes.some(({ keys }, m) => keys.length > extras[m]), 'the bake added no target');

    assert.ok(kinds(again).includes('emptied'), `${encoding}: ${kinds(again)}`);
    assert.ok(!kinds(again).includes('baked'));
    const second = bake(again, anew);
    assert.deepEqual(await newComplaints(anew, again), []);
    assert.ok(kinds(anew).includes('baked') && !kinds(anew).includes('emptied'), `${encoding}: ${kinds(anew)}`);
    // Blender has computed the normals of the file `again` anew. Such normals are not a polynomial in the weights, so
    // the second bake can only approximate them.
    const text = ({ mean_degrees_before: before, mean_degrees_after: mean, worst_degrees_after: worst }) =>
      `${before.toFixed(3)} on average -> ${mean.toFixed(3)} / ${worst.toFixed(2)}`;
    const outcome = `${encoding}: first ${text(first)}, again ${text(second)}`;
    context.diagnostic(outcome);
    assert.ok(second.mean_degrees_after <= Math.max(1.2 * first.mean_degrees_after + 0.05, 0.1 * second.mean_degrees_before), outcome);
    // A bake must improve the surface as a whole, but a single normal may become slightly worse.
    assert.ok(second.worst_degrees_after <= 1.2 * second.worst_degrees_before + 0.05, outcome);
    const spare = join(folder, 'spare.glb');
    if (encoding === 'harmless') assert.ok(distance(throughBlender(again, spare), throughBlender(anew, spare)) < 1e-5);
  }
}

describe('Blender opens a baked file as it was, and its export can be baked again', () => {
  test('pair', async (context) => {
    const path = join(folder, 'pair.glb');
    await fixtures.pair(path);
    await nameTargets(path);
    await checkRoundTrip(context, path);
  });
  test('Suzanne', { skip: NO_DATA }, (context) => checkRoundTrip(context, SUZANNE));
});
