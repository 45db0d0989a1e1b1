// Tests how real viewers compute a normal from stored numbers, and a weight from a track. The test evaluates the rules
// (formulas) of the viewers in double, and compares the results with pictures. docs/viewers.md states the results.
// ctest runs this file as `in_viewers`.
//
//   CHRONORMAL_FULL=1  tests all viewers and rules, and not only the normals of Filament and PlayCanvas
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { openPage } from './browser.mjs';
import { angle, length } from './exact.mjs';
import {
  BOARD, BOARD_PIXELS, BOARD_VIEW, MOVER_VIEW, SIZE, weightOfMiddle, writeBoard, writeMover,
} from './patches.mjs';
import { randomDirection, randomNumbers } from './random.mjs';
import { weightsAt } from './reader.mjs';

const FULL = process.env.CHRONORMAL_FULL === '1';
const SEED = 1853;

const plus = (a, b, s = 1) => a.map((c, i) => c + s * b[i]);
const minus = (a, b) => plus(a, b, -1);
const scaled = (a, s) => a.map((c) => s * c);
const unit = (a) => scaled(a, 1 / length(a));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// The rules by which viewers compute a normal from the stored normal N and the deltas D_k. The result does not have
// length 1.
const rules = {
  // glTF specifies N + sum of w_k D_k.
  sum: ({ normal, deltas }, w) => deltas.reduce((n, delta, k) => plus(n, delta, w[k]), normal),
  // Some viewers render N + sum of w_k (u_k - N). Such viewers store, for each target, the direction u_k of N + D_k.
  unit: ({ normal, deltas }, w) =>
    deltas.reduce((n, delta, k) => plus(n, minus(unit(plus(normal, delta)), normal), w[k]), normal),
};

// The rule by which each viewer computes normals, and the largest permitted error of the rule in degrees. PlayCanvas
// has larger errors because it stores deltas and their sum as 16-bit floats, and Filament because it stores directions
// as quaternions of 16-bit integers.
const viewers = {
  three: { rule: 'sum', degrees: 0.001, splines: true },
  babylon: { rule: 'sum', degrees: 0.001, splines: true },
  playcanvas: { rule: 'sum', degrees: 0.15, splines: false },
  filament: { rule: 'unit', degrees: 0.02, splines: false },
};

const anyWeights = (random) => [0, 1, 2].map(() => 3.5 * random() - 1.5);
const targetsOfLength = (lengthOf) => (normal, random) =>
  [0, 1, 2].map(() => minus(scaled(randomDirection(random, 0.35), lengthOf(random)), normal));

// The boards of squares. For each board, `deltas` computes the deltas of a square from its normal, and `weights` gives
// the weights at a key of the track. If `free` is given, N + D_k does not have length 1. Filament then treats a frame
// that is not orthonormal as orthonormal, so the error of Filament is at least `free` degrees.
const boards = {
  'targets whose normals are unit': { deltas: targetsOfLength(() => 1), weights: anyWeights },
  'targets whose normals are a hundredth too long': {
    deltas: targetsOfLength(() => 1.01),
    weights: anyWeights,
    free: 2,
  },
  'targets whose normals have any length': {
    deltas: targetsOfLength((random) => 0.3 + 1.5 * random()),
    weights: anyWeights,
    free: 90,
  },
  // The first target has a unit normal. The second and the third target have the weights s and -s, and the unit normals
  // h + D/2 and h - D/2, where h is perpendicular to D. Together, the second and the third target add s D to the
  // normal, for any vector D of length up to 1.95.
  'a pair of targets for any delta': {
    deltas: (normal, random) => {
      const any = scaled(randomDirection(random), 1.95 * random());
      const across = unit(plus(normal, any, -dot(normal, any) / dot(any, any)));
      const middle = scaled(across, Math.sqrt(1 - dot(any, any) / 4));
      return [randomDirection(random, 0.35), plus(middle, any, 0.5), plus(middle, any, -0.5)].map((n) => minus(n, normal));
    },
    weights: (random) => {
      const [w, s] = [0, 1].map(() => 3.5 * random() - 1.5);
      return [w, s, -s];
    },
  },
};

const TIMES = [0.25, 0.8, 1.5, 2.3, 2.9];

