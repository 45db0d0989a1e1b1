// Compares the results of `audit` and `bake` with the normals that Blender evaluates for models that Blender exports.
// ctest runs this file as `blender` if Blender is installed.
//
//   CHRONORMAL_SEED  another seed for the models; the seed in use is printed
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { runBlender } from './blender.mjs';
import { errors, readModel } from './blender_truth.mjs';
import { chronormal } from './program.mjs';
import { read } from './reader.mjs';

const SEED = process.env.CHRONORMAL_SEED ?? '51';

// The largest permitted errors in degrees. AT_KEYS is for the base and for each shape key alone. MEAN, for the average
// error, and WORST are for times of the animation.
const AT_KEYS = 0.02;
const MEAN = 0.02;
const WORST = 1;

const text = ({ stills, times }) =>
  [stills, times].map(({ mean, worst }) => `${mean.toFixed(4)} / ${worst.toFixed(3)}`).join(', at times ');

// Bakes a file. Exit code 4 is accepted, since the closest result may exceed the tolerance.
function bake(...args) {
  try {
    chronormal('bake', ...args, '--no-audit', '--quiet');
  } catch (error) {
    if (!/exit code 4\n/.test(error.message)) throw error;
  }
}

function assertNoFaultAtKeys({ subjects, findings }) {
  const atKeys = findings.filter(({ fault, target, kind }) => fault && target !== null && kind !== 'wrong_between');
  const faults = atKeys.map(({ kind, target, worst_degrees: worst }) => `${kind}, target ${target}: ${worst} degrees`);
  assert.deepEqual(faults, []);
  const targets = subjects.filter(({ kind }) => kind === 'target');
  assert.ok(targets.length > 1);
  for (const { name, worst_at_keys_degrees: worst } of targets) assert.ok(worst <= AT_KEYS, `${name}: ${worst}`);
}

// Checks that the audit of an animation finds errors close to `times`, which were measured with Blender's normals. The
// audit takes samples at all recorded times and at other times.
function assertSameBetween({ subjects }, { times }) {
  const { mean_degrees: mean, worst_degrees: worst } = subjects.find(({ kind }) => kind === 'track');
  const message = `audit ${mean} / ${worst} degrees, Blender ${times.mean} / ${times.worst}`;
  assert.ok(worst > times.worst - 0.1 && mean < 1.25 * times.mean && times.mean < 1.25 * mean, message);
}

describe("Blender's own normals", () => {
  let folder, models;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'chronormal_blender_truth_'));
    runBlender('blender_truth.py', folder, SEED);
    const names = readdirSync(folder).flatMap((file) => file.match(/^(.*)\.json$/)?.[1] ?? []);
    models = await Promise.all(names.map((name) => readModel(join(folder, name))));
    assert.ok(models.length >= 6);
  });
  after(() => rmSync(folder, { recursive: true, force: true }));

  // Calls check(model, context of the subtest) for each model, as a subtest.
  async function eachModel(context, check) {
    context.diagnostic(`CHRONORMAL_SEED=${SEED}`);
    for (const model of models) await context.test(model.name, (own) => check(model, own));
  }

  test('are in the files at the base and at every key', (context) =>
    eachModel(context, (model, own) => {
      const found = errors(model.exported, model);
      own.diagnostic(`as exported ${text(found)}`);
      assert.ok(found.stills.worst <= AT_KEYS);
    }));

  test('are no fault at any key by audit, which finds the same errors between', (context) =>
    eachModel(context, (model) => {
      const audited = JSON.parse(chronormal('audit', `${model.path}.glb`, '--json', '--quiet'));
      assertNoFaultAtKeys(audited);
      assertSameBetween(audited, errors(model.exported, model));
    }));

  // In deformed poses, some edges of `facets` become hard because of their angle. The exporter decides in the base pose
  // which corners share a vertex, so no file can show these edges, and the test skips the times of `facets`.
  test('are shown at every time after a bake for a viewer that adds up deltas', (context) =>
    eachModel(context, async (model, own) => {
      const baked = `${model.path}.closest.glb`;
      bake(`${model.path}.glb`, '-o', baked, '--for', 'three', '--tolerance', '0.01');
      const found = errors(await read(baked), model);
      own.diagnostic(`baked ${text(found)}`);
      const { stills, times } = found;
      assert.ok(stills.worst <= AT_KEYS, `at keys up to ${stills.worst} degrees`);
      if (model.name === 'facets') return;
      assert.ok(times.mean <= MEAN && times.worst <= WORST, `${times.mean} / ${times.worst} degrees`);
    }));

  test('are left at keys by every bake for such a viewer', (context) =>
    eachModel(context, async (model, own) => {
      const turned = [];
      for (const options of [[], ['--tolerance', '2'], ['--encode', 'endpoint'], ['--encode', 'exact'], ['--encode', 'harmless']]) {
        const name = options.join(' ') || 'usual';
        const baked = `${model.path}.${options.at(-1) ?? name}.glb`;
        bake(`${model.path}.glb`, '-o', baked, '--for', 'three', ...options);
        const found = errors(await read(baked), model);
        own.diagnostic(`${name}: ${text(found)}`);
        if (!(found.stills.worst <= AT_KEYS)) turned.push(`${name}: up to ${found.stills.worst} degrees`);
      }
      assert.deepEqual(turned, []);
    }));
});
