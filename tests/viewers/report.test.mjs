// Tests the page of `chronormal report`. The page must show the same numbers as the program, and the true normals in
// its right half. The page must make no requests.
//
//   CHRONORMAL_PROGRAM        the program
//   CHRONORMAL_CHROMIUM       the browser, if it is not in its usual place
//   CHRONORMAL_DATA           a folder of moving files from other projects, if set
//   CHRONORMAL_FULL=1         tests all of these files
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { fromBase64, readContainer, unzipped } from '../../web/src/data.js';
import { faceOf, faceOfNumber, wayOf } from '../../web/src/faces.js';
import { makePlayer } from '../../web/src/player.js';
import { ExactNormals, exactPositions } from './exact.mjs';
import { writeAuthored } from './authored.mjs';
import { assertSameFigure, assertShown, figureByProgram } from './figures.mjs';
import { writeBump, writeStill } from './fixtures.mjs';
import { chronormal } from './program.mjs';
import { read } from './reader.mjs';
import { randomNumbers } from './random.mjs';
import { clickWorst, openPages, worstNow } from './web_page.mjs';

const FULL = process.env.CHRONORMAL_FULL === '1', DATA = process.env.CHRONORMAL_DATA;
const NEAR = 1e-3; // largest error of the page's numbers, in degrees
const SHOWN = 5e-4; // in degrees; the page does not list places with smaller errors
const SEED = 49;

let folder, template;
const path = (name) => join(folder, name);

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'chronormal-report-'));
  template = path('template.html');
  execFileSync(process.execPath, [fileURLToPath(new URL('../../web/build.mjs', import.meta.url)), 'report', template]);
  await writeStill(path('still.glb'), { parts: 2 });
  await writeAuthored(path('authored.glb'), SEED);
  chronormal('convert', '--sample', 'bumps', '-o', path('bumps.glb'));
});
after(() => rmSync(folder, { recursive: true, force: true }));

const audited = (...input) => JSON.parse(chronormal('audit', ...input, '--json', '-q'));
function dataOf(name, ...input) {
  chronormal('report', ...input, '--no-plan', '--force', '-q', '-o', path(`${name}.bin`));
  return readContainer(readFileSync(path(`${name}.bin`)));
}
function pageOf(name, ...input) {
  chronormal('report', ...input, '--no-plan', '--force', '-q', '-o', path(`${name}.html`), '--template', template);
  return path(`${name}.html`);
}

// Calls visit(motion, sample, degrees) for all samples that the page can show.
function walk(player, visit) {
  player.report.parts.forEach((part, p) => {
    player.choosePart(p);
    part.motions.forEach((motion, m) => {
      player.chooseMotion(m, 0);
      for (let i = 0; i < motion.at.length; ++i) {
        player.go(i);
        visit(motion, i, player.worst < 0 ? NaN : player.surface.degrees[player.worst]);
      }
    });
  });
}

const inputs = { still: () => [path('still.glb')], bumps: () => [path('bumps.glb')], angles: () => [path('bumps.glb'), '--weighting', 'angle'], authored: () => [path('authored.glb')], twist: () => ['--sample', 'twist'] };
for (const [name, input] of Object.entries(inputs)) {
  test(`the page computes the worst error of every sample as the audit does: ${name}`, () => {
    const report = dataOf(name, ...input()), player = makePlayer(report, () => {});
    let samples = 0;
    walk(player, (motion, i, degrees) => {
      ++samples;
      assert.ok(Math.abs(degrees - motion.worst[i]) < NEAR, `${motion.kind} ${motion.name}, sample ${i}: ${degrees}, not ${motion.worst[i]}`);
    });
    assert.ok(samples >= 21);
    assert.ok(Math.abs(report.worst[0].degrees - audited(...input()).worst_degrees) < NEAR);
  });
}

