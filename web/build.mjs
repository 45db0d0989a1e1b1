// Makes the pages, each as one file that contains everything.
//
//   node web/build.mjs report OUT.html              the page of a report, without data (docs/artists.md)
//   node web/build.mjs page PACKAGE OUT.html        the page with the engine inside; PACKAGE is the npm package with the wasm module
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

const source = (name) => fileURLToPath(new URL(`src/${name}`, import.meta.url));

async function bundled(entry, options = {}) {
  const { outputFiles } = await build({
    entryPoints: [entry],
    bundle: true,
    minify: true,
    format: 'iife',
    target: ['es2022'],
    legalComments: 'none',
    write: false,
    logLevel: 'error',
    ...options,
  });
  return outputFiles[0].text;
}

const styles = () => [readFileSync(fileURLToPath(import.meta.resolve('uplot/dist/uPlot.min.css')), 'utf8'), readFileSync(source('style.css'), 'utf8')].join('\n');

// Escapes text so that it cannot end the element <script> or <style> that contains it.
const inScript = (text) => text.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');

// Replaces the marks of a template by texts. The texts are inserted literally: "$" has no special meaning.
const filled = (template, parts) => Object.entries(parts).reduce((page, [mark, text]) => page.replace(mark, () => text), template);

// Returns the licence of a library. The page ends with a comment that contains the licences of all its libraries.
const licenceOf = (name) => readFileSync(join(dirname(fileURLToPath(import.meta.resolve(name))), '..', 'LICENSE'), 'utf8');
function licences(more = {}) {
  const own = readFileSync(fileURLToPath(new URL('../LICENSE', import.meta.url)), 'utf8');
  const texts = { chronormal: own, three: licenceOf('three'), uPlot: licenceOf('uplot'), ...more };
  const whole = Object.entries(texts).map(([name, text]) => `${name}\n\n${text.trim()}`).join('\n\n\n');
  return `<!--\n${whole.replaceAll('--', '- -')}\n-->\n`;
}

async function reportPage() {
  const script = await bundled(source('report.js'));
  return filled(readFileSync(source('report.html'), 'utf8'), { '/*style*/': styles(), '/*script*/': inScript(script) }) + licences();
}

// Returns a page that contains the wasm module, and the script of its worker as text. The page starts the worker from
// this text.
async function enginePage(folder) {
  const wasm = gzipSync(readFileSync(join(folder, 'src/program.wasm')), { level: 9 });
  const program = { name: 'program', setup: (made) => made.onResolve({ filter: /\/program\.js$/ }, () => ({ path: join(resolve(folder), 'src/program.js') })) };
  // run.js looks for the module beside its own address. In the page, the module is passed to run.js instead, so any
  // valid address will do.
  const define = { 'import.meta.url': '"file:///engine/src/run.js"' };
  const worker = await bundled(source('engine_worker.js'), { plugins: [program], external: ['fs', 'path', 'crypto'], define });
  const script = await bundled(source('page.js'), { define: { ENGINE_WORKER: JSON.stringify(worker) } });
  return filled(readFileSync(source('page.html'), 'utf8'), {
    '/*style*/': styles(),
    '/*script*/': inScript(script),
    '/*wasm*/': wasm.toString('base64'),
  }) + licences(Object.fromEntries(readdirSync(join(folder, 'THIRD_PARTY')).map((name) => [name, readFileSync(join(folder, 'THIRD_PARTY', name), 'utf8')])));
}

const [kind, ...rest] = process.argv.slice(2), out = rest.at(-1);
if (!(kind === 'report' && rest.length === 1) && !(kind === 'page' && rest.length === 2)) {
  console.error('usage: node web/build.mjs report OUT.html | page PACKAGE OUT.html');
  process.exit(2);
}
const page = kind === 'report' ? await reportPage() : await enginePage(rest[0]);
mkdirSync(dirname(resolve(out)), { recursive: true });
writeFileSync(out, page);
console.log(`${out}: ${page.length.toLocaleString('en')} bytes`);
