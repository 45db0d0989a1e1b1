// Tests how much of a bake survives when gltf-transform and gltfpack process the file, by the commands that people use.
// ctest runs this file as `pipelines`. Also checks the commands and figures in the tables of docs/web.md.
//
//   CHRONORMAL_PROGRAM        the program
//   CHRONORMAL_DATA           a folder of moving files from other projects, if set
//   CHRONORMAL_FULL=1         tests every tool on every file, and not only one file with the tools that change the most
//   CHRONORMAL_UPDATE_DOCS=1  with CHRONORMAL_DATA and CHRONORMAL_FULL, writes the figures of docs/web.md
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { drive, driveThree } from '../../examples/drive.mjs';
import { fixtures, writeStill } from './fixtures.mjs';
import { audited, largestDelta, makeWorkshop, runLine, webOf, writePlainEndPoints } from './pipelines.mjs';
import { chronormal } from './program.mjs';
import { read } from './reader.mjs';
import { newComplaints } from './validator.mjs';

const FULL = process.env.CHRONORMAL_FULL === '1';
const DATA = process.env.CHRONORMAL_DATA;
const NO_DATA = !FULL || !DATA ? 'set CHRONORMAL_FULL=1, and CHRONORMAL_DATA to the folder of the real data' : false;
const PAGE = fileURLToPath(new URL('../../docs/web.md', import.meta.url));

// The commands of the tools, each with a number of degrees. After the command, the errors of a baked file may exceed
// the errors of a file with plain end-point deltas by this number.
const PACK_12 = '-vn 12 -vtf -af 0';
const LINES = [
  ['gltf-transform quantize head.glb web.glb', 1],
  ['gltf-transform meshopt head.glb web.glb', 1],
  ['gltf-transform draco head.glb web.glb', 1],
  ['gltf-transform optimize --simplify false head.glb web.glb', 1],
  ['gltfpack -ke -i head.glb -o web.glb', 1],
  ['gltfpack -c -ke -i head.glb -o web.glb', 1],
  ['gltf-transform quantize --quantize-normal 12 head.glb web.glb', 0.15],
  ['gltf-transform meshopt --level medium --quantize-normal 12 head.glb web.glb', 0.15],
  ['gltf-transform draco --quantize-normal 12 head.glb web.glb', 0.15],
  [`gltfpack -ke ${PACK_12} -i head.glb -o web.glb`, 0.15],
  [`gltfpack -c -ke ${PACK_12} -i head.glb -o web.glb`, 0.15],
];
const QUICK_LINES = LINES.filter(([line]) => /optimize|gltfpack -c -ke -i/.test(line));

const REAL = {
  Suzanne: 'rigs/blender_suzanne_two_keys.glb',
  MorphStressTest: 'gltf/MorphStressTest/glTF/MorphStressTest.gltf',
  AnimatedMorphCube: 'gltf/AnimatedMorphCube/glTF/AnimatedMorphCube.gltf',
  RobotExpressive: 'gltf/RobotExpressive/RobotExpressive.glb',
};

let folder;
before(() => (folder = makeWorkshop(mkdtempSync(join(tmpdir(), 'chronormal_pipelines_')))));
after(() => rmSync(folder, { recursive: true, force: true }));

// Makes three variants of a file for the tools: as exported, with plain end-point deltas, and baked. Returns their
// paths by name.
const inputs = new Map();
async function inputsOf(name) {
  if (!inputs.has(name)) {
    const at = (kind) => join(folder, `${name}.${kind}.glb`);
    if (REAL[name]) runLine(`gltf-transform copy ${join(DATA, REAL[name])} ${at('exported')}`, folder);
    else await fixtures[name](at('exported'));
    await writePlainEndPoints(at('exported'), at('plain'));
    chronormal('bake', at('exported'), '-o', at('baked'), '--encode', 'harmless', '--no-audit', '--quiet');
    inputs.set(name, { exported: at('exported'), plain: at('plain'), baked: at('baked') });
  }
  return inputs.get(name);
}

