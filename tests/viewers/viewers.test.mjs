// Tests the output of `chronormal bake` with programs of other projects: the validator of Khronos, a reader that adds
// up targets in float32, three.js and Babylon.js in Chromium, and glTF Transform. ctest runs this file as `in_viewers`.
//
//   CHRONORMAL_PROGRAM        the program
//   CHRONORMAL_CHROMIUM       the browser, if it is not in its usual place
//   CHRONORMAL_DATA           a folder of moving files from other projects, if set
//   CHRONORMAL_FULL=1         tests every file in every viewer
//   CHRONORMAL_UPDATE_DOCS=1  writes docs/pictures/shading.png
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, extname, join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { dedup, prune } from '@gltf-transform/functions';
import { openPage } from './browser.mjs';
import { writeMovingFace } from './face.mjs';
import { fixtures, sequenceFrames, writeStill, writeVase } from './fixtures.mjs';
import { bakeByFormula } from './formula.mjs';
import { compareAnimation, compareFiles, moves, timesOf } from './judge.mjs';
import { chronormal } from './program.mjs';
import { randomNumbers } from './random.mjs';
import { errorsOnly, newIO, read } from './reader.mjs';
import { describeSequence, inOrderOf } from './sequence.mjs';
import { stillMoments } from './still.mjs';
import { complaints, newComplaints } from './validator.mjs';

const FULL = process.env.CHRONORMAL_FULL === '1';
const DATA = process.env.CHRONORMAL_DATA;
const NO_DATA = DATA ? false : 'set CHRONORMAL_DATA to the folder of the real data to run this test';
const SIZE = { width: 256, height: 256 };
const FRAMES_PER_SECOND = 2;
const PICTURE = fileURLToPath(new URL('../../docs/pictures/shading.png', import.meta.url));

let folder;
const original = (name) => join(folder, `${name}.glb`);

// Bakes a file and returns the path of the result. Bakes a file with the same options only once.
const bakedBefore = new Map();
function bake(input, ...options) {
  const key = [input, ...options].join(' ');
  if (!bakedBefore.has(key)) {
    const output = join(folder, `${basename(input, extname(input))}.${bakedBefore.size}.glb`);
    // The exact normals of this test use area weights, so the bake uses area weights too, whatever weighting the author
    // chose.
    chronormal('bake', input, '-o', output, '--weighting', 'area', ...options);
    bakedBefore.set(key, output);
  }
  return bakedBefore.get(key);
}

function faultOf(results) {
  const wrong = results.find(({ mean, max, drift }) => !(mean < 0.01 && max < 0.05 && drift < 1e-6));
  return wrong ? JSON.stringify(wrong) : '';
}

function summary(results) {
  const worst = Math.max(...results.map(({ max }) => max)).toExponential(1);
  const sum = (key) => results.reduce((total, result) => total + result[key], 0);
  return `worst ${worst} degrees of ${sum('pairs')} pairs, ${sum('excluded')} without a direction`;
}

async function assertExact(input, output) {
  const results = compareFiles(await read(input), await read(output));
  assert.equal(faultOf(results), '');
  return results;
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'chronormal_viewers_'));
  for (const [name, write] of Object.entries(fixtures)) await write(original(name));
});
after(() => rmSync(folder, { recursive: true, force: true }));

describe('a baked file', () => {
  for (const name of Object.keys(fixtures)) {
    test(`of ${name} is valid, and exact at 101 times`, async () => {
      const output = bake(original(name), '--encode', 'exact');
      assert.deepEqual(await newComplaints(output, original(name)), []);
      await assertExact(original(name), output);
    });
    test(`of ${name} with dense zeros is valid, and exact`, async () => {
      const output = bake(original(name), '--encode', 'exact', '--dense-zeros');
      assert.deepEqual(await newComplaints(output, original(name)), []);
      await assertExact(original(name), output);
    });
    test(`of ${name} with endpoint deltas is valid`, async () => {
      const output = bake(original(name), '--encode', 'endpoint');
      assert.deepEqual(await newComplaints(output, original(name)), []);
    });
  }

  test('holds what the formula says', async () => {
    for (const name of ['twist', 'wave', 'two_primitives', 'authored']) {
      const byFormula = join(folder, `${name}.formula.glb`);
      await bakeByFormula(original(name), byFormula);
      await assertExact(original(name), byFormula);
      const [expected, actual] = [await read(byFormula), await read(bake(original(name), '--encode', 'exact'))];
      expected.meshes[0].primitives.forEach(({ targets }, p) => {
        targets.forEach(({ normals }, k) => {
          const primitive = actual.meshes[0].primitives[p];
          const stored = primitive.targets[k].normals;
          for (const v of primitive.indices)
            for (let i = 3 * v; i < 3 * v + 3; ++i) assert.ok(Math.abs(normals[i] - stored[i]) < 1e-5, `${name} ${i}`);
        });
      });
    }
  });

  test('of a sequence is valid, and exact at 101 times', async () => {
    const frames = sequenceFrames();
    const paths = frames.map((text, k) => {
      const path = join(folder, `frame_${k}.obj`);
      writeFileSync(path, text);
      return path;
    });
    await assertSequence(paths, join(folder, 'sequence.glb'));
  });
});