// Returns {rows, weights, patches}. `rows` has the weights at the four keys of the track, and `weights` has the weights
// at TIMES. `patches` has only squares whose normal is longer than 0.4 by every rule at each of the TIMES, since
// rounding turns a shorter normal by a larger angle.
function boardOf({ deltas, weights: weightsOf }) {
  const random = randomNumbers(SEED);
  const rows = Array.from({ length: 4 }, () => weightsOf(random));
  const track = { interpolation: 'LINEAR', times: rows.map((_, k) => k), values: rows.flat() };
  const weights = TIMES.map((time) => weightsAt(track, time));
  const patches = [];
  while (patches.length < BOARD * BOARD) {
    const normal = randomDirection(random, 0.35);
    const patch = { normal, deltas: deltas(normal, random) };
    if (Object.values(rules).every((rule) => weights.every((w) => length(rule(patch, w)) > 0.4))) patches.push(patch);
  }
  return { rows, weights, patches };
}

// Returns the weight that Filament computes from a spline. Filament multiplies the tangents by the elapsed share of the
// interval between two keys, instead of by the length of the interval.
function splineInFilament({ times, values }, time) {
  let k = 0;
  while (k + 2 < times.length && times[k + 1] <= time) ++k;
  const t = (time - times[k]) / (times[k + 1] - times[k]);
  const [p0, m0, m1, p1] = values.slice(3 * k + 1, 3 * k + 5);
  const rising = t * t * (3 - 2 * t);
  return (1 - rising) * p0 + rising * p1 + t * (t * (1 - t) ** 2 * m0 + t * t * (t - 1) * m1);
}

