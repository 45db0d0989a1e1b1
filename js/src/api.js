// chronormal in JavaScript: right normals for meshes that deform. Bytes go in, bytes and reports come out; nothing touches a
// file system or the network. index.d.ts has the types.
import { platform } from './platform.js';
import { compile } from './run.js';
import { perform } from './task.js';

/** What the program refused, or could not do: its exit code and its own words, which name the place. */
export class ChronormalError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'ChronormalError';
    this.code = code;
  }
}

// Exit codes of the program: done, and done but not within the tolerance.
const DONE = 0, BEYOND = 4;
const OUTPUTS = 'out';

// What of the options is meant for these functions, and not for the program.
const OWN = new Set(['name', 'resources', 'signal', 'onProgress', 'worker', 'memoryLimit']);

const flagOf = (name) => `--${name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`)}`;

function flagsOf(options) {
  const flags = [];
  for (const [name, value] of Object.entries(options)) {
    if (OWN.has(name) || value === undefined || value === false) continue;
    flags.push(flagOf(name));
    if (value !== true) flags.push(Array.isArray(value) ? value.join(',') : String(value));
  }
  return flags;
}

const bytesOf = (data) => {
  if (data instanceof Uint8Array) return data;
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (ArrayBuffer.isView(data)) return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  throw new TypeError('the input has to be a Uint8Array, an ArrayBuffer or a view of one');
};

// A GLB says so in its first bytes; everything else is JSON.
const nameOf = (bytes) => (bytes[0] === 0x67 && bytes[1] === 0x6c && bytes[2] === 0x54 ? 'input.glb' : 'input.gltf');

// Does a task in a worker, which ends with it: then nothing is left, and it can be stopped in the middle.
async function inWorker(task, { signal, onProgress }) {
  const module = await compile(); // once for all workers
  signal?.throwIfAborted();
  return new Promise((resolve, reject) => {
    const end = (settle, value) => {
      signal?.removeEventListener('abort', stop);
      worker.terminate();
      settle(value);
    };
    const stop = () => end(reject, signal.reason);
    const worker = platform.startWorker(
      ({ progress, done, failed }) => {
        if (progress) onProgress?.(progress);
        else if (done) end(resolve, done);
        else end(reject, new ChronormalError(1, failed));
      },
      (error) => end(reject, error),
    );
    signal?.addEventListener('abort', stop, { once: true });
    worker.postMessage({ task, wantsProgress: onProgress !== undefined, module });
  });
}

async function execute(task, options) {
  options.signal?.throwIfAborted();
  const done = options.worker === false ? await perform(task, options.onProgress) : await inWorker(task, options);
  if (done.code !== DONE && done.code !== BEYOND) {
    throw new ChronormalError(done.code, done.stderr.replace(/^chronormal(?: \w+)?: /, ''));
  }
  return done;
}

function taskOf(command, input, options, more = []) {
  const bytes = bytesOf(input), name = options.name ?? nameOf(bytes);
  const resources = Object.entries(options.resources ?? {}).map(([uri, data]) => [uri, bytesOf(data)]);
  return {
    args: [command, name, '--json', ...more, ...flagsOf(options)],
    files: { ...Object.fromEntries(resources), [name]: bytes },
    outputs: OUTPUTS,
    memoryLimit: options.memoryLimit,
  };
}

const warningsOf = (stderr) => (stderr === '' ? [] : stderr.split('\n'));

// What a bake writes: the same file, or a GLB where the input is a sequence in another format.
const bakedName = (name) => {
  const base = name.split('/').pop();
  return /\.(glb|gltf)$/i.test(base) ? base : `${base}.glb`;
};

/** Writes right normals into a glTF file, or makes one of a sequence, and says how far off they were and are. */
export async function bake(input, options = {}) {
  const base = bakedName(options.name ?? nameOf(bytesOf(input)));
  const done = await execute(taskOf('bake', input, options, ['-o', `${OUTPUTS}/${base}`]), options);
  const { [base]: bytes, ...files } = done.files;
  return { bytes, files, report: JSON.parse(done.stdout), warnings: warningsOf(done.stderr), within: done.code === DONE };
}

async function report(command, input, options) {
  const done = await execute(taskOf(command, input, options), options);
  return { report: JSON.parse(done.stdout), warnings: warningsOf(done.stderr), within: done.code === DONE };
}

/** Says how far off the normals that hosts show are, and where. */
export const audit = (input, options = {}) => report('audit', input, options);

/** Says what is in a file, and what may cause wrong normals. */
export const inspect = (input, options = {}) => report('inspect', input, options);

/** Holds the ways to interpolate normals against each other, on a mesh or a sequence of this file. */
export const compare = (input, options = {}) => report('compare', input, options);
