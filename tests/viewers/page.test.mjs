// Tests the page that has the program inside. For dropped files, the page must show the same numbers as the program,
// and bake the same bytes. Unreadable files must get a helpful message, and the page must make no requests.
//
//   CHRONORMAL_PROGRAM        the program
//   CHRONORMAL_PAGE           the page: build/web/chronormal.html, by ./run page or ./test --full npm
//   CHRONORMAL_CHROMIUM       the browser, if it is not in its usual place
//   CHRONORMAL_DATA           a folder of moving files from other projects, if set
//   CHRONORMAL_FULL=1         tests all files in the folder CHRONORMAL_DATA
import assert from 'node:assert/strict';
import { closeSync, existsSync, ftruncateSync, mkdtempSync, openSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { after, afterEach, before, test } from 'node:test';
import { Accessor, Document } from '@gltf-transform/core';
import { ExactNormals, exactPositions, length } from './exact.mjs';
import { assertShown, figureByProgram } from './figures.mjs';
import { writeStill } from './fixtures.mjs';
import { chronormal } from './program.mjs';
import { newIO, read } from './reader.mjs';
import { clickWorst, openPages } from './web_page.mjs';

const FULL = process.env.CHRONORMAL_FULL === '1', DATA = process.env.CHRONORMAL_DATA;
const NEAR = 1e-3; // largest error of the page's numbers, in degrees
const SHOWN = 5e-4; // in degrees; the page does not list places with smaller errors
const WAIT = { timeout: 600_000 };

let folder, pages, page;
const path = (name) => join(folder, name);

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'chronormal-page-'));
  chronormal('convert', '--sample', 'bumps', '-o', path('bumps.glb'));
  pages = await openPages();
  ({ page } = pages);
  const client = await page.createCDPSession();
  await client.send('Browser.setDownloadBehavior', { behavior: 'allow', downloadPath: folder });
  await pages.show(process.env.CHRONORMAL_PAGE);
});
after(async () => {
  await pages.close();
  rmSync(folder, { recursive: true, force: true });
});
afterEach(() => assert.deepEqual(pages.faults.splice(0), []));

const audited = (file) => JSON.parse(chronormal('audit', file, '--json', '-q'));
const said = () => page.$eval('.message', (box) => (box.hidden ? '' : box.innerText));

// Drops files on the page, and waits until the page shows a report or a message.
async function drop(...files) {
  await page.evaluate(() => {
    delete document.getElementById('report').dataset.ready;
    document.querySelector('.message').hidden = true;
  });
  await (await page.$('input[type=file]')).uploadFile(...files);
  await page.waitForSelector('#report[data-ready], .message:not([hidden])', WAIT);
}
const press = (selector) => page.evaluate((button) => document.querySelector(button).click(), selector);

async function downloaded(name) {
  for (const file = path(name); ; await new Promise((resolve) => setTimeout(resolve, 50))) {
    if (existsSync(file) && !existsSync(`${file}.crdownload`)) return readFileSync(file);
  }
}

// Returns the bytes of the file that the program bakes, or the message of the program if it writes no file. The program
// also writes a file whose errors exceed the tolerance.
function bakedByProgram(file) {
  const target = path('expected.glb');
  rmSync(target, { force: true });
  try {
    chronormal('bake', file, '-o', target, '-q');
  } catch (error) {
    if (!existsSync(target)) return { words: error.message };
  }
  return { bytes: readFileSync(target) };
}

async function bakeAndDownload(file) {
  const name = basename(file).replace(/\.glb$/, '.right.glb'), { bytes, words } = bakedByProgram(file);
  await press('button.bake');
  // A bake may take longer than a single call to the browser is allowed to take, so the test asks again and again
  // whether the page is still busy.
  while (await page.$('.busy:not([hidden])')) await new Promise((resolve) => setTimeout(resolve, 200));
  if (words) {
    await page.waitForSelector('.busy[hidden]', WAIT);
    return assert.ok(words.includes((await said()).split('\n').at(-1)), `the page says "${await said()}", and the program ${words}`);
  }
  await page.waitForFunction(() => /baked$/.test(document.getElementById('report').dataset.ready), WAIT);
  rmSync(path(name), { force: true });
  await press('.top .primary');
  assert.ok((await downloaded(name)).equals(bytes), 'the bytes of the program');
  return undefined;
}