for (const [name, input] of Object.entries(inputs)) {
  test(`the figures of a report are those of the program for faces at its worst places: ${name}`, () => {
    const report = dataOf(name, ...input()), player = makePlayer(report, () => {});
    assert.ok(report.figures.length >= 1 && report.figures.length <= 8, `${report.figures.length} figures`);
    for (const figure of report.figures) {
      const vertex = player.visit(report.worst[figure.place]), face = faceOf(player.part, figure.triangle);
      assert.ok(face.corners.includes(vertex), 'the face is at the place');
      assert.deepEqual([face.number, face.triangle], [figure.face, figure.triangle]);
      assert.deepEqual(faceOfNumber(player.part, figure.face), face);
      const way = wayOf(player, face);
      for (const end of ['from', 'to']) {
        way[end].forEach((p, i) => p.forEach((x, c) => assert.ok(Math.abs(x - figure[end][i][c]) < 1e-6 * Math.max(1, Math.abs(x)), `${end} ${i}`)));
      }
      assertSameFigure(figure, figureByProgram(figure, figure.schemes.map(({ scheme }) => scheme), figure.t.length));
    }
  });
}

test('every scheme of the page has the numbers of compare', () => {
  const report = dataOf('twist', '--sample', 'twist'), player = makePlayer(report, () => {});
  const compared = JSON.parse(chronormal('compare', '--sample', 'twist', '--elements', 'vertices', '--json', '--no-times', '-q'));
  let found = 0;
  for (const { scheme, max_degrees: worst } of compared.schemes.filter((one) => player.schemes().includes(one.scheme))) {
    ++found;
    player.scheme = scheme;
    let most = 0;
    walk(player, (motion, i, degrees) => (most = Math.max(most, degrees)));
    assert.ok(Math.abs(most - worst) < NEAR, `${scheme}: ${most}, not ${worst}`);
  }
  assert.ok(found >= 6, `${found} schemes`);
});

for (const file of ['bumps.glb', 'authored.glb']) {
  test(`every viewer of the page has the number of the audit: ${file}`, () => {
    chronormal('report', path(file), '--no-plan', '--for', 'all,gltfpack,quantize,meshopt', '--force', '-q', '-o', path('viewers.bin'));
    const player = makePlayer(readContainer(readFileSync(path('viewers.bin'))), () => {});
    const { viewers } = JSON.parse(chronormal('audit', path(file), '--for', 'all,gltfpack,quantize,meshopt', '--json', '-q'));
    for (const { name, worst_degrees: worst } of viewers) {
      player.viewer = name;
      let most = 0;
      walk(player, (motion, i, degrees) => (most = Math.max(most, degrees)));
      assert.equal(player.viewer, name);
      assert.ok(Math.abs(most - worst) < NEAR, `${name}: ${most}, not ${worst}`);
    }
    assert.equal(viewers.length, 9);
  });
}

test('weights that are set by hand drive the extra targets of a baked file', () => {
  const player = makePlayer(dataOf('bumps', path('bumps.glb')), () => {});
  const setAll = (one) => [0, 1, 2].forEach((k) => one.setWeight(k, 0.4 + 0.2 * k));
  player.choosePart(0);
  setAll(player);
  const before = player.surface.degrees[player.worst];
  chronormal('bake', path('bumps.glb'), '--encode', 'exact', '--force', '-q', '-o', path('exact.glb'));
  const baked = makePlayer(dataOf('exact', path('exact.glb')), () => {});
  baked.choosePart(0);
  setAll(baked);
  assert.ok(baked.formulas.length > 0 && before > 1, `${baked.formulas.length} extra targets, ${before} degrees before`);
  assert.ok(baked.surface.degrees[baked.worst] < 0.01, `${baked.surface.degrees[baked.worst]} degrees`);
});

const DAMAGED = /^The data of this page (are damaged|are cut off|are not the data of a report|have version)/;

// Returns {begin, size, count} for each array of floating-point numbers in the data of a report (the container).
// `begin` and `size` are in bytes.
function arraysOf(bytes) {
  const size = bytes.readUInt32LE(12), first = Math.ceil((16 + size) / 8) * 8, found = [];
  const look = (value) => {
    if (value === null || typeof value !== 'object') return;
    if (['f32', 'f64'].includes(value.type)) found.push({ begin: first + value.offset, size: Number(value.type.slice(1)) / 8, count: value.count });
    Object.values(value).forEach(look);
  };
  look(JSON.parse(bytes.subarray(16, 16 + size)));
  return found.filter(({ count }) => count > 0);
}