async function assertSequence(paths, output) {
  chronormal('bake', ...paths, '-o', output, '--fps', String(FRAMES_PER_SECOND));
  assert.deepEqual(await complaints(output), []);
  const sequence = describeSequence(paths.map((path) => readFileSync(path, 'utf8')), FRAMES_PER_SECOND);
  const results = compareFiles(sequence, inOrderOf(sequence, await read(output)));
  assert.equal(faultOf(results), '');
  return results;
}

describe('a fault is found where', () => {
  // Each function makes one fault in the description of the file twist.baked.
  const faults = {
    'the extra target has no weight': ({ track: { values } }) => values.forEach((_, i) => i % 2 && (values[i] = 0)),
    'the tangents of a key are swapped': ({ track }) => {
      const key = track.values.subarray(6, 12);
      key.set([...key.subarray(4, 6), ...key.subarray(2, 4), ...key.subarray(0, 2)]);
    },
    'a delta is too long by a hundredth along one axis': ({ targets }) =>
      targets[0].normals.forEach((number, i, all) => i % 3 === 0 && (all[i] = 1.01 * number)),
    'a vertex has moved': ({ targets }) => (targets[1].positions[7] += 1e-3),
  };
  for (const [what, spoil] of Object.entries(faults)) {
    test(what, async () => {
      const source = await read(original('twist'));
      const spoiled = await read(bake(original('twist'), '--encode', 'exact'));
      spoil({ track: spoiled.animations[0].tracks[0], targets: spoiled.meshes[0].primitives[0].targets });
      assert.notEqual(faultOf(compareFiles(source, spoiled)), '');
    });
  }
  for (const name of Object.keys(fixtures)) {
    test(`${name} was not baked`, async () => {
      const source = await read(original(name));
      assert.notEqual(faultOf(compareFiles(source, source)), '');
    });
  }
});

describe('glTF Transform keeps normals exact', () => {
  const changes = { copy: [], dedup: [dedup()], prune: [prune()] };
  for (const [change, transforms] of Object.entries(changes)) {
    test(`through ${change}`, async () => {
      for (const name of ['twist', 'keyframes', 'two_primitives', 'one_flat_primitive', 'instances']) {
        const output = join(folder, `${name}.${change}.glb`);
        const document = await newIO().read(bake(original(name), '--encode', 'exact'));
        await document.setLogger(errorsOnly).transform(...transforms);
        await newIO().write(output, document);
        await assertExact(original(name), output);
      }
    });
  }
});

// Compares pictures of a file, before and after the bake, with exact normals at some times. Before the bake, errors
// must exceed `wrong` degrees at 7 or more of these times. After the bake, errors must be below 1 degree at all times.
async function assertDrawn(page, viewer, input, { wrong = 5, count = 15 } = {}) {
  const output = bake(input, '--encode', 'exact');
  const times = timesOf((await read(input)).animations[0], count);
  const moments = await stillMoments(input, 0, times);
  const unbaked = Buffer.from(await newIO().writeBinary(await newIO().read(input)));
  const files = [unbaked, readFileSync(output)].map((bytes) => bytes.toString('base64'));
  const rows = await page.evaluate((...all) => window.compareInViewer(...all), viewer, files, 0, moments, SIZE);
  const shown = JSON.stringify(rows.map((row) => row.map(({ pixels, p99 }) => [pixels, p99])));
  assert.ok(rows.every(([, after]) => after.pixels > 2000 && after.p99 < 1), shown);
  assert.ok(rows.filter(([before]) => before.p99 > wrong).length >= 7, shown);
}

// The weights that a program sets for the two targets of a file.
const WEIGHTS = [0.8, 0.6];