test('a dropped file shows the number of the audit, a plan, and is baked to the bytes of the program', async () => {
  await drop(path('bumps.glb'));
  assert.ok(Math.abs((await clickWorst(page)).degrees - audited(path('bumps.glb')).worst_degrees) < NEAR);
  await press('button.plan');
  await page.waitForSelector('tr.chosen', WAIT);
  await bakeAndDownload(path('bumps.glb'));
});

// Sets the sliders of the weights as a person does.
const setSliders = (weights) => page.evaluate((values) => {
  const rows = document.querySelectorAll('.weights input');
  values.forEach((value, k) => {
    rows[k].value = value;
    rows[k].dispatchEvent(new Event('input'));
  });
}, weights);

// Draws the left or the right half of the picture with normals as colours, from the given camera or, if no camera is
// given, from the camera of the page. Returns {camera, pixels}.
const half = (side, camera) => page.evaluate((right, given) => {
  const { view, setMode } = globalThis.chronormal, { canvas } = view;
  setMode('normals');
  if (given) {
    for (const part of ['position', 'quaternion']) view.camera[part].fromArray(given[part]);
    Object.assign(view.camera, { near: given.near, far: given.far });
  }
  view.draw();
  const sheet = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d');
  sheet.drawImage(canvas, 0, 0);
  const middle = canvas.width / 2, { position, quaternion, near, far } = view.camera;
  return {
    camera: { position: position.toArray(), quaternion: quaternion.toArray(), near, far },
    pixels: [...sheet.getImageData(right ? middle : 0, 0, middle, canvas.height).data],
  };
}, side === 'right', camera);

// Writes a still file: the mesh of another file at some weights, with the exact normals at these weights and a target
// that moves nothing.
async function writeFrozen(target, source, weights) {
  const io = newIO(), document = await io.read(source), root = document.getRoot();
  const described = (await read(source)).meshes[0], truth = new ExactNormals(described).at(weights);
  const accessor = (numbers) => document.createAccessor().setType(Accessor.Type.VEC3).setArray(Float32Array.from(numbers)).setBuffer(root.listBuffers()[0]);
  root.listMeshes()[0].listPrimitives().forEach((primitive, p) => {
    const { directions } = truth[p], unit = directions.map((c, i) => c / length(directions.slice(i - (i % 3), i - (i % 3) + 3)));
    primitive.setAttribute('POSITION', accessor(exactPositions(described.primitives[p], weights))).setAttribute('NORMAL', accessor(unit));
  });
  writeFileSync(target, await io.writeBinary(document));
}

test('what is shown as right at weights set by hand has the pixels of a still mesh in a file of its own', async () => {
  const weights = [0.7, 0.4];
  await writeStill(path('still.glb'), { parts: 1 });
  await writeFrozen(path('frozen.glb'), path('still.glb'), weights);
  await drop(path('still.glb'));
  await setSliders(weights);
  const right = await half('right');
  await drop(path('frozen.glb'));
  await setSliders([0, 0]);
  const still = await half('left', right.camera);
  const covered = still.pixels.filter((value, i) => i % 4 === 3 && value > 0).length;
  const different = still.pixels.filter((value, i) => Math.abs(value - right.pixels[i]) > 2).length;
  assert.ok(covered > 10_000, `${covered} pixels are drawn`);
  assert.ok(different < 1e-3 * covered, `${different} numbers differ in a picture of ${covered} pixels`);
});

