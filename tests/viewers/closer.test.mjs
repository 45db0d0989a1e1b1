// Tests by comparing pixels that the output of `chronormal bake` is closer to the true normals than its input, in every
// viewer. ctest runs this file as `in_viewers`.
//
//   CHRONORMAL_PROGRAM  the program
//   CHRONORMAL_DATA     the folder of the real data, for a head by Blender and for MorphStressTest, if set
//   CHRONORMAL_FULL=1   tests every file in every viewer, and not only one file in PlayCanvas and Filament
//   CHRONORMAL_UPDATE_DOCS=1  with CHRONORMAL_DATA, writes docs/pictures/head.png
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, extname, join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { openPage } from './browser.mjs';
import { fixtures } from './fixtures.mjs';
import { timesWithin } from './judge.mjs';
import { chronormal } from './program.mjs';
import { newIO, read } from './reader.mjs';
import { stillMoments } from './still.mjs';

const FULL = process.env.CHRONORMAL_FULL === '1';
const DATA = process.env.CHRONORMAL_DATA;
const NO_DATA = DATA ? false : 'set CHRONORMAL_DATA to the folder of the real data to run this test';
const SIZE = { width: 256, height: 256 };
const MOMENTS = FULL ? 15 : 7;

const PICTURE = fileURLToPath(new URL('../../docs/pictures/head.png', import.meta.url));
const PICTURE_TIME = 1.25;
const VIEWERS = FULL ? ['three', 'babylon', 'playcanvas', 'filament'] : ['playcanvas', 'filament'];

// The largest difference between errors, in degrees, that is ignored. In PlayCanvas, rounding to 16-bit floats causes
// differences of this size.
const ROUNDING = 0.05;

describe('what is baked is closer to the truth', () => {
  let browser, folder;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'chronormal_closer_'));
    await fixtures.twist(join(folder, 'twist.glb'));
    browser = await openPage();
  });
  after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
    assert.deepEqual(browser?.faults, []);
  });

  // Returns a function that calls f only once for the same arguments, and then returns the same result.
  function once(f) {
    const known = new Map();
    return (...all) => {
      const key = all.join(' ');
      if (!known.has(key)) known.set(key, f(...all));
      return known.get(key);
    };
  }

  const bake = once((input, ...options) => {
    const name = [basename(input, extname(input)), 'baked', ...options].join('.');
    const output = join(folder, `${name}.glb`);
    // The still files with the true normals use area weights, so the bake uses area weights too, whatever weighting the
    // author chose.
    const how = options.includes('--encode') ? options : ['--encode', 'harmless', ...options];
    chronormal('bake', input, '-o', output, '--weighting', 'area', ...how);
    return output;
  });

  // Returns {files, moments} for an animation of a file. `files` has the file before and after the bake, and `moments`
  // the true normals at some times. In the full test, `files` also has the result of --encode exact, for the figures of
  // docs/viewers.md.
  const prepare = once(async (input, animation) => {
    const unbaked = Buffer.from(await newIO().writeBinary(await newIO().read(input)));
    const baked = [bake(input), ...(FULL ? [bake(input, '--encode', 'exact')] : [])];
    const files = [unbaked, ...baked.map((path) => readFileSync(path))].map((bytes) => bytes.toString('base64'));
    const times = timesWithin((await read(input)).animations[animation], MOMENTS);
    return { files, moments: await stillMoments(input, animation, times) };
  });

  async function assertCloser(context, viewer, input, animation = 0) {
    const { files, moments } = await prepare(input, animation);
    const compare = (...all) => window.compareInViewer(...all);
    const rows = await browser.page.evaluate(compare, viewer, files, animation, moments, SIZE);
    const [before, after, exact] = files.map((_, f) => ({
      mean: rows.reduce((sum, row) => sum + row[f].mean, 0) / rows.length,
      p99: rows.reduce((sum, row) => sum + row[f].p99, 0) / rows.length,
      max: Math.max(...rows.map((row) => row[f].max)),
    }));
    const figures = ({ mean, p99, max }) => `${mean.toFixed(3)} / ${p99.toFixed(2)} / ${max.toFixed(1)}`;
    const shown = `mean / 99 % / worst degrees: ${figures(before)} before, ${figures(after)} after${exact ? `, ${figures(exact)} by exact` : ''}`;
    context.diagnostic(shown);
    assert.ok(rows.every((row) => row[1].pixels > 2000), shown);
    assert.ok(after.mean < before.mean && after.p99 < before.p99 + ROUNDING, shown);
    assert.ok(rows.every(([{ mean }, then]) => then.mean < mean + ROUNDING), shown);
  }

  // Draws the picture of the head for the README, and compares it with the picture in docs/.
  async function assertPicture() {
    const input = join(DATA, 'rigs', 'blender_suzanne_two_keys.glb');
    const output = join(folder, 'head.glb');
    chronormal('bake', input, '-o', output);  // the command in the caption
    const items = [
      [['not baked', 'as Blender wrote it'], input],
      [['baked', 'chronormal bake face.glb'], output],
    ].map(([caption, path]) => ({ base64: readFileSync(path).toString('base64'), caption }));
    const [{ view }] = await stillMoments(input, 0, [PICTURE_TIME]);
    const draw = (...all) => window.drawPicture(...all);
    const size = { width: 1000, height: 440 };
    const url = await browser.page.evaluate(draw, 'three', items, 0, PICTURE_TIME, view, size);
    const png = url.split(',')[1];
    if (process.env.CHRONORMAL_UPDATE_DOCS === '1') writeFileSync(PICTURE, Buffer.from(png, 'base64'));
    const differ = (...all) => window.differenceOfPictures(...all);
    const difference = await browser.page.evaluate(differ, png, readFileSync(PICTURE).toString('base64'));
    assert.ok(difference < 2, `docs/pictures/head.png is another (${difference} of 255): CHRONORMAL_UPDATE_DOCS=1`);
  }
  if (FULL)
    test('three.js lights a head as docs/pictures/head.png has it', { skip: NO_DATA }, () => assertPicture());

  for (const viewer of VIEWERS) {
    test(`twist in ${viewer}`, (context) => assertCloser(context, viewer, join(folder, 'twist.glb')));
    if (!FULL) continue;
    test(`a head by Blender in ${viewer}`, { skip: NO_DATA }, (context) =>
      assertCloser(context, viewer, join(DATA, 'rigs', 'blender_suzanne_two_keys.glb')));
    for (const animation of [0, 1, 2])
      test(`animation ${animation} of MorphStressTest in ${viewer}`, { skip: NO_DATA }, (context) =>
        assertCloser(context, viewer, join(DATA, 'gltf', 'MorphStressTest', 'glTF', 'MorphStressTest.gltf'), animation));
  }
});
