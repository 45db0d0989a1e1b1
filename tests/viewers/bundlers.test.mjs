// Tests the npm package as users bundle it. An application of a few lines audits a GLB file in Chromium, with and
// without a worker. Vite, webpack, esbuild and rollup bundle the application as js/README.md says, with the package as
// npm packs it. The application is also used without a bundler.
//
//   CHRONORMAL_PROGRAM=build/release/chronormal CHRONORMAL_NPM=build/wasm-test/package node --test
//   tests/viewers/bundlers.test.mjs
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, readFileSync, readdirSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { launch, serveFolder } from './browser.mjs';
import { install } from './installed.mjs';

const { folder, installed, remove, native } = install();
const readme = readFileSync(join(installed, 'README.md'), 'utf8');
const ofViewers = (path) => fileURLToPath(new URL(`node_modules/${path}`, import.meta.url));

assert.equal(native(['convert', '--sample', 'bumps', '-o', 'bumps.glb']).status, 0);
const face = readFileSync(join(folder, 'bumps.glb'));
const expected = JSON.parse(native(['audit', 'bumps.glb', '--for', 'three', '--json']).stdout);

const APP = `
import { audit, bake, ChronormalError } from 'chronormal';

async function use() {
  const input = new Uint8Array(await (await fetch('/bumps.glb')).arrayBuffer());
  const said = [];
  for (const worker of [true, false]) {
    const { report } = await audit(input, { name: 'bumps.glb', for: 'three', worker });
    const refused = await bake(input.slice(0, 40), { worker }).catch((error) => error);
    said.push({ report, refused: refused instanceof ChronormalError ? refused.code : String(refused) });
  }
  return said;
}
use().catch((error) => String(error.stack ?? error)).then((said) => {
  document.body.textContent = JSON.stringify(said);
  document.body.dataset.ready = 'true';
});
`;
const HTML = '<!doctype html><title>app</title><link rel="icon" href="data:,"><body><script type="module" src="/app.js"></script>';

let browser;
before(async () => {
  browser = await launch();
});
after(async () => {
  await browser.close();
  remove();
});

// Makes a folder for an application, and installs the package in it.
function makeApp(name, files = {}) {
  const root = join(folder, name), modules = join(root, 'node_modules');
  cpSync(installed, join(modules, 'chronormal'), { recursive: true });
  symlinkSync(ofViewers('@rollup'), join(modules, '@rollup'));
  for (const [path, text] of Object.entries({ 'package.json': '{ "type": "module" }', 'app.js': APP, 'index.html': HTML, 'bumps.glb': face, ...files })) writeFileSync(join(root, path), text);
  return root;
}

// Opens the page at an address and returns the results of the audits that it shows. The page may load files only from
// its own server.
async function saidAt(address) {
  const page = await browser.newPage(), faults = [];
  page.on('console', (message) => ['error', 'warn'].includes(message.type()) && faults.push(message.text()));
  const broken = new Promise((_, reject) => page.on('pageerror', reject));
  await page.goto(address);
  await Promise.race([broken, page.waitForSelector('[data-ready]', { timeout: 120_000 })]);
  const said = JSON.parse(await page.evaluate(() => document.body.textContent));
  assert.deepEqual(faults, []);
  await page.close();
  return said;
}

async function assertAudits(address) {
  const said = await saidAt(address);
  assert.equal(typeof said, 'object', said);
  assert.deepEqual(said, [true, false].map(() => ({ report: expected, refused: 3 })));
}

async function assertAuditsIn(served) {
  const { address, close } = await serveFolder(served);
  try {
    await assertAudits(address);
  } finally {
    await close();
  }
}

// Adds to the output folder of a bundler the files that the page needs besides scripts.
function complete(made) {
  writeFileSync(join(made, 'index.html'), HTML);
  writeFileSync(join(made, 'bumps.glb'), face);
  return made;
}

// Writes the settings that the README shows for a bundler into a folder. Returns the settings.
async function settings(root, name) {
  const code = [...readme.matchAll(/```js\n([^`]*)```/g)].map(([, text]) => text).find((text) => text.startsWith(`// ${name}\n`));
  assert.ok(code, `no ${name} in the README`);
  writeFileSync(join(root, name), code);
  return (await import(pathToFileURL(join(root, name)))).default;
}

