// Tests the TypeScript types of the npm package. The types must match the arguments of the functions of the package,
// and the contents of reports.
//
//   CHRONORMAL_PROGRAM=build/release/chronormal CHRONORMAL_NPM=build/wasm-test/package node --test
//   tests/viewers/types.test.mjs
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import ts from 'typescript';
import { install } from './installed.mjs';
import { randomNumbers } from './random.mjs';

const { folder, remove, load, native } = install();
after(remove);

const { flagsOf } = await load('options.js');
const COMMANDS = ['audit', 'bake', 'compare', 'inspect', 'sample'];
const REPORTS = { audit: 'AuditReport', bake: 'BakeReport', compare: 'CompareReport', inspect: 'InspectReport' };

// CALL lists the options of a call of the npm package that the program does not have. FOR_PEOPLE lists the options of
// the program that a call does not have, since they make sense only for people or with files.
const CALL = ['name', 'resources', 'signal', 'onProgress', 'worker', 'memoryLimit'];
const FOR_PEOPLE = ['help', 'help-all', 'json', 'csv', 'output', 'force', 'quiet', 'sample', 'each', 'errors', 'drivers', 'shard', 'resume', 'table', 'format'];

const listed = (name) => readFileSync(new URL(`../cli/${name}`, import.meta.url), 'utf8').trim().split('\n').map((line) => line.split(' '));
const optionsOf = (command) => listed('stable_options.txt').filter(([of, option]) => of === command && !FOR_PEOPLE.includes(option.slice(2)))
  .map(([, option]) => option.slice(2).replace(/-([a-z])/g, (_, letter) => letter.toUpperCase()));

// Compiles a text as TypeScript. Returns the lines with errors.
function checked(text) {
  const path = join(folder, 'user.mts');
  writeFileSync(path, text);
  const program = ts.createProgram([path], { noEmit: true, strict: true, target: ts.ScriptTarget.ES2022, module: ts.ModuleKind.NodeNext, skipLibCheck: true });
  const faults = ts.getPreEmitDiagnostics(program).map(({ file, start, messageText }) => ({
    line: file ? file.getLineAndCharacterOfPosition(start).line : -1, said: ts.flattenDiagnosticMessageText(messageText, '\n'),
  }));
  return { program, faults, source: program.getSourceFile(path) };
}

test('the types are right', () => {
  const { faults } = checked(`
import { audit, bake, inspect, sample, ChronormalError, type Baked } from 'chronormal';
import { chronormal, command } from 'chronormal/gltf-transform';
import { attach as attachBabylon, detach as detachBabylon } from 'chronormal/babylon';
import { attach as attachPlayCanvas, detach as detachPlayCanvas } from 'chronormal/playcanvas';
import { attach, detach, drive } from 'chronormal/three';
import type { AbstractMesh, Scene } from '@babylonjs/core';
import type { AppBase, Asset, MeshInstance } from 'playcanvas';
import type { Document } from '@gltf-transform/core';
import type { Mesh, Object3D } from 'three';

export async function use(input: Uint8Array, document: Document): Promise<number> {
  const { bytes, report, within }: Baked = await bake(input, {
    for: ['three', 'godot'], tolerance: 0.5, maxTargets: 112, onProgress: ({ label, percent }) => console.log(label, percent),
  });
  await document.transform(chronormal({ for: 'all', onReport: ({ schema }) => console.log(schema) }));
  try { await audit(bytes, { for: ['three'], samples: 8 }); } catch (error) { if (error instanceof ChronormalError) return error.code; }
  await audit(bytes, { name: 'walk.npz', path: 'catmull-rom' });
  await audit(bytes, { for: 'three', weights: '-1:1' });
  await bake(input, { for: 'three' });
  const { normals, shape } = await sample(bytes, { weights: [[0, 1], [1, 0]] });
  const first: number = normals[0] * shape[0];
  // @ts-expect-error: a plan is no file
  (await bake(input, { plan: true })).bytes;
  // @ts-expect-error: there is no such option
  await inspect(input, { tolerance: 1 });
  // @ts-expect-error: a number is no text
  await bake(input, { tolerance: '1' });
  // @ts-expect-error: there is no such path
  await audit(bytes, { name: 'walk.npz', path: 'round' });
  // @ts-expect-error: there is no such viewer
  await bake(input, { for: ['four'] });
  return within ? report.schema : bytes.length + first;
}

export function live(root: Object3D, scene: Scene, app: AppBase, asset: Asset): number {
  const meshes: Mesh[] = attach(root), others: AbstractMesh[] = attachBabylon(scene);
  drive(root);
  detach(root);
  detachBabylon(scene);
  const shown: MeshInstance[] = attachPlayCanvas(app, asset);
  detachPlayCanvas(app);
  // @ts-expect-error: a scene of Babylon.js is none of three.js
  attach(scene);
  return meshes.length + others.length + shown.length;
}
export default { onProgramReady: command };
`);
  assert.deepEqual(faults, []);
});

