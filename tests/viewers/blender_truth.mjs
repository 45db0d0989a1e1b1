// Reads the normals that Blender evaluates for a model, which blender_truth.py has written. Compares them with the
// normals that a viewer renders by adding up the deltas of a file.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { angle } from './exact.mjs';
import { nodeWeights, read, shownNormals } from './reader.mjs';

// Two positions at this distance or less count as equal. Models are about two units wide.
const ROUNDING = 1e-5;

// Reads the files that blender_truth.py wrote for a model. `loops` is the number of loops (the corners of the
// polygons), and `instants` lists the instants. place() and normal() return the position and the normal of a loop at an
// instant.
export function readTruth(path) {
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

// Returns, for each vertex of an exported primitive, the loop (corner of a polygon) of Blender's mesh from which the
// vertex was made. This loop has the position of the vertex, in the base and at each shape key. If several loops have
// this position, takes the one with the nearest normals.
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

// Returns Blender's normals of the vertices of a primitive at an instant. `loops` has the loop of each vertex.
export function truthOf({ truth }, instant, loops) {
  return Float32Array.from({ length: 3 * loops.length }, (_, i) => truth.normal(instant, loops[Math.floor(i / 3)])[i % 3]);
}

// Reads a model by its path without extension. Returns {name, path, truth, exported, loops}: the result of readTruth(),
// the exported file, and for each primitive an array with the loop of each vertex.
export async function readModel(path) {
  const [truth, exported] = [readTruth(path), await read(`${path}.glb`)];
  const loops = exported.meshes[0].primitives.map((primitive) => loopsOf(primitive, truth));
  return { name: basename(path), path, truth, exported, loops };
}

// Compares the normals of a file that was baked from a model with Blender's normals. Returns the errors in degrees:
// {stills, times}, each {mean, worst}. The stills are the base and the shape keys.
export function errors(file, { truth, exported, loops }) {
  const result = { stills: { sum: 0, count: 0, worst: 0 }, times: { sum: 0, count: 0, worst: 0 } };
  file.meshes[0].primitives.forEach((primitive, p) => {
    assert.deepEqual(primitive.positions, exported.meshes[0].primitives[p].positions);
    truth.instants.forEach(({ time, weights }, i) => {
      const still = time === undefined;
      // In the base and at a single shape key, the weights of correction targets are 0.
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
