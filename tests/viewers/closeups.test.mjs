// Draws close-ups in three viewers, at the place where an exported file has the most torn edges. Each viewer draws the
// exported file, the baked file, and a still file with Blender's own normals at the same time. Compares the pixels of
// the baked file with the pixels of the still file. ctest runs this file as `blender` if Blender is installed.
//
//   CHRONORMAL_SEED          another seed for the models; the seed in use is printed
//   CHRONORMAL_UPDATE_DOCS=1 writes docs/pictures/closeups.jpg
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { Accessor } from '@gltf-transform/core';
import { runBlender } from './blender.mjs';
import { readModel, truthOf } from './blender_truth.mjs';
import { openPage } from './browser.mjs';
import { length } from './exact.mjs';
import { chronormal } from './program.mjs';
import { newIO, nodeWeights, shownNormals, shownPositions } from './reader.mjs';

const SEED = process.env.CHRONORMAL_SEED ?? '51';
const SIZE = { width: 320, height: 320 };
const PICTURE = fileURLToPath(new URL('../../docs/pictures/closeups.jpg', import.meta.url));
const SHOWN = 'mirrored';  // the model in the picture of the documents
const TORN = 10;         // an edge counts as torn if the error jumps by this many degrees
// The width of the part of a model that a close-up shows, as a share of the size of the model. Torn edges are counted
// around a vertex, in a neighbourhood of the same width.
const NEAR = 0.35;

// The share of the error that may remain after the bake, in the pixels of each viewer. The share is larger for
// Filament, because it does not add up the deltas in the file but stores a unit normal for each target. `facets` is
// skipped, since some of its edges become hard in a pose because of their angle, which no file can represent.
const KEPT = { three: 1 / 8, babylon: 1 / 8, filament: 4 / 5 };
const ROUNDING = 0.1;    // rounding error in degrees: colours have eight bits, and viewers interpolate
const VIEWERS = Object.keys(KEPT);

const vector = (array, v) => array.subarray(3 * v, 3 * v + 3);
const minus = (a, b) => a.map((x, c) => x - b[c]);
const unit = (a) => a.map((x) => x / (length(a) || 1));

// Returns the instant and the place at which an exported file has the most torn edges, as {time, instant, at, from,
// radius}. At a torn edge, the errors of its two vertices differ by more than TORN degrees. `from` is the direction
// from which to look at the place.
function mostTorn({ exported, truth, loops }) {
  let most = { count: -1 };
  truth.instants.forEach(({ time }, instant) => {
    // Filament plays an animation from the beginning again when its end is reached, so the end is skipped.
    if (time === undefined || time >= exported.animations[0].end) return;
    exported.meshes[0].primitives.forEach((primitive, p) => {
      const weights = nodeWeights(exported, 0, exported.animations[0], time);
      const [places, shown] = [shownPositions(primitive, weights), shownNormals(primitive, weights)];
      const radius = length(minus(...[Math.max, Math.min].map((of) => [0, 1, 2].map((c) => places.reduce((m, x, i) => (i % 3 === c ? of(m, x) : m), places[c]))))) / 2;
      const right = (v) => truth.normal(instant, loops[p][v]);
      const error = (v) => minus(unit(vector(shown, v)), unit(right(v)));
      const torn = [];
      for (let i = 0; i < primitive.indices.length; ++i) {
        const [a, b] = [primitive.indices[i], primitive.indices[i % 3 === 2 ? i - 2 : i + 1]];
        if (length(minus(error(a), error(b))) > (TORN * Math.PI) / 180) torn.push(a);
      }
      for (const v of new Set(torn)) {
        const count = torn.filter((w) => length(minus(vector(places, v), vector(places, w))) < NEAR * radius).length;
        if (count > most.count) most = { count, time, instant, at: [...vector(places, v)], from: [...right(v)], radius };
      }
    });
  });
  return most;
}