// Tests a mesh of several primitives that no animation moves. A program sets the weights of the targets, and then the
// weights of the correction targets by the formulas in the file (examples/drive.mjs). Without the second step, the
// normals must be wrong.
async function assertDriven(page, viewer, parts) {
  const [still, moved] = ['still', 'moved'].map((name) => join(folder, `${name}.${parts}.${viewer}.glb`));
  await writeStill(still, { parts });
  await writeStill(moved, { parts, weights: WEIGHTS });
  await assertDrivenLike(page, viewer, still, moved, WEIGHTS);
}

// Tests a given file like assertDriven(). A program sets `weights` of the targets of `still`, which no animation moves.
// `moved` is the same file with its mesh at rest at these weights.
async function assertDrivenLike(page, viewer, still, moved, weights) {
  const [moment] = await stillMoments(moved, 0, [0]);
  const base64 = readFileSync(bake(still, '--encode', 'exact')).toString('base64');
  const compare = (...all) => window.compareDriven(...all);
  const [before, attached, detached, after] = await page.evaluate(compare, viewer, base64, weights, moment, SIZE);
  assert.ok(before.p99 > 5, JSON.stringify(before));
  assert.ok(attached.pixels > 2000 && attached.p99 < 1, JSON.stringify(attached));
  assert.deepEqual(detached, before);
  if (viewer !== 'playcanvas') assert.deepEqual(after, attached); // drive.mjs supports the other two viewers
}

// Tests the head of Blender's monkey, which has two overlapping shape keys, without its animation. The weights are
// drawn from a fixed seed.
async function assertSuzanneDriven(page, viewer) {
  const random = randomNumbers(21), weights = [random(), random()];
  const [still, moved] = ['still', 'moved'].map((name) => join(folder, `suzanne.${name}.${viewer}.glb`));
  const document = await newIO().read(join(DATA, 'rigs/blender_suzanne_two_keys.glb'));
  document.getRoot().listAnimations().forEach((animation) => animation.dispose());
  await newIO().write(still, document);
  document.getRoot().listMeshes().forEach((mesh) => mesh.setWeights(weights));
  document.getRoot().listNodes().forEach((node) => node.setWeights([]));
  await newIO().write(moved, document);
  await assertDrivenLike(page, viewer, still, moved, weights);
}

// Tests the drawn normals while several independent clips are blended, which together set the weights of the author's
// targets. Until the package drives the correction targets, the normals must be wrong.
async function assertBlended(page, viewer) {
  const [still, moved] = ['still', 'moved'].map((name) => join(folder, `${name}.blended.${viewer}.glb`));
  await writeStill(still, { parts: 2 });
  await writeStill(moved, { parts: 2, weights: WEIGHTS });
  const [moment] = await stillMoments(moved, 0, [0]);
  const base64 = readFileSync(bake(still, '--encode', 'exact')).toString('base64');
  const compare = (...all) => window.compareBlended(...all);
  const [before, attached] = await page.evaluate(compare, viewer, base64, WEIGHTS, moment, SIZE);
  assert.ok(before.p99 > 5, JSON.stringify(before));
  assert.ok(attached.pixels > 2000 && attached.p99 < 1, JSON.stringify(attached));
}

// Draws a vase at one moment with wrong normals beside true normals. Compares the drawing with the picture in docs/.
async function assertPicture(page) {
  const TIME = 0.4;
  const [bare, stored] = ['bare', 'stored'].map((name) => join(folder, `vase.${name}.glb`));
  await writeVase(bare, { targetNormals: false });
  await writeVase(stored, { targetNormals: true });
  const panels = [
    ['no target normals', bare],
    ['ordinary target normals', stored],
    ['baked: exact', bake(stored, '--encode', 'exact')],
  ];
  const source = await read(stored);
  const items = [];
  const errors = [];
  for (const [title, path] of panels) {
    const { mean, max } = compareAnimation(source, await read(path), 0, [TIME]);
    errors.push(mean);
    const figures = `normals wrong by ${mean.toFixed(0)}\u00b0 on average, ${max.toFixed(0)}\u00b0 at worst`;
    const right = 'normals right to 0.01\u00b0';
    items.push({ base64: readFileSync(path).toString('base64'), caption: [title, max < 0.01 ? right : figures] });
  }
  assert.ok(errors[0] > 20 && errors[1] > 5 && errors[2] < 0.01, String(errors));
  const [{ view }] = await stillMoments(stored, 0, [TIME]);
  const closer = view.eye.map((c, i) => view.at[i] + 0.97 * (c - view.at[i]));
  const lower = { ...view, eye: closer, at: [view.at[0], view.at[1] - 0.15, view.at[2]], near: 0.1 };
  const draw = (...all) => window.drawPicture(...all);
  const url = await page.evaluate(draw, 'three', items, 0, TIME, lower, { width: 1200, height: 480 });
  const png = url.split(',')[1];
  if (process.env.CHRONORMAL_UPDATE_DOCS === '1') writeFileSync(PICTURE, Buffer.from(png, 'base64'));
  const differ = (...all) => window.differenceOfPictures(...all);
  const difference = await page.evaluate(differ, png, readFileSync(PICTURE).toString('base64'));
  assert.ok(difference < 2, `docs/pictures/shading.png is another (${difference} of 255): CHRONORMAL_UPDATE_DOCS=1`);
}

