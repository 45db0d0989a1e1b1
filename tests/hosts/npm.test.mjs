// The npm package, installed from its tarball in a folder where nothing else is.
//
//   CHRONORMAL_PROGRAM=build/release/chronormal CHRONORMAL_NPM=build/wasm-test/package node --test tests/hosts/npm.test.mjs
//
// CHRONORMAL_NPM is the folder of the package. What the program makes is what is expected, byte for byte.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { NodeIO } from '@gltf-transform/core';

const program = resolve(process.env.CHRONORMAL_PROGRAM);
const folder = mkdtempSync(join(tmpdir(), 'chronormal-npm-'));
after(() => rmSync(folder, { recursive: true, force: true }));

const installed = join(folder, 'node_modules/chronormal');
mkdirSync(join(folder, 'node_modules'));
const packed = execFileSync('npm', ['pack', '--silent', '--pack-destination', folder], { cwd: resolve(process.env.CHRONORMAL_NPM) });
execFileSync('tar', ['-xzf', join(folder, packed.toString().trim().split('\n').at(-1)), '-C', folder]);
cpSync(join(folder, 'package'), installed, { recursive: true });

// What a project that uses glTF-Transform has installed beside it.
symlinkSync(fileURLToPath(new URL('node_modules/@gltf-transform', import.meta.url)), join(folder, 'node_modules/@gltf-transform'));

const { bake, audit, inspect, ChronormalError } = await import(pathToFileURL(join(installed, 'src/index.node.js')));
const bin = join(installed, 'bin/chronormal.js');

function both(args, options = {}) {
  const run = (command, more) => {
    const { status, stdout, stderr } = spawnSync(command, [...more, ...args], { cwd: folder, encoding: 'utf8', ...options });
    return { status, stdout, stderr };
  };
  return { native: run(program, []), wasm: run(process.execPath, [bin]) };
}

// A face with two targets and an animation: what convert makes of the built-in bumps, baked nowhere yet.
const made = spawnSync(program, ['convert', '--sample', 'bumps', '-o', join(folder, 'bumps.glb')], { encoding: 'utf8' });
assert.equal(made.status, 0, made.stderr);
const face = new Uint8Array(readFileSync(join(folder, 'bumps.glb')));

test('the command line says and ends as the program does', () => {
  for (const args of [['--version'], ['--help'], ['bake', '--help'], ['bkae'], ['audit', 'nowhere.glb'], ['audit', 'bumps.glb'],
                      ['audit', 'bumps.glb', '--tolerance', '0.0001'], ['bake', 'bumps.glb']]) {
    const { native, wasm } = both(args);
    assert.deepEqual(wasm, native, args.join(' '));
  }
  assert.equal(both(['inspect', '-', '--json'], { input: face }).wasm.status, 0);
});

test('a bake, a sequence and sampled normals have the same bytes', () => {
  for (const [args, file] of [[['bake', 'bumps.glb', '--encode', 'harmless', '--json', '-o'], 'baked.glb'], [['bake', '--sample', 'twist', '-o'], 'twist.glb'],
                              [['sample', '--sample', 'cloth', '--times', '0.3', '-o'], 'n.npy']]) {
    const outputs = {};
    for (const [name, command, more] of [['native', program, []], ['wasm', process.execPath, [bin]]]) {
      const run = spawnSync(command, [...more, ...args, file], { cwd: folder, encoding: 'utf8' });
      assert.equal(run.status, 0, run.stderr);
      outputs[name] = { bytes: readFileSync(join(folder, file)), stdout: run.stdout };
      rmSync(join(folder, file));
    }
    assert.ok(outputs.native.bytes.equals(outputs.wasm.bytes), `${args.join(' ')}: other bytes`);
    assert.equal(outputs.wasm.stdout, outputs.native.stdout);
  }
});

test('bytes go in, and bytes and a report come out', async () => {
  const before = await audit(face);
  const { bytes, report, within } = await bake(face, { for: ['three'], encode: 'exact' });
  const after = await audit(bytes);
  assert.equal(within, true);
  assert.ok(after.report.mean_degrees < 0.01 * before.report.mean_degrees);
  assert.equal(report.command, 'bake');
  const inThisThread = await bake(face, { for: ['three'], encode: 'exact', worker: false });
  assert.deepEqual(inThisThread.bytes, bytes);
  assert.equal((await audit(face, { tolerance: 1e-4 })).within, false);
});

test('wrong input is refused in the words of the program, and the next call works', async () => {
  await assert.rejects(bake(face.slice(0, 100), { name: 'cut.glb' }), (error) => {
    assert.ok(error instanceof ChronormalError);
    assert.equal(error.code, 3);
    assert.match(error.message, /^cut\.glb/);
    return true;
  });
  await assert.rejects(bake(face, { tolernace: 1 }), { name: 'ChronormalError', code: 2, message: /tolernace.*tolerance/s });
  assert.equal((await inspect(face)).report.command, 'inspect');
});

