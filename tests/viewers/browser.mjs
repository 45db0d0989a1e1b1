// Runs headless Chromium with the page of page.mjs. The page can load only the files that are passed to serve().
// Requests for other files are refused.
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';
import puppeteer from 'puppeteer-core';

const ADDRESS = 'http://chronormal.invalid/';
const CHROMIUM = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

// The page of the tests. The script filament.js defines the global variable `Filament`, which loads a wasm module when
// it starts.
const HTML = `<!doctype html><title>chronormal</title><link rel="icon" href="data:,">
<script src="filament.js"></script><script src="page.js"></script>`;

const ofFilament = (name) => readFileSync(fileURLToPath(new URL(`node_modules/filament/${name}`, import.meta.url)));

function serve(page, files) {
  page.on('request', (request) => {
    const url = request.url();
    const file = url.startsWith(ADDRESS) && files[url.slice(ADDRESS.length)];
    if (file) request.respond(file);
    else if (/^(data|blob):/.test(url)) request.continue();
    else request.abort();
  });
  return page.setRequestInterception(true);
}

export function launch() {
  const executablePath = process.env.CHRONORMAL_CHROMIUM ?? CHROMIUM.find((path) => existsSync(path));
  if (!executablePath) throw new Error('Chromium was not found (Debian: chromium); CHRONORMAL_CHROMIUM names another');
  return puppeteer.launch({
    executablePath,
    headless: true,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
    protocolTimeout: 300_000,
  });
}

const TYPES = { '/': 'text/html', js: 'text/javascript', html: 'text/html', wasm: 'application/wasm' };

// Starts a server on this machine. body(path) returns the content of the file at a path, or nothing.
async function listen(body) {
  const server = createServer(({ url }, response) => {
    const found = body(url.slice(1));
    response.writeHead(found ? 200 : 404, { 'content-type': TYPES[url.split('.').at(-1)] ?? 'application/octet-stream' });
    response.end(found);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { address: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}

/** Serves a folder whose page is index.html. If `fallback` is given, the server returns it for all paths that do not
 * exist, as some servers do. */
export function serveFolder(folder, fallback) {
  return listen((path) => {
    const file = join(folder, path === '' ? 'index.html' : path);
    return existsSync(file) ? readFileSync(file) : fallback;
  });
}

// Opens a page on a server on this machine. `contents` maps a name to a folder, whose files are served, or to the
// content of a file.
export async function openFolder(contents) {
  const { address, close: stop } = await listen((path) => {
    const [first, ...rest] = path.split('/'), found = contents[first];
    return typeof found === 'string' && rest.length > 0 ? readFileSync(join(found, ...rest)) : found;
  });
  const browser = await launch(), page = await browser.newPage();
  await page.goto(`${address}page.html`);
  const close = async () => {
    await browser.close();
    stop();
  };
  return { page, close };
}

export async function openPage() {
  const bundle = await build({
    entryPoints: [fileURLToPath(new URL('page.mjs', import.meta.url))],
    bundle: true,
    format: 'iife',
    write: false,
    logLevel: 'error',
  });
  const browser = await launch();
  const page = await browser.newPage();
  const faults = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') faults.push(message.text());
  });
  const script = (body) => ({ contentType: 'text/javascript', body });
  await serve(page, {
    '': { contentType: 'text/html', body: HTML },
    'page.js': script(Buffer.from(bundle.outputFiles[0].contents)),
    'filament.js': script(ofFilament('filament.js')),
    'filament.wasm': { contentType: 'application/wasm', body: ofFilament('filament.wasm') },
  });
  await page.goto(ADDRESS);
  return { page, faults, close: () => browser.close() };
}