describe('a real viewer', () => {
  let browser, folder;
  const draw = (page, what, viewer, path, ...all) =>
    page.evaluate((name, values) => window[name](...values), what, [viewer, readFileSync(path).toString('base64'), ...all]);
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'chronormal_rules_'));
    browser = await openPage();
  });
  after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
    assert.deepEqual(browser?.faults, []);
  });

  // Returns, for each rule, the largest angle between the normals by this rule and the normals of the viewer, over all
  // squares and times.
  async function worstByRule(viewer, { rows, weights, patches }) {
    const path = join(folder, 'board.glb');
    await writeBoard(path, patches, rows);
    const shown = await draw(browser.page, 'normalsInViewer', viewer, path, TIMES, BOARD_VIEW, SIZE, BOARD_PIXELS);
    const worst = (rule) =>
      Math.max(...shown.flatMap((normals, t) => normals.map((n, p) => angle(n, rule(patches[p], weights[t])))));
    return Object.fromEntries(Object.entries(rules).map(([name, rule]) => [name, worst(rule)]));
  }

  for (const [viewer, { rule, degrees }] of Object.entries(viewers)) {
    if (!FULL && (viewer === 'three' || viewer === 'babylon')) continue;
    for (const [what, board] of Object.entries(boards)) {
      const lost = board.free && rule === 'unit';
      test(`${lost ? 'no rule' : `the rule ${rule}`} holds for ${what}: ${viewer}`, async (context) => {
        const off = await worstByRule(viewer, boardOf(board));
        context.diagnostic(`seed ${SEED}, worst degrees by rule: ${JSON.stringify(off)}`);
        if (lost) assert.ok(off.sum > board.free && off.unit > board.free, JSON.stringify(off));
        else assert.ok(off[rule] < degrees, JSON.stringify(off));
      });
    }
  }
  if (!FULL) return;

  // Viewers differ if some targets lack normals. Three.js replaces a missing normal delta by the base normal.
  // Babylon.js renders only the base normal if the first target has no normals. PlayCanvas uses only targets with
  // normals.
  for (const viewer of Object.keys(viewers)) {
    const right = viewer === 'filament';
    test(`shows ${right ? 'right' : 'wrong'} normals where a target has none and the next has: ${viewer}`, async () => {
      const [normal, to] = [[0, 0, 1], [0.6, 0, 0.8]];
      const patches = Array.from({ length: BOARD * BOARD }, () => ({ normal, deltas: [null, minus(to, normal)] }));
      const path = join(folder, 'mixed.glb');
      await writeBoard(path, patches, [[0.5, 1], [0.5, 1]]);
      const [[shown]] = await draw(browser.page, 'normalsInViewer', viewer, path, [0.5], BOARD_VIEW, SIZE, BOARD_PIXELS);
      const off = angle(shown, to);
      assert.ok(right ? off < 0.02 : off > 10, String(off));
    });
  }

  // Returns the weights that a viewer shows at some times, measured by how far a target has moved a square. One pixel
  // stands for a weight of 0.02.
  async function weightsInViewer(viewer, track, times, page) {
    const path = join(folder, 'mover.glb');
    await writeMover(path, track);
    const middles = await draw(page, 'middlesInViewer', viewer, path, times, MOVER_VIEW, SIZE);
    return middles.map(weightOfMiddle);
  }

  const farthest = (weights, expected) => Math.max(...weights.map((w, i) => Math.abs(w - expected[i])));

  const tracks = {
    LINEAR: { interpolation: 'LINEAR', times: [0, 0.5, 2.5], values: [0.1, 0.9, 0.4] },
    STEP: { interpolation: 'STEP', times: [0, 0.5, 2.5], values: [0.1, 0.9, 0.4] },
    CUBICSPLINE: { interpolation: 'CUBICSPLINE', times: [0, 0.5, 2.5], values: [0, 0.1, 1.2, 0.5, 0.9, -0.8, 0.3, 0.4, 0] },
  };
  const MOMENTS = [0.1, 0.25, 0.4, 0.8, 1.4, 1.9, 2.3];
  const NEAR = 0.015;
  for (const [viewer, { splines }] of Object.entries(viewers)) {
    for (const [name, track] of Object.entries(tracks)) {
      const right = splines || name !== 'CUBICSPLINE';
      test(`moves vertices ${right ? 'rightly' : 'wrongly'} by a track that is ${name}: ${viewer}`, async (context) => {
        const shown = await weightsInViewer(viewer, track, MOMENTS, browser.page);
        const off = farthest(shown, MOMENTS.map((time) => weightsAt(track, time)[0]));
        context.diagnostic(`off by ${off}: ${shown.map((w) => w.toFixed(2))}`);
        assert.ok(right ? off < NEAR : off > 0.1, String(off));
      });
    }
    if (!splines)
      test(`plays a spline wrongly in the way that is known: ${viewer}`, async () => {
        const shown = await weightsInViewer(viewer, tracks.CUBICSPLINE, MOMENTS, browser.page);
        if (viewer === 'filament') {
          assert.ok(farthest(shown, MOMENTS.map((time) => splineInFilament(tracks.CUBICSPLINE, time))) < NEAR);
        } else {
          // PlayCanvas makes separate tracks of the tangents of each key of a spline, and then looks for tangents in
          // each of these tracks. After the first key, PlayCanvas finds no tangents, so the target no longer moves.
          const late = shown.filter((_, i) => MOMENTS[i] > tracks.CUBICSPLINE.times[1]);
          assert.ok(farthest(late, late.map(() => 0)) < NEAR);
        }
      });

    // PlayCanvas finds a target by its name, if the target has one. If several targets have the same name, PlayCanvas
    // finds only the last of them.
    const mixes = viewer === 'playcanvas';
    test(`${mixes ? 'mixes up' : 'tells apart'} targets of the same name: ${viewer}`, async () => {
      const track = { interpolation: 'STEP', times: [0, 1], values: [0.75, 0.25, 0.75, 0.25], targets: 2, moving: 0 };
      const shown = async (names) => (await weightsInViewer(viewer, { ...track, names }, [0.5], browser.page))[0];
      assert.ok(Math.abs((await shown(['one', 'two'])) - 0.75) < NEAR);
      assert.equal(Math.abs((await shown(['one', 'one'])) - 0.75) > NEAR, mixes);
    });

    for (const targets of [256, 257, 300]) {
      const shows = targets <= 256 || viewer !== 'filament';
      test(`${shows ? 'shows' : 'aborts at'} ${targets} targets: ${viewer}`, async () => {
        const fades = [0, 1].map((w) => Array.from({ length: targets }, (_, k) => (k + 1 < targets ? 0.1 * w : w)));
        const track = { interpolation: 'LINEAR', times: [0, 1], values: fades.flat(), targets };
        const weights = (page) => weightsInViewer(viewer, track, [0.25, 0.75], page);
        if (shows) {
          assert.ok(farthest(await weights(browser.page), [0.25, 0.75]) < NEAR);
          return;
        }
        const lost = await openPage();
        await assert.rejects(weights(lost.page), /Aborted|out of bounds/).finally(() => lost.close());
      });
    }
  }
});