test('Vite builds it', async () => {
  const { build } = await import('vite'), root = makeApp('vite');
  await build({ root, configFile: false, logLevel: 'error', build: { outDir: 'made' } });
  writeFileSync(join(root, 'made/bumps.glb'), face);
  await assertAuditsIn(join(root, 'made'));
});

test('the server of Vite serves it', async () => {
  const { createServer } = await import('vite'), root = makeApp('vite-serves');
  await settings(root, 'vite.config.js');
  const server = await createServer({ root, logLevel: 'error', server: { port: 0, host: '127.0.0.1', hmr: false, watch: null } });
  try {
    await server.listen();
    await assertAudits(`http://127.0.0.1:${server.httpServer.address().port}/`);
  } finally {
    await server.close();
  }
});

test('webpack builds it, without a warning', async () => {
  const { default: webpack } = await import('webpack'), root = makeApp('webpack');
  for (const mode of ['production', 'development']) {
    const path = join(root, mode);
    const stats = await new Promise((resolve, reject) => {
      webpack({ mode, context: root, entry: './app.js', output: { path, filename: 'app.js' }, performance: false }, (error, done) => (error ? reject(error) : resolve(done)));
    });
    assert.equal(stats.hasErrors() || stats.hasWarnings(), false, stats.toString());
    await assertAuditsIn(complete(path));
  }
});

test('esbuild builds it by the command of the README', async () => {
  const root = makeApp('esbuild');
  const [, words] = readme.match(/^esbuild (.*)$/m);
  const { status, stderr } = spawnSync(process.execPath, [ofViewers('esbuild/bin/esbuild'), ...words.split(' ')], { cwd: root, encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  assert.doesNotMatch(stderr, /warning/i);
  await assertAuditsIn(complete(join(root, words.match(/--outdir=(\S+)/)[1])));
});

test('rollup builds it by the settings of the README', async () => {
  const { rollup } = await import('rollup'), root = makeApp('rollup');
  const { output, ...input } = await settings(root, 'rollup.config.js');
  const cwd = process.cwd();
  process.chdir(root);
  try {
    const bundle = await rollup({ ...input, onwarn: (warning) => assert.fail(warning.message) });
    await bundle.write(output);
  } finally {
    process.chdir(cwd);
  }
  await assertAuditsIn(complete(join(root, output.dir)));
});

test('a page imports the package as it is, by an import map', async () => {
  const map = { imports: { chronormal: '/node_modules/chronormal/src/index.js' } };
  const root = makeApp('plain', { 'index.html': HTML.replace('<body>', `<script type="importmap">${JSON.stringify(map)}</script><body>`) });
  await assertAuditsIn(root);
});

test('where a worker or the program is not beside a bundle, that is said', async () => {
  const { build } = await import('esbuild');
  for (const [entries, missing] of [[{ app: 'app.js' }, 'program.wasm'], [{ app: 'app.js', program: 'chronormal/program.wasm' }, 'worker.js']]) {
    const root = makeApp(`without-${missing}`);
    await build({ absWorkingDir: root, entryPoints: entries, bundle: true, format: 'esm', loader: { '.wasm': 'copy' }, outdir: 'made', logLevel: 'error' });
    for (const fallback of [undefined, HTML]) {
      const { address, close } = await serveFolder(complete(join(root, 'made')), fallback);
      const page = await browser.newPage();
      await page.goto(address);
      await page.waitForSelector('[data-ready]');
      assert.match(await page.evaluate(() => document.body.textContent), new RegExp(`${missing.replace('.', '\\.')}.*README`));
      await page.close();
      await close();
    }
  }
});

test('bundlers leave out what is not used: no module but those of workers has a side effect', async () => {
  const { build } = await import('esbuild');
  const root = makeApp('unused', { 'app.js': readdirSync(join(installed, 'src')).filter((name) => /^(api|drive|error|index|options|run|task|three|babylon|playcanvas)\.js$/.test(name))
    .map((name) => `import './node_modules/chronormal/src/${name}';`).join('\n') });
  const { outputFiles, warnings } = await build({ absWorkingDir: root, entryPoints: ['app.js'], bundle: true, format: 'esm', write: false, logLevel: 'silent' });
  assert.equal(outputFiles[0].text.replace(/\/\/.*|\s|\(\(\)=>\{\}\)\(\);/g, ''), '', outputFiles[0].text);
  assert.ok(warnings.length > 5);
});