test('a face that is clicked has the figures of the program, and they follow its corners by mouse, touch and keys', async () => {
  writeFileSync(path('k0.obj'), 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 4 0 0\nv 5 0 1\nv 4 1 0\nf 1 2 3\nf 4 5 6\n');
  writeFileSync(path('k1.obj'), 'v 0 0 0\nv 0 1 0\nv 0 0 1\nv 4 0 0\nv 5 2 1\nv 4 1 3\nf 1 2 3\nf 4 5 6\n');
  await drop(path('k0.obj'), path('k1.obj'));
  // Waits until the program has computed the figure for the path that the panel shows.
  const settled = async () => {
    await page.waitForSelector('.face[data-state=done]', WAIT);
    const way = await page.evaluate(() => globalThis.chronormal.faces.way());
    const schemes = await page.$$eval('.face tr[data-scheme]', (rows) => rows.map((row) => row.dataset.scheme));
    await assertShown(page, figureByProgram(way, schemes, 41));
    return way;
  };
  const typed = async (number) => {
    await page.evaluate(() => (document.querySelector('.face').open = true));
    const input = await page.$('.number-field input');
    await input.click({ count: 3 });
    await input.type(String(number));
    await page.keyboard.press('Enter');
    return settled();
  };
  const first = await typed(1);
  assert.deepEqual(first.from, [[4, 0, 0], [5, 0, 1], [4, 1, 0]]);
  assert.deepEqual((await typed(0)).to, [[0, 0, 0], [0, 1, 0], [0, 0, 1]]);

  const middleOf = async (i) => {
    const handle = (await page.$$('.handle'))[i];
    await handle.scrollIntoView();
    return handle.$eval('circle:nth-of-type(2)', (circle) => {
      const { x, y, width, height } = circle.getBoundingClientRect();
      return [x + width / 2, y + height / 2];
    });
  };
  const sums = () => page.$$eval('.face tr[data-scheme]', (rows) => rows.map((row) => row.dataset.sum).join());
  const before = await sums(), [x, y] = await middleOf(4);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 40, y + 25, { steps: 5 });
  await page.mouse.up();
  const dragged = await settled();
  assert.notDeepEqual(dragged.to[1], [0, 1, 0]);
  assert.deepEqual([dragged.from, dragged.to[0], dragged.to[2]], [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [0, 0, 0], [0, 0, 1]], 'one corner alone');
  assert.notEqual(await sums(), before, 'q follows');
  await page.$eval('.handle', (handle) => handle.focus());
  await page.keyboard.press('ArrowUp');
  assert.notDeepEqual((await settled()).from[0], [0, 0, 0]);
  await page.setViewport({ width: 390, height: 844 });
  const [tx, ty] = await middleOf(2), finger = await page.touchscreen.touchStart(tx, ty);
  await finger.move(tx - 15, ty + 10);
  await finger.move(tx - 30, ty + 20);
  await finger.end();
  assert.notDeepEqual((await settled()).from[2], [0, 1, 0]);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'nothing is wider than a phone');
  await page.setViewport({ width: 1280, height: 800 });

  // A click on the picture selects the face at that place.
  const spot = await page.evaluate(async () => {
    scrollTo(0, 0);
    // Waits some frames until the area of the picture has its final size.
    for (let i = 0; i < 3; ++i) await new Promise((resolve) => requestAnimationFrame(resolve));
    const { view, player } = globalThis.chronormal, box = view.canvas.getBoundingClientRect(), { positions } = player.surface;
    view.frame(true);
    view.draw();
    const centre = view.camera.position.clone().set(0, 0, 0);
    for (const v of [3, 4, 5]) for (const [c, axis] of ['x', 'y', 'z'].entries()) centre[axis] += positions[3 * v + c] / 3;
    const at = centre.project(view.camera);
    return [box.left + ((at.x + 1) / 4) * box.width, box.top + ((1 - at.y) / 2) * box.height];
  });
  await page.mouse.click(...spot);
  await page.waitForFunction(() => document.querySelector('.number-field input').value === '1', WAIT);
  await settled();
  rmSync(path('face-1.svg'), { force: true });
  await press('.face .save');
  const svg = String(await downloaded('face-1.svg'));
  for (const part of ['<svg xmlns=', 'data-path="exact"', 'data-path="quaternion:matrix"', 'data-line="linear"']) assert.ok(svg.includes(part), part);
});

