// Tests the npm package, which is installed from its tarball in a folder with nothing else.
//
//   CHRONORMAL_PROGRAM=build/release/chronormal CHRONORMAL_NPM=build/wasm-test/package node --test tests/viewers/npm.test.mjs
//
// CHRONORMAL_NPM is the folder of the package. The output of the package must equal the output of the native program,
// byte for byte.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { NodeIO } from '@gltf-transform/core';
import semver from 'semver';
import { install } from './installed.mjs';
import { randomNumbers } from './random.mjs';

const { folder, installed, tarball, remove, load, native, wasm, node } = install();
after(remove);

const { bake, audit, inspect, compare, sample, ChronormalError } = await load('index.node.js');
const readme = readFileSync(join(installed, 'README.md'), 'utf8');

// The face is the built-in sample bumps, which has 12 targets and an animation. `convert` writes the face without a
// bake.
const made = native(['convert', '--sample', 'bumps', '-o', 'bumps.glb']);
assert.equal(made.status, 0, made.stderr);
const face = new Uint8Array(readFileSync(join(folder, 'bumps.glb')));

test('the command line says and ends as the program does', () => {
  for (const args of [['--version'], ['--help'], ['bake', '--help'], ['bkae'], ['audit', 'nowhere.glb'], ['audit', 'bumps.glb'],
                      ['audit', 'bumps.glb', '--tolerance', '0.0001'], ['bake', 'bumps.glb']]) {
    assert.deepEqual(wasm(args), native(args), args.join(' '));
  }
  assert.equal(wasm(['inspect', '-', '--json'], { input: face }).status, 0);
});

test('an older Node.js is told which one the program needs, and the least of package.json runs it', () => {
  const [, least] = JSON.parse(readFileSync(join(installed, 'package.json'))).engines.node.match(/^>=(\d+)$/);
  const command = join(installed, 'bin/chronormal.js'), older = join(folder, 'older.cjs');
  const runAs = (version) => {
    writeFileSync(older, `Object.defineProperty(process.versions, 'node', { value: '${version}' });`);
    return node(['--require', older, command, '--version']);
  };
  for (const version of ['10.24.1', `${least - 1}.99.0`]) {
    const message = `chronormal: this program needs Node.js ${least} or later, and this is ${version}; install a newer version\n`;
    assert.deepEqual(runAs(version), { status: 1, stdout: '', stderr: message });
  }
  assert.deepEqual(runAs(`${least}.0.0`), native(['--version']));
});

test('packages that tests and pages install run on the Node.js of Debian 12', () => {
  for (const locked of ['package-lock.json', '../../web/package-lock.json']) {
    const { packages } = JSON.parse(readFileSync(new URL(locked, import.meta.url)));
    const others = Object.entries(packages).filter(([, { engines }]) => !semver.satisfies('18.20.4', engines?.node ?? '*'));
    assert.deepEqual(others.map(([name, { engines }]) => `${name} ${engines.node}`), []);
  }
});

