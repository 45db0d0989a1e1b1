// Uses the add-on of blender/ in Blender as a person does. Compares the normals of the exported files with the normals
// that Blender evaluates. ctest runs this file as `blender` if Blender is installed.
//
//   CHRONORMAL_SEED  another seed for the models and poses; the seed in use is printed
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { chmodSync, copyFileSync, cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { runBlenderAs } from './blender.mjs';
import { errors, readModel, readTruth } from './blender_truth.mjs';
import { angle } from './exact.mjs';
import { chronormal } from './program.mjs';
import { read, shownNormals } from './reader.mjs';

const SEED = process.env.CHRONORMAL_SEED ?? '51';
const ROOT = fileURLToPath(new URL('../..', import.meta.url));

// The largest permitted errors in degrees, as in blender_truth.test.mjs: AT_KEYS is for the base and the shape keys,
// MEAN (average) and WORST are for times of the animation.
const AT_KEYS = 0.02;
const MEAN = 0.02;
const WORST = 1;

// The largest permitted difference, in degrees, between the measurements of a pose by the panel and by this test. The
// measurements differ because the panel and the test match corners with vertices in different ways.
const AGREE = 0.02;

// Models with edges that become hard by their angle, but only in deformed poses. Morph targets cannot represent such
// edges.
const HARD_IN_POSES = ['facets'];

const PLAIN = /your plain export was kept/;

let folder, program;
const at = (name) => join(folder, name);
const bytes = (name) => readFileSync(at(name));

// Runs a task of blender_addon.py and returns its results. Uses the add-on in blender/ unless `how` names another
// add-on.
function run(how, task, ...args) {
  const env = { BLENDER_USER_SCRIPTS: at('user'), TMPDIR: folder, HOME: folder, ...how.env };
  runBlenderAs({ ...how, env }, at('scripts/blender_addon.py'), task, folder, ...args);
  return JSON.parse(readFileSync(at(`${task}.json`), 'utf8'));
}

function write(name, text, mode) {
  writeFileSync(at(name), text);
  chmodSync(at(name), mode);
}

before(() => {
  // Puts all files into a folder that every user may read. One task runs as another user, because root could write even
  // into a folder without write permission.
  folder = mkdtempSync(join(tmpdir(), 'chronormal_addon_'));
  chmodSync(folder, 0o777);
  program = at('chronormal');
  copyFileSync(resolve(process.env.CHRONORMAL_PROGRAM), program);
  chmodSync(program, 0o755);
  mkdirSync(at('scripts'));
  for (const name of ['blender_addon.py', 'blender_truth.py']) copyFileSync(join(ROOT, 'tests/viewers', name), at(`scripts/${name}`));
  const addon = at('user/addons/chronormal_blender');
  mkdirSync(addon, { recursive: true });
  cpSync(join(ROOT, 'blender'), addon, { recursive: true, filter: (path) => !path.includes('__pycache__') });
});
after(() => rmSync(folder, { recursive: true, force: true }));

const text = ({ stills, times }) =>
  [stills, times].map(({ mean, worst }) => `${mean.toFixed(4)} / ${worst.toFixed(3)}`).join(', at times ');

// Returns the worst error, in degrees, of the vertices of a file at one recorded instant.
function worstAt(model, posed, i) {
  let worst = 0;
  model.exported.meshes[0].primitives.forEach((primitive, p) => {
    const normals = shownNormals(primitive, Float32Array.from(posed.instants[i].weights));
    model.loops[p].forEach((loop, v) => (worst = Math.max(worst, angle(normals.subarray(3 * v, 3 * v + 3), posed.normal(i, loop)))));
  });
  return worst;
}

describe('The add-on', () => {
  let found, models;
  before(async () => {
    found = run({}, 'models', program, SEED);
    models = await Promise.all(Object.keys(found).map((name) => readModel(at(name))));
    assert.ok(models.length >= 6);
  });

  async function eachModel(context, check) {
    context.diagnostic(`CHRONORMAL_SEED=${SEED}`);
    for (const model of models) await context.test(model.name, (own) => check(model, found[model.name], own));
  }

  test('changes no byte of a file while it is off, not even after its panel has coloured the mesh', (context) =>
    eachModel(context, ({ name }, { colours_are_back: coloured }) => {
      assert.ok(bytes(`${name}.glb`).equals(bytes(`${name}.off.glb`)));
      assert.ok(bytes(`${name}.glb`).equals(bytes(`${name}.looked_at.glb`)));
      assert.ok(coloured);
    }));

  test('exports files that show the normals of Blender, at keys and at every time', (context) =>
    eachModel(context, async (model, { report: [level, said] }, own) => {
      const results = { glb: await read(at(`${model.name}.right.glb`)) };
      if (model.name === 'head') results.gltf = await read(at('head.right.gltf'));
      for (const [form, result] of Object.entries(results)) {
        const { stills, times } = errors(result, model);
        own.diagnostic(`${form}: as exported ${text(errors(model.exported, model))}; corrected ${text({ stills, times })}`);
        assert.ok(stills.worst <= AT_KEYS, `${form}: at keys up to ${stills.worst} degrees`);
        if (HARD_IN_POSES.includes(model.name)) continue;
        assert.ok(times.mean <= MEAN && times.worst <= WORST, `${form}: ${times.mean} / ${times.worst} degrees`);
      }
      own.diagnostic(said);
      // The operator of the add-on warns if the error halfway to a shape key exceeds the tolerance. No file can avoid
      // this error unless a program sets the weights of the correction targets.
      assert.equal(level, said.includes('could not bring') ? 'WARNING' : 'INFO', said);
      assert.match(said, HARD_IN_POSES.includes(model.name) ? /^Normals/ : /^Normals were corrected: error on average .* correction targets?\./);
      assert.ok(!said.includes('--'), 'an artist knows no option of a command');
    }));

  test('shows the error that the exported file has, at sliders drawn at random', (context) =>
    eachModel(context, (model, { posed: looked }, own) => {
      const posed = readTruth(at(`${model.name}.posed`));
      looked.forEach(({ worst, painted }, i) => {
        const right = worstAt(model, posed, i);
        own.diagnostic(`worst by the panel ${worst.toFixed(3)}, by the file ${right.toFixed(3)}`);
        assert.ok(Math.abs(worst - right) <= AGREE && Math.abs(painted - right) <= AGREE);
      });
      assert.ok(looked.some(({ worst }) => worst > 0.1));
    }));

  test('shows over the timeline what is wrong of the plain file, and nothing of the corrected one', (context) =>
    eachModel(context, (model, { over_time: plain, baked_over_time: baked, leaves }, own) => {
      const { times } = errors(model.exported, model);
      own.diagnostic(`plain ${plain.average}, corrected ${baked.average}, the file ${times.mean}`);
      // The panel checks every frame, but only every third frame was recorded, so the panel may find a larger error.
      assert.ok(plain.poses > 40 && plain.worst >= times.worst - AGREE);
      assert.ok(plain.findings.some(([kind]) => kind === 'FRAME') && plain.findings.some(([kind]) => kind === 'PLACE'));
      if (!HARD_IN_POSES.includes(model.name)) assert.ok(baked.mean <= MEAN && baked.worst <= WORST, JSON.stringify(baked));
      assert.ok(leaves, 'the panel left something in the file');
    }));

  test('lists keys and pairs, and jumps to where they are as wrong as it said', (context) =>
    eachModel(context, (model, { keys, jumps }) => {
      assert.ok(keys.findings.every(([, , degrees], i, all) => i === 0 || all[i - 1][0] !== all[i][0] || all[i - 1][2] >= degrees));
      assert.equal(jumps !== null, keys.findings.some(([kind]) => kind === 'PAIR'));
      if (jumps) assert.ok(Math.abs(jumps.said - jumps.there) < 1e-3 && jumps.ones === 2, JSON.stringify(jumps));
    }));

  // Blender imports triangles with custom normals, so an imported file differs from the author's model. The test
  // therefore imports and exports both the baked file and the plain file, and compares the results.
  test('makes the corrections of a baked file idle when it is imported, and bakes the keys of its author again', async (context) => {
    const names = ['head', 'sharp_cylinder', 'triangles', 'mixed', 'weighted'];
    for (const name of names) chronormal('bake', at(`${name}.glb`), '-o', at(`${name}.baked.glb`), '--quiet');
    const imported = run({}, 'imports', program, ...names, ...names.map((name) => `${name}.baked`));
    for (const name of names) {
      await context.test(name, async (own) => {
        const { report, keys, curves, marks, again: said } = imported[`${name}.baked`];
        const authored = models.find((one) => one.name === name).exported.meshes[0].weights.length;
        const [mine, idle] = [keys.slice(0, authored), keys.slice(authored)];
        assert.ok(idle.length > 0 && idle.every(([key, mute, value]) => key.startsWith('idle correction') && mute && value === 0), JSON.stringify(keys));
        assert.deepEqual(mine, imported[name].keys.map(([key, mute], k) => [key, mute, mine[k][2]]));
        assert.deepEqual(curves, imported[name].curves);
        assert.deepEqual(marks, [false, false]);
        assert.match(report[1], /1 mesh was baked by chronormal/);
        assert.equal(imported[name].report[1], '');
        assert.deepEqual(imported[`${name}.baked`].by_hand, [idle.length, false]);

        const off = await read(at(`${name}.baked.again_off.glb`));
        assert.equal(off.meshes[0].weights.length, authored);
        assert.equal(off.meshes[0].extras.chronormal, undefined);
        const ends = async (file) => ({
          targets: (await read(at(`${file}.glb`))).meshes[0].weights.length,
          mean: JSON.parse(chronormal('audit', at(`${file}.glb`), '--animation', '0', '--json', '--quiet')).mean_degrees,
        });
        const [plain, again] = await Promise.all([ends(`${name}.again`), ends(`${name}.baked.again`)]);
        own.diagnostic(`from the plain file ${JSON.stringify(plain)}, from the baked one ${JSON.stringify(again)}; ${said[1]}`);
        assert.ok(again.targets > authored && again.targets <= plain.targets && again.mean <= plain.mean + MEAN);
      });
    }
  });

  test('leaves the plain file and says why, whatever is in the way', () => {
    mkdirSync(at('read_only'));
    mkdirSync(at('Köpfe und Löcher'));
    chmodSync(at('Köpfe und Löcher'), 0o777);
    write('read_only/there.glb', '', 0o666);
    chmodSync(at('read_only'), 0o555);
    write('failing', '#!/bin/sh\necho "chronormal bake: the disk is full" >&2\nexit 1\n', 0o755);
    write('silent', '#!/bin/sh\nexit 0\n', 0o755);
    write('no_program', 'this is a text\n', 0o755);
    const somebody = process.getuid() === 0 ? { uid: 65534, gid: 65534 } : {};
    const said = run(somebody, 'failures', program);
    const reasons = {
      missing: /preferences name the program .*missing, which is not there/,
      failing: /the disk is full/,
      silent: /does not answer as chronormal does/,
      no_program: /could not be started/,
      none: /was not found.*Preferences/,
      read_only: /ermission denied/,
      unknown: /does not know this version of the glTF exporter/,
    };
    for (const [name, reason] of Object.entries(reasons)) {
      const [level, why] = said[name];
      assert.equal(level, 'WARNING', name);
      assert.match(why, name === 'unknown' ? /Your plain export was kept/ : PLAIN);
      assert.match(why, reason);
      const file = name === 'read_only' ? 'read_only/there.glb' : `${name}.glb`;
      assert.ok(bytes(file).equals(bytes('plain.glb')), name);
    }
    assert.match(said.right[1], /^Normals were corrected/);
    assert.ok(!bytes('right.glb').equals(bytes('plain.glb')));
    assert.ok(bytes('right.glb').equals(bytes('Köpfe und Löcher/Größe 1 – äöü.glb')));
    assert.match(said.umlauts[1], /^Normals were corrected/);
  });

  test('leaves nothing in Blender when it is disabled', () => {
    const { before: earlier, during, after: later } = run({}, 'leaves', program);
    assert.notDeepEqual(during.types, earlier.types);
    assert.notEqual(during.writer, earlier.writer);
    assert.notDeepEqual(during.attributes, earlier.attributes);
    assert.deepEqual(later, earlier);
  });

  test('is installed from its zip with the program in it, whose permissions Blender drops', () => {
    mkdirSync(at('linux'));
    copyFileSync(program, at('linux/chronormal'));
    const system = { x64: 'linux-x64', arm64: 'linux-arm64' }[process.arch];
    const pack = (name) => {
      const { status, stderr } = spawnSync('python3', [join(ROOT, 'tools/dist/blender_addon.py'), at(name), `${system}=${at('linux')}`], { encoding: 'utf8' });
      assert.equal(status, 0, stderr);
    };
    pack('addon.zip');
    pack('again.zip');
    assert.ok(bytes('addon.zip').equals(bytes('again.zip')));
    const env = { BLENDER_USER_SCRIPTS: at('fresh'), PATH: '/usr/bin:/bin' };
    const { report, program: used, file } = run({ env }, 'installs', at('addon.zip'));
    assert.ok(file.startsWith(at('fresh')) && used.startsWith(at('fresh')), `${file} ${used}`);
    assert.match(report[1], /^Normals were corrected/);
  });

  test('has the version of the project, for old versions of Blender and for new ones', () => {
    const source = (name) => readFileSync(join(ROOT, name), 'utf8');
    const version = source('CMakeLists.txt').match(/^project\(chronormal VERSION ([0-9.]+)/m)[1];
    assert.equal(source('blender/__init__.py').match(/"version": \(([0-9, ]+)\)/)[1].replaceAll(', ', '.'), version);
    assert.equal(source('blender/blender_manifest.toml').match(/^version = "(.*)"$/m)[1], version);
  });
});