// Returns the errors, in degrees, of one variant (`kind`) of a file after a tool has processed it.
const measured = new Map();
async function measure(line, name, kind) {
  const key = [line, name, kind].join('\n');
  if (!measured.has(key)) {
    const result = join(folder, `${measured.size}.glb`);
    const path = webOf(line, (await inputsOf(name))[kind], result, folder);
    measured.set(key, { path, ...audited(path) });
  }
  return measured.get(key);
}

async function assertKept(context, name, lines) {
  const { exported, baked } = await inputsOf(name);
  const faults = [];
  // Tools limit components of deltas to 1. A bake may therefore write a larger component only if the author's own
  // deltas have a component that is as large.
  const [authored, largest] = [largestDelta(await read(exported)), largestDelta(await read(baked))];
  if (!(largest <= Math.max(1, authored))) faults.push(`a component of ${largest}, where ${authored} was the largest`);
  for (const [line, allowed] of lines) {
    const plain = await measure(line, name, 'plain');
    const kept = await measure(line, name, 'baked');
    // A vertex that keeps the author's delta keeps the error of the exported file. A bake may add keys to a track, and
    // audit takes the same number of samples between any two keys. The exported file has fewer keys, so it is sampled
    // more often to find the same errors.
    const exported = await measure(line, name, 'exported');
    let worst = Math.max(plain.worst, exported.worst);
    if (kept.worst > worst + allowed) worst = Math.max(worst, audited(exported.path, '--samples', '81').worst);
    const text = (degrees) => `${degrees.mean.toFixed(3)} / ${degrees.worst.toFixed(2)}`;
    const outcome = `${line}: plain ${text(plain)}, baked ${text(kept)}`;
    context.diagnostic(outcome);
    // A bake must improve the surface as a whole, but a single normal may become slightly worse.
    if (!(kept.worst <= 1.05 * worst + allowed && kept.mean <= plain.mean + allowed)) faults.push(outcome);
  }
  assert.deepEqual(faults, []);
}

describe('a baked file is no worse than one with plain end-point deltas, after tools', () => {
  const names = FULL ? Object.keys(fixtures) : ['pair'];
  for (const name of names) test(name, (context) => assertKept(context, name, FULL ? LINES : QUICK_LINES));
  for (const name of Object.keys(REAL))
    test(name, { skip: NO_DATA }, (context) => assertKept(context, name, LINES));
});

// Checks that a bake after the tools gives true normals, whatever the tools have done to positions, base normals and
// tracks.
async function assertExactLast(name, lines) {
  for (const [line] of lines) {
    const { path } = await measure(line, name, 'exported');
    const output = join(folder, 'exact_last.glb');
    const how = ['--encode', 'exact', '--weighting', 'area'];  // by other weightings, n(w) is only approximated
    chronormal('bake', path, '-o', output, ...how, '--force', '--no-audit', '--quiet');
    assert.deepEqual(await newComplaints(output, path), []);
    const { worst } = audited(output, '--weighting', 'area');
    assert.ok(worst < 0.01, `${line}: ${worst}`);
  }
}

describe('bake is exact after tools', () => {
  test('pair', () => assertExactLast('pair', FULL ? LINES : QUICK_LINES));
  for (const name of Object.keys(REAL)) test(name, { skip: NO_DATA }, () => assertExactLast(name, LINES));
});

test('a bake that adds keys is not called worse for being looked at more often', async () => {
  const [input, output] = ['few_keys', 'more_keys'].map((name) => join(folder, `${name}.glb`));
  await fixtures.keyframes(input);
  const { audit } = JSON.parse(chronormal('bake', input, '-o', output, '--json', '--quiet'));
  assert.equal(audit.worse, false, JSON.stringify(audit));
});