describe('Chromium', () => {
  let browser;
  before(async () => (browser = await openPage()));
  after(async () => {
    await browser?.close();
    assert.deepEqual(browser?.faults, []);
  });

  const drawn = FULL
    ? Object.keys(fixtures)
    : ['twist', 'spline', 'two_primitives', 'one_flat_primitive', 'instances', 'keyframes', 'pair'];
  for (const viewer of ['three', 'babylon']) {
    for (const name of drawn) {
      test(`shows right normals of ${name} in ${viewer}`, async () =>
        assertDrawn(browser.page, viewer, original(name)));
    }
    // The sphere keeps the usual limit of assertDrawn(). The cube is at rest most of the time, and its largest error is
    // 4.02 degrees. In the stress test, a few vertices have errors of 2.69 degrees.
    for (const [name, how] of [
      ['AnimatedMorphSphere', {}],
      ['AnimatedMorphCube', { wrong: 2, count: 41 }],
      ['MorphStressTest', { wrong: 0.5 }],
    ]) {
      test(`shows right normals of ${name} in ${viewer}`, { skip: NO_DATA }, async () => {
        const input = join(DATA, 'gltf', name, 'glTF', `${name}.gltf`);
        await assertDrawn(browser.page, viewer, input, how);
      });
    }
    test(`shows right normals of the face of RobotExpressive in ${viewer}`, { skip: NO_DATA }, async () => {
      const face = join(folder, 'robot_face.glb');
      await writeMovingFace(join(DATA, 'gltf', 'RobotExpressive', 'RobotExpressive.glb'), face);
      await assertDrawn(browser.page, viewer, face);
    });
  }
  for (const viewer of ['three', 'babylon', 'playcanvas'])
    for (const parts of [1, 2])
      test(`shows right normals in ${viewer} of ${parts} primitives whose weights a program sets`, async () =>
        assertDriven(browser.page, viewer, parts));
  for (const viewer of ['three', 'babylon', 'playcanvas'])
    test(`shows right normals in ${viewer} of Suzanne, whose weights a program sets`, { skip: NO_DATA }, async () =>
      assertSuzanneDriven(browser.page, viewer));
  for (const viewer of ['three', 'babylon'])
    test(`shows right normals in ${viewer} of clips that are blended`, async () => assertBlended(browser.page, viewer));
  test('draws the wrong beside the right as docs/pictures/shading.png has it', () => assertPicture(browser.page));
});

describe("other people's files", { skip: NO_DATA }, () => {
  const files = DATA
    ? readdirSync(join(DATA, 'gltf'), { recursive: true })
        .filter((path) => ['.gltf', '.glb'].includes(extname(path)))
        .map((path) => join(DATA, 'gltf', path))
        .sort()
    : [];
  for (const input of files) {
    test(`${basename(input)} is valid, and exact at 101 times`, async (context) => {
      if (!(await read(input)).meshes.some(moves)) {
        assert.deepEqual(await newComplaints(bake(input), input), []);
        return;
      }
      const output = bake(input, '--encode', 'exact');
      assert.deepEqual(await newComplaints(output, input), []);
      context.diagnostic(summary(await assertExact(input, output)));
    });
  }

  test('the keyframes of a dancer are valid, and exact at 101 times', async (context) => {
    const dance = join(DATA, 'sequences', 'rumba_13');
    const number = (name) => Number(name.match(/\d+/)[0]);
    const paths = readdirSync(dance).filter((name) => extname(name) === '.obj');
    paths.sort((a, b) => number(a) - number(b));
    const results = await assertSequence(paths.map((name) => join(dance, name)), join(folder, 'dance.glb'));
    context.diagnostic(summary(results));
  });
});