test(`data with a number that is not finite, at a place of the seed ${SEED}, are refused`, () => {
  dataOf('bumps', path('bumps.glb'));
  const whole = readFileSync(path('bumps.bin')), arrays = arraysOf(whole), random = randomNumbers(SEED);
  const below = (count) => Math.floor(count * random());
  for (let i = 0; i < 100; ++i) {
    const { begin, size, count } = arrays[below(arrays.length)], bytes = Buffer.from(whole);
    const at = begin + size * below(count), value = [NaN, Infinity, -Infinity][below(3)];
    size === 4 ? bytes.writeFloatLE(value, at) : bytes.writeDoubleLE(value, at);
    assert.throws(() => readContainer(bytes), { message: DAMAGED }, `${value} at ${at}`);
  }
});

// Changes or removes some characters of the base64 data in a page.
function damage(page, random) {
  const [, before, data, after] = page.match(/^(.*id="chronormal-data">)([^<]*)(<.*)$/s);
  const from = Math.floor(data.length * random()), kind = Math.floor(4 * random());
  const broken = [
    () => data.slice(0, from), () => data.slice(0, from - (from % 4)),
    () => `${data.slice(0, from)}!${data.slice(from + 1)}`,
    () => `${data.slice(0, from)}${data[from] === 'A' ? 'B' : 'A'}${data.slice(from + 1)}`,
  ][kind]();
  return { broken, page: before + broken + after };
}

test(`data that are damaged, by the seed ${SEED}, are called that`, async () => {
  const page = readFileSync(pageOf('bumps', path('bumps.glb')), 'utf8'), random = randomNumbers(SEED);
  for (let i = 0; i < 100; ++i) {
    const { broken } = damage(page, random);
    const open = async () => readContainer(await unzipped(fromBase64(broken)));
    await assert.rejects(open, { message: DAMAGED }, `${i}`);
  }
});