// Returns a camera that looks at the place `at`, roughly from the direction `from`.
function cameraAt({ at, from, radius }) {
  const degrees = 35, distance = (NEAR * radius) / Math.tan((degrees * Math.PI) / 360);
  const direction = unit(from.map((x, c) => x + [0.2, 0.3, 0.25][c]));
  return { eye: at.map((x, c) => x + distance * direction[c]), at, degrees, near: distance / 50, far: distance + 3 * radius };
}

// Returns the model at an instant as a file that does not move and has Blender's normals.
async function stillAt({ path, exported, truth, loops }, { time, instant }) {
  const io = newIO(), document = await io.read(`${path}.glb`), root = document.getRoot();
  // Filament reads beyond its memory if the extras name targets that the file does not have.
  root.listMeshes()[0].setWeights([]).setExtras({}).listPrimitives().forEach((primitive, p) => {
    const described = exported.meshes[0].primitives[p];
    const weights = nodeWeights(exported, 0, exported.animations[0], time);
    const replace = (name, array) => {
      const accessor = document.createAccessor().setType(Accessor.Type.VEC3).setArray(Float32Array.from(array));
      primitive.setAttribute(name, accessor.setBuffer(root.listBuffers()[0]));
    };
    primitive.listTargets().forEach((target) => primitive.removeTarget(target));
    replace('POSITION', shownPositions(described, weights));
    replace('NORMAL', truthOf({ truth }, instant, loops[p]));
  });
  root.listAnimations().forEach((animation) => animation.dispose());
  root.listNodes().forEach((node) => node.setWeights([]));
  return Buffer.from(await io.writeBinary(document)).toString('base64');
}

describe('closeups of the most torn places', () => {
  let browser, folder, models;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'chronormal_closeups_'));
    runBlender('blender_truth.py', folder, SEED);
    const names = readdirSync(folder).flatMap((file) => file.match(/^(.*)\.json$/)?.[1] ?? []);
    models = await Promise.all(names.map((name) => readModel(join(folder, name))));
    browser = await openPage();
  });
  after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
    assert.deepEqual(browser?.faults, []);
  });

  test('show the truth after a bake', async (context) => {
    context.diagnostic(`CHRONORMAL_SEED=${SEED}`);
    const pictures = [];
    for (const model of models) {
      const place = mostTorn(model);
      if (place.count < 1) {
        context.diagnostic(`${model.name} has no torn edge`);
        continue;
      }
      chronormal('bake', `${model.path}.glb`, '-o', `${model.path}.baked.glb`, '--no-audit', '--quiet');
      const files = ['glb', 'baked.glb'].map((end) => readFileSync(`${model.path}.${end}`).toString('base64'));
      const moment = { time: place.time, truth: await stillAt(model, place), view: cameraAt(place) };
      for (const viewer of VIEWERS)
        await context.test(`${model.name} in ${viewer}`, async (own) => {
          const draw = (...all) => window.closeUpInViewer(...all);
          const { compared, picture } = await browser.page.evaluate(draw, viewer, files, 0, moment, SIZE);
          const [before, after] = compared;
          const text = [before, after].map(({ mean, p99 }) => `${mean.toFixed(3)} / ${p99.toFixed(2)}`).join(' -> ');
          own.diagnostic(`at ${place.time} s, ${place.count} torn edges; mean / 99 % degrees: ${text}`);
          if (model.name === SHOWN) pictures.push({ viewer, picture });
          assert.ok(before.pixels > 5000, `${before.pixels} pixels`);
          if (model.name === 'facets') return;
          assert.ok(after.mean <= KEPT[viewer] * before.mean + ROUNDING && after.p99 <= before.p99 + ROUNDING, text);
        });
    }
    if (process.env.CHRONORMAL_UPDATE_DOCS !== '1') return;
    const sheet = await browser.page.evaluate((...all) => window.sheetOfCloseUps(...all), pictures, SIZE);
    writeFileSync(PICTURE, Buffer.from(sheet.split(',')[1], 'base64'));
  });
});