test('a call that is cancelled ends with the reason', async () => {
  const control = new AbortController();
  const call = bake(face, { signal: control.signal });
  setTimeout(() => control.abort(new Error('enough')), 20);
  await assert.rejects(call, /enough/);
  await assert.rejects(bake(face, { signal: control.signal }), /enough/);
});

test('text glTF comes with the files that it names', async () => {
  writeFileSync(join(folder, 'text.gltf'), '');
  const run = spawnSync(program, ['bake', 'bumps.glb', '--encode', 'endpoint', '--force', '-o', 'text.gltf'], { cwd: folder, encoding: 'utf8' });
  assert.equal(run.status, 0, run.stderr);
  const uri = JSON.parse(readFileSync(join(folder, 'text.gltf'))).buffers[0].uri;
  const resources = uri.startsWith('data:') ? {} : { [uri]: readFileSync(join(folder, uri)) };
  const { bytes } = await bake(readFileSync(join(folder, 'text.gltf')), { resources, name: 'text.gltf', encode: 'exact' });
  assert.equal(JSON.parse(new TextDecoder().decode(bytes)).asset.version, '2.0');
});

test('a transform of glTF-Transform changes what a bake changes, and leaves the rest the same objects', async () => {
  const { chronormal } = await import(pathToFileURL(join(installed, 'src/gltf-transform.js')));
  const io = new NodeIO(), document = await io.readBinary(face);
  const [mesh] = document.getRoot().listMeshes(), [primitive] = mesh.listPrimitives();
  const position = primitive.getAttribute('POSITION'), targets = primitive.listTargets().length;
  let said;
  await document.transform(chronormal({ encode: 'exact', onReport: (report) => (said = report) }));
  assert.equal(document.getRoot().listMeshes()[0], mesh);
  assert.equal(primitive.getAttribute('POSITION'), position);
  assert.ok(primitive.listTargets().length > targets);
  assert.equal(said.command, 'bake');
  const transformed = await audit(await io.writeBinary(document));
  const { bytes } = await bake(face, { encode: 'exact' });
  const baked = await audit(bytes);
  assert.ok(transformed.report.mean_degrees <= 1.001 * baked.report.mean_degrees, `${transformed.report.mean_degrees}`);
  assert.ok(baked.report.mean_degrees < 0.01 * (await audit(face)).report.mean_degrees);
});

test('the types are right', () => {
  writeFileSync(join(folder, 'user.mts'), `
import { audit, bake, ChronormalError, type Baked } from 'chronormal';
import { chronormal } from 'chronormal/gltf-transform';
import type { Document } from '@gltf-transform/core';

export async function use(input: Uint8Array, document: Document): Promise<number> {
  const { bytes, report, within }: Baked = await bake(input, {
    for: ['three', 'godot'], tolerance: 0.5, maxTargets: 112, onProgress: ({ label, percent }) => console.log(label, percent),
  });
  await document.transform(chronormal({ for: 'all', onReport: ({ schema }) => console.log(schema) }));
  try { await audit(bytes, { host: ['three'], samples: 8 }); } catch (error) { if (error instanceof ChronormalError) return error.code; }
  // @ts-expect-error: there is no such host
  await bake(input, { for: ['four'] });
  return within ? report.schema : bytes.length;
}
`);
  const tsc = fileURLToPath(new URL('node_modules/typescript/bin/tsc', import.meta.url));
  const options = ['--noEmit', '--strict', '--target', 'es2022', '--module', 'nodenext', '--skipLibCheck', 'user.mts'];
  const run = spawnSync(process.execPath, [tsc, ...options], { cwd: folder, encoding: 'utf8' });
  assert.equal(run.status, 0, run.stdout);
});

test('a browser bakes in a worker, and its page goes on meanwhile', async () => {
  const { openFolder } = await import('./browser.mjs');
  const { page, close } = await openFolder({ chronormal: installed, 'face.glb': face, 'page.html': '<!doctype html><title>page</title>' });
  try {
    const { size, ticks, refused } = await page.evaluate(async () => {
      const { bake } = await import('/chronormal/src/index.js');
      const input = new Uint8Array(await (await fetch('/face.glb')).arrayBuffer());
      let ticks = 0;
      const clock = setInterval(() => ++ticks, 10);
      const { bytes } = await bake(input, { encode: 'exact' });
      clearInterval(clock);
      const refused = await bake(input.slice(0, 50)).catch(({ code }) => code);
      return { size: bytes.length, ticks, refused };
    });
    const { bytes } = await bake(face, { encode: 'exact' });
    assert.equal(size, bytes.length);
    assert.ok(ticks > 5, `${ticks}`);
    assert.equal(refused, 3);
  } finally {
    await close();
  }
});
