// Holds `audit` and `bake` against the normals that Blender itself evaluates for models that it exports. Run by ctest
// as `blender`, where Blender is installed.
//
//   CHRONORMAL_SEED  another seed for the models; the one that is used is printed
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, readdirSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { runBlender } from './blender.mjs';
import { angle } from './exact.mjs';
import { chronormal } from './program.mjs';
import { nodeWeights, read, shownNormals } from './reader.mjs';

const SEED = process.env.CHRONORMAL_SEED ?? '51';

// Degrees that are allowed at the base and at each key alone, and on average and at worst at times of the animation.
const AT_KEYS = 0.02;
const MEAN = 0.02;
const WORST = 1;

// The largest distance at which two places are one; models are about two units wide.
const ROUNDING = 1e-5;

// Reads what blender_truth.py wrote: {loops, instants, place(instant, loop), normal(instant, loop)}.
function readTruth(path) {
  const { loops, instants } = JSON.parse(readFileSync(`${path}.json`, 'utf8'));
  const bytes = readFileSync(`${path}.bin`);
  const numbers = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
  assert.equal(numbers.length, 6 * loops * instants.length);
  const from = (instant, loop, first) => numbers.subarray(6 * (instant * loops + loop) + first).subarray(0, 3);
  return {
    loops,
    instants,
    place: (instant, loop) => from(instant, loop, 0),
    normal: (instant, loop) => from(instant, loop, 3),
  };
}

const vector = (array, v) => array.subarray(3 * v, 3 * v + 3);
const near = (a, b) => a.every((x, c) => Math.abs(x - b[c]) < ROUNDING);
const plus = (array, delta, v) => vector(array, v).map((x, c) => x + (delta?.[3 * v + c] ?? 0));

// Finds the loop of Blender's mesh that each vertex of an exported primitive was made from: it is where the vertex is
// in the base and at each key, and has the nearest normals there.
function loopsOf(primitive, truth) {
  const stills = truth.instants.flatMap(({ time }, i) => (time === undefined ? [i] : []));
  const deltas = [null, ...primitive.targets];
  return Uint32Array.from({ length: primitive.positions.length / 3 }, (_, v) => {
    let [best, apart] = [-1, Infinity];
    for (let loop = 0; loop < truth.loops; ++loop) {
      if (!near(vector(primitive.positions, v), truth.place(0, loop))) continue;
      const here = stills.every((i) => near(plus(primitive.positions, deltas[i]?.positions, v), truth.place(i, loop)));
      if (!here) continue;
      const errors = stills.map((i) => angle(plus(primitive.normals, deltas[i]?.normals, v), truth.normal(i, loop)));
      if (Math.max(...errors) < apart) [best, apart] = [loop, Math.max(...errors)];
    }
    assert.ok(best >= 0, `vertex ${v} is nowhere in Blender`);
    return best;
  });
}

// Reads {name, path, truth, exported, loops}: `path` lacks the ending, `loops` has an array for each primitive.
async function readModel(path) {
  const [truth, exported] = [readTruth(path), await read(`${path}.glb`)];
  const loops = exported.meshes[0].primitives.map((primitive) => loopsOf(primitive, truth));
  return { name: basename(path), path, truth, exported, loops };
}

// Returns the degrees between the normals of a file that was baked from a model and those of Blender: {stills, times},
// each {mean, worst}. The stills are the base and the keys.
function errors(file, { truth, exported, loops }) {
  const result = { stills: { sum: 0, count: 0, worst: 0 }, times: { sum: 0, count: 0, worst: 0 } };
  file.meshes[0].primitives.forEach((primitive, p) => {
    assert.deepEqual(primitive.positions, exported.meshes[0].primitives[p].positions);
    truth.instants.forEach(({ time, weights }, i) => {
      const still = time === undefined;
      // A bake adds targets, which are 0 where a key is set alone.
      const alone = file.meshes[0].weights.map((_, k) => weights[k] ?? 0);
      const normals = shownNormals(primitive, still ? alone : nodeWeights(file, 0, file.animations[0], time));
      const kind = still ? result.stills : result.times;
      loops[p].forEach((loop, v) => {
        const degrees = angle(vector(normals, v), truth.normal(i, loop));
        kind.sum += degrees;
        kind.worst = Math.max(kind.worst, degrees);
        ++kind.count;
      });
    });
  });
  for (const kind of Object.values(result)) kind.mean = kind.sum / kind.count;
  return result;
}

const text = ({ stills, times }) =>
  [stills, times].map(({ mean, worst }) => `${mean.toFixed(4)} / ${worst.toFixed(3)}`).join(', at times ');

// Bakes also where the nearest that can be written is not within the tolerance, which is exit code 4.
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

// The audit samples the animation at all times at which Blender evaluated it, and at more.
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

  // Runs check(model, context of its own) for each model.
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

  // The edges of `facets` become hard by their angle in a deformed pose, and the exporter has fixed before which vertices are one.
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