test('what cannot be used gets a message that says what to do, and the page goes on', async () => {
  writeFileSync(path('face.png'), Buffer.from('89504e470d0a1a0a0000000d49484452', 'hex'));
  writeFileSync(path('cut.glb'), readFileSync(path('bumps.glb')).subarray(0, 5000));
  writeFileSync(path('odd.glb'), Buffer.concat([readFileSync(path('bumps.glb')).subarray(0, 40), Buffer.alloc(5000)]));
  const large = openSync(path('large.glb'), 'w');
  ftruncateSync(large, 300e6);
  closeSync(large);
  for (const [name, words] of [['face.png', /is a picture \(PNG\).*Export the model/s], ['cut.glb', /is cut off.*only 5,000 are there.*again/s],
                               ['large.glb', /has 300 MB.*up to 268 MB.*without its textures/s]]) {
    await drop(path(name));
    assert.match(await said(), words);
  }
  writeFileSync(path('odd.gltf'), '{"asset": {"version": "2.0"}, "meshes": [{"primitives": [{"attributes": {"POSITION": 7}}]}]}');
  await drop(path('odd.gltf'));
  assert.match(await said(), /cannot be used.*\/meshes\/0\/primitives\/0\/attributes\/POSITION/s, 'the words of the program, with the place');

  const document = new Document(), buffer = document.createBuffer();
  const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const primitive = document.createPrimitive().setAttribute('POSITION', accessor(Accessor.Type.VEC3, new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0])))
    .setIndices(accessor(Accessor.Type.SCALAR, new Uint16Array([0, 1, 2])));
  document.createScene().addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
  writeFileSync(path('rest.glb'), await newIO().writeBinary(document));
  await drop(path('rest.glb'));
  assert.match(await said(), /no shape keys \(morph targets\).*in Blender/s);

  await drop(path('face.png'), path('bumps.glb'));
  await page.waitForSelector('.message:not([hidden])', WAIT);
  assert.match(await said(), /is a picture/);
  assert.equal(await page.$eval('.top .file', (name) => name.textContent || document.querySelector('.file-choice').selectedOptions[0].textContent), 'bumps.glb');

  await drop(path('bumps.glb'));
  assert.equal(await said(), '');
});

test('a task can be cancelled, and the page goes on', async () => {
  await press('button.bake');
  await page.waitForSelector('.busy:not([hidden]) button', WAIT);
  await press('.busy button');
  await page.waitForSelector('.busy[hidden]', WAIT);
  assert.doesNotMatch(await page.$eval('#report', (report) => report.dataset.ready), /baked$/, 'the bake went on');
  await drop(path('bumps.glb'));
  assert.equal(await said(), '');
});

const files = DATA ? readdirSync(DATA, { recursive: true }).filter((name) => name.endsWith('.glb')).sort() : [];
for (const name of FULL ? files : []) {
  test(`${name}, dropped, shows the number of the audit, and is baked to the bytes of the program`, async () => {
    const file = join(DATA, name);
    let found;
    try {
      found = audited(file);
    } catch (error) {
      await drop(file);
      return assert.match(await said(), /\S/, `the page says why, as the program does: ${error.message}`);
    }
    const { worst_degrees: worst, judged } = found;
    await drop(file);
    if (judged === 0) return assert.match(await said(), /needs no correction/);
    if (worst >= SHOWN) assert.ok(Math.abs((await clickWorst(page)).degrees - worst) < NEAR, `${basename(name)}: ${worst}`);
    return bakeAndDownload(file);
  });
}