test('gltfpack -ke leaves what drives extra targets where audit and three.js find it', async () => {
  const [still, baked, packed] = ['still', 'baked', 'packed'].map((name) => join(folder, `${name}.glb`));
  await writeStill(still, { parts: 1 });
  chronormal('bake', still, '-o', baked, '--encode', 'exact', '--no-audit', '--quiet');
  runLine(`gltfpack -ke -i ${baked} -o ${packed}`, folder);
  const [before, after] = [await read(baked), await read(packed)].map(({ meshes }) => meshes[0]);
  assert.ok(before.extras.chronormal.extras.length > 0 && !after.extras.chronormal);
  const { findings } = JSON.parse(chronormal('audit', packed, '--json', '--quiet'));
  assert.ok(findings.some(({ kind }) => kind === 'baked'), JSON.stringify(findings));

  const weights = before.weights.map((_, i) => [0.8, 0.6][i] ?? 0);
  const { scene } = await new GLTFLoader().parseAsync(new Uint8Array(readFileSync(packed)).buffer, '');
  const meshes = [];
  scene.traverse((object) => object.morphTargetInfluences && meshes.push(object));
  assert.equal(meshes.length, 1);
  const shown = meshes[0].morphTargetInfluences;
  weights.forEach((weight, i) => (shown[i] = weight));
  driveThree(scene);
  drive(before.extras.chronormal, weights);
  weights.forEach((weight, i) => assert.ok(Math.abs(shown[i] - weight) < 1e-6, String(shown)));
});

// Reads the tables of docs/web.md. Each table is below a line <!-- measured: NAME -->, and its rows begin with a
// command in backticks.
const lines = readFileSync(PAGE, 'utf8').split('\n');

function blocksOfPage() {
  const blocks = [];
  lines.forEach((line, i) => {
    if (line === '```sh') blocks.push(lines.slice(i + 1, lines.indexOf('```', i)).join('\n'));
  });
  return blocks;
}

// Returns the tables about a file. Each table has its columns, and {index, line} for each row.
function tablesOfPage(name) {
  const tables = [];
  lines.forEach((line, begin) => {
    if (line !== `<!-- measured: ${name} -->`) return;
    const columns = lines[begin + 1].split('|').slice(2, -1).map((title) => title.trim());
    const rows = [];
    for (let index = begin + 3; lines[index].startsWith('|'); ++index)
      rows.push({ index, line: lines[index].split('`')[1] });
    tables.push({ columns, rows });
  });
  return tables;
}

async function measureCell(column, line, name) {
  if (column === 'baked, then') return measure(line, name, 'baked');
  assert.equal(column, 'then baked exact');
  const { path } = await measure(line, name, 'exported');
  const output = join(folder, 'then_baked.glb');
  chronormal('bake', path, '-o', output, '--encode', 'exact', '--force', '--no-audit', '--quiet');
  return audited(output);
}

async function measureRow(columns, line, name) {
  const cells = [`\`${line}\``];
  for (const column of columns) {
    const { mean, worst } = await measureCell(column, line, name);
    cells.push(`${mean.toFixed(2)} / ${worst.toFixed(1)}`);
  }
  return `| ${cells.join(' | ')} |`;
}

describe('docs/web.md', () => {
  test('has lines that run', async () => {
    const blocks = blocksOfPage();
    assert.ok(blocks.length >= 3);
    for (const [i, block] of blocks.entries()) {
      const here = makeWorkshop(join(folder, `block ${i}`));
      await fixtures.pair(join(here, 'head.glb'));
      runLine(block, here);
    }
  });
  for (const name of ['pair', 'Suzanne', 'MorphStressTest']) {
    test(`has the figures of ${name}`, { skip: name in REAL && NO_DATA }, async () => {
      const tables = tablesOfPage(name);
      assert.ok(tables.length > 0);
      const faults = [];
      for (const { columns, rows } of tables) {
        for (const { index, line } of rows) {
          const row = await measureRow(columns, line, name);
          if (row !== lines[index]) faults.push(`line ${index + 1} should be ${row}`);
          lines[index] = row;
        }
      }
      if (process.env.CHRONORMAL_UPDATE_DOCS === '1') writeFileSync(PAGE, lines.join('\n'));
      else assert.deepEqual(faults, []);
    });
  }
});