test('every function takes the options of its command, by its types and when it runs', () => {
  const { program, source } = checked(COMMANDS.map((command) => `import { ${command} } from 'chronormal';\n`).join('') +
    COMMANDS.map((command) => `export const of_${command}: keyof NonNullable<Parameters<typeof ${command}>[1]> = null!;\n`).join(''));
  const checker = program.getTypeChecker(), exported = checker.getExportsOfModule(checker.getSymbolAtLocation(source));
  for (const command of COMMANDS) {
    const type = checker.getTypeOfSymbol(exported.find(({ name }) => name === `of_${command}`));
    const typed = type.types.map(({ value }) => value).sort(), expected = [...optionsOf(command), ...CALL].sort();
    assert.deepEqual(typed, expected, command);
    for (const name of expected) assert.doesNotThrow(() => flagsOf(command, { [name]: undefined }), `${command} ${name}`);
    for (const name of FOR_PEOPLE) assert.throws(() => flagsOf(command, { [name]: true }), { name: 'ChronormalError', code: 2 });
  }
});

test('what compilers refuse is refused when it runs, and nothing else', () => {
  const random = randomNumbers(50); // the seed of all random numbers below
  const pick = (list) => list[Math.floor(list.length * random())];
  const names = [...new Set(COMMANDS.flatMap(optionsOf)), ...CALL.filter((name) => name !== 'signal'), 'tolernace', 'viewers', 'toString', 'json', 'output'];
  const words = ['three', 'all', 'gltf', 'slerp', 'lerp', 'flat', 'area', 'area-angle', 'exact', 'keys', 'smallest', 'linear', 'hermite', 'catmull-rom', 'faces',
                 'corners', 'random', 'sequential', 'lagrange:3', 'quaternion:random:7', 'circle:timed', 'four', 'Three', ''];
  const values = [() => pick([0, 1, 2.5, -1]), () => pick([true, false]), () => pick(words), () => [pick(words)], () => [pick(words), pick(words)], () => pick([null, {}, [1]])];
  const drawn = Array.from({ length: 1500 }, () => {
    const command = pick(COMMANDS);
    return { command, name: pick(random() < 0.7 ? optionsOf(command) : names), value: pick(values)() };
  });
  const lines = drawn.map(({ command, name, value }) => `${command}(null! as Uint8Array, { ${name}: ${JSON.stringify(value)} });`);
  const { faults } = checked([`import { ${COMMANDS.join(', ')} } from 'chronormal';`, ...lines].join('\n'));
  const refusedByTypes = new Set(faults.map(({ line }) => line - 1)), known = new Map();
  // Tells whether the program knows these flags, even if it then refuses a particular file.
  const knows = (command, flags) => {
    const key = [command, ...flags].join('\0');
    if (!known.has(key)) {
      const { stderr } = native([command, 'bumps.glb', ...flags, '--json', '--force', '-o', 'out.glb']);
      known.set(key, !/: there (is|are) no [\w ]+ '|: the (encoding|access|table) must be/.test(stderr));
    }
    return known.get(key);
  };
  let taken = 0;
  drawn.forEach(({ command, name, value }, n) => {
    let refused = false;
    try {
      const flags = flagsOf(command, { [name]: value });
      refused = typeof value !== 'boolean' && flags.some((word) => words.includes(word.split(',')[0])) && !['base', 'poses', 'animation', 'times', 'weights'].includes(name) && !knows(command, flags);
    } catch (error) {
      assert.match(error.name, /^(TypeError|ChronormalError)$/);
      refused = true;
    }
    if (!refused) ++taken;
    assert.equal(refused, refusedByTypes.has(n), `${lines[n]} ${faults.find(({ line }) => line === n + 1)?.said ?? 'the types take it'}`);
  });
  assert.ok(taken > 150, `${taken}`);
});

test('reports have the types of theirs, and every key that may be in one', () => {
  assert.equal(native(['convert', '--sample', 'bumps', '-o', 'bumps.glb']).status, 0);
  assert.equal(native(['convert', '--sample', 'twist', '-o', 'twist.npz']).status, 0);
  for (const [name, z] of [['a', 0], ['b', 1], ['c', 3]]) {
    writeFileSync(join(folder, `${name}.obj`), `v 0 0 0\nv 1 0 0\nv 0 1 ${z}\nv 1 1 ${z}\nf 1 2 3\nf 2 4 3\n`);
  }
  const runs = ['audit a.obj b.obj', 'audit bumps.glb --for all --tolerance 1', 'audit a.obj b.obj c.obj --path catmull-rom',
    'bake a.obj b.obj -o ab.glb', 'bake bumps.glb -o right.glb', 'bake bumps.glb -o exact.glb --encode exact', 'bake a.obj b.obj c.obj --encode keys -o keys.glb',
    'bake right.glb --no-audit -o again.glb', 'compare a.obj b.obj', 'compare twist.npz --certify --no-times', 'compare a.obj b.obj --tolerance 1 --elements corners',
    'compare bumps.glb --blend 2', 'compare a.obj b.obj --face 0', 'compare a.obj b.obj c.obj --truth 2', 'inspect a.obj b.obj', 'inspect bumps.glb', 'inspect right.glb', 'inspect a.obj'];
  const reports = runs.map((run) => {
    const { stdout, stderr } = native([...run.split(' '), '--json']);
    assert.notEqual(stdout, '', `${run}: ${stderr}`);
    return { run, command: run.split(' ')[0], text: stdout };
  });
  const plan = native(['bake', 'bumps.glb', '--plan', '--json']).stdout;
  const { program, source, faults } = checked([`import type { PlanReport, ${Object.values(REPORTS).join(', ')} } from 'chronormal';`,
    ...Object.entries(REPORTS).map(([command, type]) => `export declare const ${command}: ${type};`),
    `export const plan: PlanReport = ${JSON.stringify(JSON.parse(plan))};`,
    ...reports.map(({ command, text }, n) => `export const report_${n}: ${REPORTS[command]} = ${JSON.stringify(JSON.parse(text))};`)].join('\n'));
  assert.deepEqual(faults.map(({ line, said }) => `${reports[line - 6]?.run}: ${said}`), []);

  const checker = program.getTypeChecker(), exported = checker.getExportsOfModule(checker.getSymbolAtLocation(source));
  // Some keys of the JSON occur only with several inputs, which a call cannot have.
  const elsewhere = (path) => /^(audit (error|files)|compare inputs)/.test(path);
  const parts = (type) => (type.isUnion() ? type.types.flatMap(parts) : [type]);
  for (const [command, path] of listed('stable_json.txt').filter(([command, path]) => command in REPORTS && !elsewhere(`${command} ${path}`))) {
    let types = parts(checker.getTypeOfSymbol(exported.find(({ name }) => name === command)));
    for (const key of path.split('.')) {
      types = types.flatMap((type) => checker.getPropertyOfType(type, key.replace(/\[\]$/, '')) ?? []).map((symbol) => checker.getTypeOfSymbol(symbol)).flatMap(parts);
      if (key.endsWith('[]')) types = types.flatMap((type) => checker.getIndexTypeOfType(type, ts.IndexKind.Number) ?? []).flatMap(parts);
      assert.ok(types.length > 0, `${command} ${path}`);
    }
  }
});