test('a bake, a sequence and sampled normals have the same bytes', () => {
  for (const [args, file] of [[['bake', 'bumps.glb', '--encode', 'harmless', '--json', '-o'], 'baked.glb'], [['bake', '--sample', 'twist', '-o'], 'twist.glb'],
                              [['sample', '--sample', 'cloth', '--times', '0.3', '-o'], 'n.npy']]) {
    const outputs = {};
    for (const [name, run] of Object.entries({ native, wasm })) {
      const { status, stdout, stderr } = run([...args, file]);
      assert.equal(status, 0, stderr);
      outputs[name] = { bytes: readFileSync(join(folder, file)), stdout };
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

test('a sequence on curved paths has the report and the bytes of the command line', async () => {
  for (let frame = 0; frame < 4; ++frame) {
    const turned = [[1, 0, 0], [2, 0.3, 0.2], [1.5, 1, 0.4], [2.4, 1.2, -0.3]].map(([x, y, z]) => {
      const c = Math.cos(0.3 * frame), s = Math.sin(0.3 * frame);
      return `v ${c * x + s * z} ${y + 0.1 * frame * frame * x} ${c * z - s * x}\n`;
    });
    writeFileSync(join(folder, `turn_${frame}.obj`), `${turned.join('')}f 1 2 3\nf 2 4 3\n`);
  }
  assert.equal(native(['convert', 'turn_*.obj', '-o', 'turn.npz']).status, 0);
  const turn = new Uint8Array(readFileSync(join(folder, 'turn.npz'))), path = 'catmull-rom', name = 'turn.npz';
  for (const [command, call, more, flags] of [['audit', audit, {}, []], ['compare', compare, { noTimes: true, schemes: ['linear', 'slerp'] },
                                                                          ['--no-times', '--schemes', 'linear,slerp']]]) {
    const { report } = await call(turn, { name, path, ...more });
    assert.deepEqual(report, JSON.parse(native([command, name, '--json', '--path', path, ...flags]).stdout));
    assert.equal((report.input ?? report).path ?? report.path, path);
  }
  const { bytes, report } = await bake(turn, { name, path });
  assert.equal(native(['bake', name, '--path', path, '-o', 'turn.glb']).status, 0);
  assert.deepEqual(Buffer.from(bytes), readFileSync(join(folder, 'turn.glb')));
  assert.equal(report.path, path);
  await assert.rejects(audit(turn, { name, path: 'round' }), /there is no path 'round'/);
});

test('sampled normals are those that the command line writes', async () => {
  const [first, second, third] = [[0.5, 0.25], [1, 0], [-0.5, 2]].map((two) => [...two, ...Array(10).fill(0)]); // bumps has 12 targets
  for (const [options, flags] of [
    [{ weights: first }, ['--weights', `${first}`]],
    [{ weights: [first, second, third], elements: 'faces' }, ['--weights', `${first}`, '--weights', `${second}`, '--weights', `${third}`, '--elements', 'faces']],
    [{ weights: second, scheme: 'slerp' }, ['--weights', `${second}`, '--scheme', 'slerp']],
    [{ weights: third, elements: 'corners', crease: 30 }, ['--weights', `${third}`, '--elements', 'corners', '--crease', '30']],
  ]) {
    const { status, stderr } = native(['sample', 'bumps.glb', ...flags, '-o', 'sampled.npy']);
    assert.equal(status, 0, stderr);
    const file = readFileSync(join(folder, 'sampled.npy')), header = file.subarray(10, 10 + file.readUInt16LE(8)).toString();
    rmSync(join(folder, 'sampled.npy'));
    for (const worker of [true, false]) {
      const { normals, shape } = await sample(face, { ...options, worker });
      assert.ok(header.includes(`'shape': (${shape.join(', ')})`), header);
      assert.deepEqual(Buffer.from(normals.buffer, normals.byteOffset, normals.byteLength), file.subarray(10 + file.readUInt16LE(8)));
    }
  }
  await assert.rejects(sample(face, { weights: [0.5] }), { name: 'ChronormalError', code: 2 });
  await assert.rejects(sample(face, { weights: [] }), TypeError);
});

test('a sample has no warnings about files that the caller does not see', async () => {
  const weights = [Array(12).fill(0.5)]; // bumps has 12 targets
  for (const worker of [true, false]) {
    for (const name of ['a.glb', 'out/a.glb']) assert.deepEqual((await sample(face, { weights, name, worker })).warnings, [], name);
  }
});

test('a message to a program says neither what to type nor where the module keeps its files', async () => {
  for (const worker of [true, false]) {
    const { code, message } = await audit(face, { samples: -1, worker }).catch((error) => error);
    assert.equal(code, 2, message);
    assert.match(message, /^--samples: /);
    assert.doesNotMatch(message, /Try:|--help/);
    const gltf = (uri) => new TextEncoder().encode(JSON.stringify({
      asset: { version: '2.0' }, buffers: [{ uri, byteLength: 36 }], bufferViews: [{ buffer: 0, byteLength: 36 }],
      accessors: [{ bufferView: 0, componentType: 5126, type: 'VEC3', count: 3 }], meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    }));
    for (const [uri, name] of [['a.bin', 'a.bin'], ['b/c%20d.bin', 'b/c d.bin']]) {
      const message = `input.gltf, /buffers/0/uri: this file is missing: ${name}; give its bytes in the option resources: { "${name}": bytes }`;
      await assert.rejects(inspect(gltf(uri), { worker }), { name: 'ChronormalError', code: 3, message });
      assert.equal((await inspect(gltf(uri), { resources: { [name]: new Uint8Array(36) }, worker })).report.command, 'inspect');
    }
  }
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

// Returns the report of a call or, if the call fails, the name, the code and the message of the error.
const outcomeOf = (call) => call.then(({ report }) => report, ({ name, code, message }) => ({ name, code, message }));

test('a file of any name is read under it, or refused with it, in a worker and in this thread', async () => {
  const json = '{"asset": {"version": "2.0"}}   ', tiny = Buffer.alloc(20 + json.length);
  [0x46546c67, 2, tiny.length, json.length, 0x4e4f534a].forEach((word, i) => tiny.writeUInt32LE(word, 4 * i));
  tiny.write(json, 20);
  const expected = (await inspect(tiny)).report, random = randomNumbers(49); // seeds everything that follows
  const below = (count) => Math.floor(count * random());
  const parts = ['', '.', '..', 'out', 'work', '-', '--', '-o', '--json', '-x.glb', 'a.glb', '%d', '*', '[a]', '?', ' ', 'é', '\n', '\0', '\ud800', '\ufeff',
                 '__proto__', 'dev', 'stdin', 'stdout', 'proc', 'x'.repeat(300)];
  const drawn = Array.from({ length: 60 }, () => Array.from({ length: 1 + below(3) }, () => parts[below(parts.length)]).join(['/', ''][below(2)]));
  let read = 0;
  for (const [i, name] of [...parts, ...drawn].entries()) {
    const said = JSON.stringify(name), found = await outcomeOf(inspect(tiny, { name, worker: false }));
    if (found.input) {
      ++read;
      assert.deepEqual(found, { ...expected, input: { ...expected.input, name: /^(-|\[.*\])$/s.test(name) ? `./${name}` : name } });
    } else {
      assert.deepEqual(found, { name: 'ChronormalError', code: 2, message: `${said}: this text cannot be the name of a file; give another name` });
    }
    if (i % 6 === 0) assert.deepEqual(await outcomeOf(inspect(tiny, { name })), found, said);
  }
  assert.ok(read > 30, `${read}`);
  const { bytes: baked } = await bake(face, { encode: 'endpoint' });
  // An input may have any of these names, although the file system inside the module also has a folder `out`, into
  // which the program writes (js/src/task.js).
  for (const name of ['out', 'out/a.glb', '-x.glb', '../work/out/b.glb']) {
    assert.deepEqual((await bake(face, { name, encode: 'endpoint', worker: false })).bytes, baked, name);
  }
  for (const worker of [true, false]) {
    assert.deepEqual(await outcomeOf(inspect(tiny, { resources: { '..': tiny }, worker })),
      { name: 'ChronormalError', code: 2, message: '"..": this text cannot be the name of a file; give another name' });
    await assert.rejects(inspect(tiny, { name: 5, worker }), { name: 'TypeError', message: /^name: / });
  }
});

test('memory of the caller may be used again as soon as a call has returned its promise', async () => {
  const corners = new Uint8Array(new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0]).buffer), text = new TextEncoder().encode(JSON.stringify({
    asset: { version: '2.0' }, buffers: [{ uri: 'a.bin', byteLength: 36 }], bufferViews: [{ buffer: 0, byteLength: 36 }],
    accessors: [{ bufferView: 0, componentType: 5126, type: 'VEC3', count: 3, min: [0, 0, 0], max: [1, 1, 0] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }], nodes: [{ mesh: 0 }], scenes: [{ nodes: [0] }],
  }));
  const views = [(bytes) => bytes, ({ buffer }) => buffer, ({ buffer }) => Buffer.from(buffer), ({ buffer }) => new DataView(buffer)];
  for (const call of [inspect, audit]) {
    const expected = await call(text, { resources: { 'a.bin': corners } });
    for (const worker of [true, false]) {
      for (const viewOf of views) {
        const [own, other] = [text, corners].map((bytes) => Uint8Array.from(bytes));
        const promise = call(viewOf(own), { resources: { 'a.bin': viewOf(other) }, worker });
        own.fill(0);
        other.fill(0);
        assert.deepEqual(await promise, expected);
      }
    }
  }
});

test('an error in what hears of progress ends the call, which can catch it', async () => {
  const onProgress = () => { throw new Error('no more'); };
  for (const worker of [true, false]) await assert.rejects(audit(face, { samples: 6001, worker, onProgress }), /no more/);
});

test('where memory runs out, that is said, and the next call works', async () => {
  const large = new TextEncoder().encode(`{"asset": {"version": "2.0"}, "extras": "${'x'.repeat(12 << 20)}"}`);
  for (const worker of [true, false]) {
    await assert.rejects(inspect(large, { memoryLimit: 32 << 20, worker }), (error) => {
      assert.ok(error instanceof ChronormalError, String(error));
      assert.equal(error.code, 1);
      assert.match(error.message, /^out of memory; /);
      return true;
    });
    for (const [input, memoryLimit] of [[large], [face, 32 << 20]]) {
      assert.equal((await inspect(input, { memoryLimit, worker })).report.command, 'inspect');
    }
  }
});

test('progress is said while it goes on, up to its end', async () => {
  const heard = [];
  // No progress is reported in the first 0.3 s, so the audit takes so many samples that it runs for some seconds.
  await audit(face, { samples: 6001, onProgress: (progress) => heard.push(progress) });
  assert.ok(heard.length > 2, JSON.stringify(heard));
  for (const { label, percent } of heard) assert.ok(typeof label === 'string' && percent >= 0 && percent <= 100);
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
  const run = native(['bake', 'bumps.glb', '--encode', 'endpoint', '--force', '-o', 'text.gltf']);
  assert.equal(run.status, 0, run.stderr);
  const uri = JSON.parse(readFileSync(join(folder, 'text.gltf'))).buffers[0].uri;
  const resources = uri.startsWith('data:') ? {} : { [uri]: readFileSync(join(folder, uri)) };
  const { bytes } = await bake(readFileSync(join(folder, 'text.gltf')), { resources, name: 'text.gltf', encode: 'exact' });
  assert.equal(JSON.parse(new TextDecoder().decode(bytes)).asset.version, '2.0');
});

test('a transform of glTF-Transform changes what a bake changes, and leaves the rest the same objects', async () => {
  const { chronormal } = await load('gltf-transform.js');
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

test('the command of the README works in the command line of glTF-Transform', async () => {
  const [, config] = readme.match(/```js\n([^`]*onProgramReady[^`]*)```/);
  writeFileSync(join(folder, 'gltf-transform.config.mjs'), config);
  const [, words] = readme.match(/^    gltf-transform (chronormal .*)$/m);
  const cli = fileURLToPath(new URL('node_modules/@gltf-transform/cli/bin/cli.js', import.meta.url));
  const args = words.replaceAll('face', 'bumps').split(' ');
  const run = (words) => spawnSync(process.execPath, [cli, ...words], { cwd: folder, encoding: 'utf8' });
  const { status, stdout, stderr } = run(args);
  assert.equal(status, 0, stdout + stderr);
  const before = await audit(face, { for: ['three'] }), after = await audit(readFileSync(join(folder, 'bumps.right.glb')), { for: ['three'] });
  assert.ok(after.report.mean_degrees < 0.5 * before.report.mean_degrees, `${after.report.mean_degrees}`);
  const wrong = run(args.map((word) => (word === 'three,godot' ? 'four' : word)));
  assert.notEqual(wrong.status, 0);
  assert.match(wrong.stdout + wrong.stderr, /four/);
});

test('paths of Windows are those of the program', async () => {
  const { fromWindows } = await load('paths.js');
  const cwd = 'd:\\work';
  for (const [word, expected] of [
    ['C:\\models\\face.glb', '/C:/models/face.glb'], ['c:/models/face.glb', '/C:/models/face.glb'], ['C:\\', '/C:/'],
    ['models\\face.glb', 'models/face.glb'], ['..\\face.glb', '../face.glb'], ['\\models\\face.glb', '/D:/models/face.glb'],
    ['face.glb', 'face.glb'], ['--json', '--json'], ['-', '-'], ['/dev/stdin', '/dev/stdin'], ['--for=three,godot', '--for=three,godot'],
    ['--drivers=C:\\out\\d.json', '--drivers=/C:/out/d.json'], ['D:\\Grüße\\a b.glb', '/D:/Grüße/a b.glb'], ['C:face.glb', 'C:face.glb'],
    [cwd, '/D:/work'],
  ]) assert.equal(fromWindows(word, cwd), expected, word);
});

test('require() loads the package, or says how it is loaded', () => {
  for (const part of ['', '/three', '/babylon', '/playcanvas', '/gltf-transform']) {
    const script = `try { console.log(typeof require('chronormal${part}')); } catch (error) { console.log(error.message); }`;
    const has = process.features.require_module;
    if (has) assert.equal(node(['--no-warnings', '-e', script]).stdout, 'object\n');
    const { stdout } = node([...(has ? ['--no-experimental-require-module'] : []), '-e', script]);
    assert.equal(stdout, `chronormal is a package of ES modules, which require() loads from Node.js 20.19 and 22.12 on; this Node.js is ${process.versions.node}. \
Use import { bake } from 'chronormal' in a module, or const { bake } = await import('chronormal') anywhere\n`);
    const meanwhile = node([...(has ? ['--no-experimental-require-module'] : []), '-e', `import('chronormal${part}').then((api) => console.log(typeof api))`]);
    assert.equal(meanwhile.stdout, 'object\n', meanwhile.stderr);
  }
});

test('where WebAssembly has no vectors, a sentence says so', (t) => {
  const script = "import('chronormal').then(({ inspect }) => inspect(new Uint8Array(9))).catch(({ message }) => console.log(message));";
  const without = ['--no-enable-sse4-1']; // turns off the vectors of V8 on x86
  const { stdout, status } = node([...without, '-e', script]);
  if (status !== 0 || /glTF/.test(stdout)) return t.skip('this processor has vectors whatever V8 is told');
  assert.match(stdout, /^WebAssembly with vectors \(SIMD\) .*Safari 16\.4, Node\.js 18/s);
  const { stderr } = node([...without, join(installed, 'bin/chronormal.js'), '--version']);
  assert.match(stderr, /^chronormal: WebAssembly with vectors \(SIMD\) [^\n]*\n$/);
});

test('npx chronormal report writes the page of the program', () => {
  const template = join(installed, 'share/chronormal/report.html');
  assert.equal(native(['report', 'bumps.glb', '--template', template, '-o', 'native.html']).status, 0);
  const cwd = join(folder, 'user');
  mkdirSync(cwd);
  writeFileSync(join(cwd, 'package.json'), '{}');
  for (const words of [['npm', 'install', '--offline', '--no-audit', '--no-fund', tarball], ['npx', '--no', 'chronormal', 'report', '../bumps.glb', '-o', 'page.html']]) {
    const { status, stdout, stderr } = spawnSync(words[0], words.slice(1), { cwd, encoding: 'utf8' });
    assert.equal(status, 0, stdout + stderr);
  }
  assert.deepEqual(readFileSync(join(cwd, 'page.html')), readFileSync(join(folder, 'native.html')));
});

test('messages name the kind of a file, and have no long fractions', async () => {
  const picture = readFileSync(join(installed, 'head.png'));
  for (const call of [audit, bake, inspect, compare, sample]) {
    await assert.rejects(call(picture), { name: 'ChronormalError', code: 3, message: 'input.gltf, byte 0: this is a PNG image, not glTF' });
  }
  await assert.rejects(inspect(new TextEncoder().encode('<!DOCTYPE html><p>404')), /an HTML page, not glTF/);
  const { warnings } = await bake(face, { tolerance: 0.1 + 0.2, maxBytes: 100 });
  assert.match(warnings.join(), /0\.3 degrees/);
  assert.doesNotMatch(warnings.join(), /\d\.\d{8}/);
});

test('the picture of the README is found beside the README, in the package and in a checkout', () => {
  const source = new URL('../../js/README.md', import.meta.url), picturesOf = (text) => [...text.matchAll(/!\[[^\]]*\]\(([^)]*)\)/g)].map(([, to]) => to);
  const [there, here] = [picturesOf(readme), picturesOf(readFileSync(source, 'utf8'))];
  assert.ok(here.length >= 1);
  assert.deepEqual(there.map((to) => readFileSync(join(installed, to))), here.map((to) => readFileSync(new URL(to, source))));
});

test('the package says where it is at home', () => {
  const { homepage, repository, bugs, sideEffects } = JSON.parse(readFileSync(join(installed, 'package.json')));
  const home = readFileSync(new URL('../../CMakeLists.txt', import.meta.url), 'utf8').match(/HOMEPAGE_URL (\S+)\)/)[1];
  assert.deepEqual({ homepage, url: repository.url, bugs: bugs.url }, { homepage: `${home}#readme`, url: `git+${home}.git`, bugs: `${home}/issues` });
  assert.ok(sideEffects.every((path) => /worker/.test(path)));
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