describe('in Chromium', () => {
  let pages;
  before(async () => (pages = await openPages()));
  after(() => pages.close());

  test('a report shows the number of the audit at its worst place, follows its slider, and asks for nothing', async () => {
    await pages.show(pageOf('bumps', path('bumps.glb')));
    const { worst_degrees: worst } = audited(path('bumps.glb'));
    assert.ok(Math.abs((await clickWorst(pages.page)).degrees - worst) < NEAR);
    await pages.page.evaluate(() => {
      const slider = document.querySelector('.time');
      slider.value = 0;
      slider.dispatchEvent(new Event('input'));
    });
    assert.ok((await worstNow(pages.page)).degrees < NEAR, 'the base is right');
    await pages.page.keyboard.press('3');
    assert.equal(await pages.page.$eval('.segmented button[aria-pressed=true]', (button) => button.textContent), 'Error');
    assert.deepEqual(pages.faults, []);
  });

  test('a report draws the figures of the face at its worst place, and follows t, turns and colours', async () => {
    await pages.show(pageOf('twist', '--sample', 'twist'));
    const { page } = pages, { figures } = dataOf('twist', '--sample', 'twist');
    await page.click('.face summary');
    await page.waitForSelector('.face[data-face]');
    await assertShown(page, figures[0]);
    await page.focus('.figures input[type=range]');
    await page.keyboard.press('ArrowRight');
    await page.$eval('.figures > svg', (svg) => svg.focus());
    for (const key of ['ArrowLeft', 'ArrowUp', 'ArrowUp']) await page.keyboard.press(key);
    assert.equal(await page.evaluate(() => globalThis.chronormal.faces.look().sample), 11);
    await assertShown(page, figures[0]);
    await page.keyboard.press('d');
    await page.select('.figures select', 'quaternion:matrix');
    assert.equal(await page.$$eval('.figures [data-axis]', (axes) => axes.map((axis) => axis.dataset.axis).sort().join()), 'b,b₀,b₁,n,n₀,n₁,t,t₀,t₁');
    await page.select('.figures select', 'decasteljau:4');
    assert.equal(await page.$$eval('.figures [data-level]', (points) => points.length), 10, 'four nodes, three points, two and one');
    await assertShown(page, figures[0]);
    // If a face has no figure, the panel names another face that has one.
    const input = await page.$('.number-field input');
    await input.click({ count: 3 });
    await input.type('7');
    await page.keyboard.press('Enter');
    assert.match(await page.$eval('.face [role=status]', (box) => box.textContent), /none for face 7/);
    await page.click('.face .acts:not(p) button');
    await assertShown(page, figures[0]);
    assert.deepEqual(pages.faults, []);
  });

  test(`a report opens at an error that is visible, for bumps at angles of the seed ${SEED}`, async () => {
    const { page } = pages, random = randomNumbers(SEED);
    for (let i = 0; i < 6; ++i) {
      const angle = 2 * Math.PI * random();
      await writeBump(path('bump.glb'), angle);
      const { worst } = dataOf('bump', path('bump.glb'));
      assert.match(worst[0].label, /primitive 1/, 'the worst place is inside');
      await pages.show(pageOf('bump', path('bump.glb')));
      await page.waitForSelector('.marker:not([hidden])');
      const [box, shown, className] = await page.$eval('.marker', (marker) => [marker.getBoundingClientRect().toJSON(), marker.textContent, marker.className]);
      assert.equal(className, 'marker', 'a marker of a vertex on the far side has another class');
      await page.mouse.move(box.x, box.y);
      await page.waitForSelector('.tip:not([hidden])');
      const tip = await page.$eval('.tip', ({ textContent }) => textContent);
      assert.match(tip, /primitive 0/, `angle ${angle}`);
      assert.equal(tip.split(' · ')[0], shown, `angle ${angle}`);
      await page.mouse.move(0, 0);
    }
    assert.deepEqual(pages.faults, []);
  });

  test('tables, labels and menus fit at usual widths', async () => {
    const { page } = pages, { width, height } = page.viewport();
    await writeBump(path('bump.glb'), 1, 'animation KeyAction');
    chronormal('report', path('bump.glb'), '--for', 'all,gltfpack,quantize,meshopt', '--force', '-q', '-o', path('tables.html'), '--template', template);
    await pages.show(path('tables.html'));
    await page.evaluate(() => {
      for (const panel of document.querySelectorAll('details.panel:not(.face)')) panel.open = true;
      for (const row of document.querySelectorAll('[aria-label="Errors in each viewer"] tbody tr')) [...row.cells].slice(1).forEach((cell, i) => (cell.textContent = i < 3 ? '180.0°' : '1,234'));
    });
    for (const wide of [821, 1000, 1280, 1400]) {
      await page.setViewport({ width: wide, height });
      const tables = await page.$$eval('.scrolled', (boxes) => boxes.map(({ scrollWidth, clientWidth }) => [scrollWidth, clientWidth]));
      assert.equal(tables.length, 2);
      for (const [needed, given] of tables) assert.ok(needed <= given, `${needed} of ${given} pixels at ${wide}`);
      const [needed, given] = await page.$eval('select[aria-label=motion]', (menu) => {
        const pen = document.createElement('canvas').getContext('2d'), style = getComputedStyle(menu), ARROW = 24;
        pen.font = style.font;
        return [pen.measureText(menu.selectedOptions[0].text).width, menu.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight) - ARROW];
      });
      assert.ok(needed <= given, `${needed} of ${given} pixels of the menu at ${wide}`);
    }
    await pages.show(pageOf('twist', '--sample', 'twist'));
    for (const wide of [600, 800, 1280]) {
      await page.setViewport({ width: wide, height });
      for (const layout of ['side', 'wipe']) {
        await page.evaluate((name) => {
          const { view, setLayout } = globalThis.chronormal;
          setLayout(name);
          view.draw();
        }, layout);
        const [left, right, stage] = await page.evaluate(() => [...document.querySelectorAll('.stage .label'), document.querySelector('.stage')].map((box) => {
          const { left, right, top } = box.getBoundingClientRect();
          return { left, right, top, isCut: box.scrollWidth > box.clientWidth };
        }));
        assert.deepEqual([left.isCut, right.isCut], [false, false], `${layout} at ${wide}`);
        const end = left.top < right.top ? stage.right : right.left - 8;
        assert.ok(left.right <= end - 8 + 1, `${layout} at ${wide}: ${left.right} of ${end}`);
      }
    }
    await page.setViewport({ width, height });
    assert.deepEqual(pages.faults, []);
  });

  test('the candidates of a bake have different names, and the headline says what an average is', async () => {
    const { page } = pages;
    chronormal('report', path('authored.glb'), '--force', '-q', '-o', path('tables.html'), '--template', template);
    chronormal('report', path('authored.glb'), '--force', '-q', '-o', path('tables.bin'));
    const { plan, audit } = readContainer(readFileSync(path('tables.bin'))), [{ candidates }] = plan.meshes;
    await pages.show(path('tables.html'));
    const names = await page.$$eval('[aria-label="Candidates of a bake"] tbody td:first-child', (cells) => cells.map(({ textContent }) => textContent.replace(/^✓\s/, '')));
    assert.equal(new Set(names.slice(0, candidates.length)).size, candidates.length, names.join());
    const titles = { three: 'three.js', godot: 'Godot 4' };
    const notes = (await page.$$eval('.panel .note', (boxes) => boxes.map(({ textContent }) => textContent))).join('\n');
    for (const { viewer, named } of candidates[0].viewers.filter(({ viewer }) => viewer in titles)) {
      assert.match(notes, new RegExp(`${named ? 'in the worst of these viewers' : 'the worst of the other viewers'}: [^.]*${titles[viewer]}`));
    }
    const words = await page.$eval('.verdict', ({ textContent }) => textContent);
    assert.equal(/edges are torn on average\.$/.test(words), audit.torn_edges[0] >= 0.05, words);
    assert.doesNotMatch(words, /torn\.$/);
  });

  test('a page whose data are damaged says so', async () => {
    const whole = readFileSync(pageOf('bumps', path('bumps.glb')), 'utf8'), random = randomNumbers(SEED);
    for (let i = 0; i < 8; ++i) {
      writeFileSync(path('damaged.html'), damage(whole, random).page);
      await pages.show(path('damaged.html'));
      assert.match(await pages.page.$eval('.fault', (box) => box.textContent), DAMAGED);
    }
    assert.deepEqual(pages.faults, []);
  });

  test('what is drawn as right has the pixels of a still mesh with the exact normals', async () => {
    await pages.show(pageOf('still', path('still.glb'), '--weighting', 'area'));
    const weights = [0.7, 0.4], mesh = (await read(path('still.glb'))).meshes[0];
    const right = new ExactNormals(mesh).at(weights).flatMap(({ directions }) => [...directions]);
    const positions = mesh.primitives.flatMap((primitive) => [...exactPositions(primitive, weights)]);
    const { drawn, still, different } = await pages.page.evaluate((w, p, n) => {
      const { player, view, setMode } = globalThis.chronormal;
      const pixels = () => {
        view.draw();
        const { width, height } = view.canvas, sheet = new OffscreenCanvas(width, height).getContext('2d');
        sheet.drawImage(view.canvas, 0, 0);
        return sheet.getImageData(width / 2, 0, width / 2, height).data;
      };
      setMode('normals');
      w.forEach((weight, k) => player.setWeight(k, weight));
      const drawn = pixels(), { surface } = player;
      surface.positions.set(p);
      for (let i = 0; i < n.length; i += 3) {
        const length = Math.hypot(n[i], n[i + 1], n[i + 2]) || 1;
        for (let c = 0; c < 3; ++c) surface.right[i + c] = n[i + c] / length;
      }
      view.update();
      const still = pixels();
      let different = 0;
      for (let i = 0; i < still.length; ++i) if (Math.abs(still[i] - drawn[i]) > 1) ++different;
      const covered = (data) => data.filter((value, i) => i % 4 === 3 && value > 0).length;
      return { drawn: covered(drawn), still: covered(still), different };
    }, weights, positions, right);
    assert.ok(drawn > 10_000, `${drawn} pixels are drawn`);
    assert.equal(drawn, still);
    assert.equal(different, 0);
    assert.deepEqual(pages.faults, []);
  });

  const files = DATA ? readdirSync(DATA, { recursive: true }).filter((name) => /^(gltf|rigs)\/.*\.(glb|gltf)$/.test(name)) : [];
  for (const name of FULL ? files : []) {
    test(`a report of ${name} shows the number of the audit`, async () => {
      const file = join(DATA, name), { worst_degrees: worst, judged } = audited(file);
      if (judged === 0) return assert.throws(() => pageOf(basename(name), file), /nothing to show/);
      await pages.show(pageOf(basename(name), file));
      if (worst >= SHOWN) assert.ok(Math.abs((await clickWorst(pages.page)).degrees - worst) < NEAR);
      assert.deepEqual(pages.faults, []);
    });
  }
});
