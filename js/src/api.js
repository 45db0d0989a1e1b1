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

// Does a task in a worker, which ends with it: then nothing is left, and it can be stopped in the middle. The worker gets the
// files themselves, and no copies.
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
    // Rejects with what is thrown here, where no caller could catch it.
    const guarded = (work) => {
      try {
        work();
      } catch (error) {
        end(reject, error);
      }
    };
    const worker = platform.startWorker(
      ({ progress, done, failed }) => {
        if (progress) guarded(() => onProgress?.(progress));
        else if (done) end(resolve, done);
        else end(reject, new ChronormalError(1, failed));
      },
      (error) => end(reject, error),
    );
    signal?.addEventListener('abort', stop, { once: true });
    const files = Object.values(task.files).map((bytes) => bytes.buffer);
    guarded(() => worker.postMessage({ task, wantsProgress: onProgress !== undefined, module }, files));
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

// Takes copies of what is read, so that the caller may change it while the call goes on. `more` makes further arguments of
// the folder for what is written.
function taskOf(command, input, options, more = () => []) {
  const copyOf = (data) => new Uint8Array(bytesOf(data));
  const bytes = copyOf(input), name = options.name ?? nameOf(bytes);
  if (typeof name !== 'string') throw new TypeError('name: it has to be a string');
  const resources = Object.entries(options.resources ?? {}).map(([uri, data]) => [uri, copyOf(data)]);
  const files = { ...Object.fromEntries(resources), [name]: bytes };
  const folders = new Set(Object.keys(files).flatMap((path) => path.split('/')));
  let outputs = 'out';
  while (folders.has(outputs)) outputs += '_';
  return {
    // A single "-" would be standard input, and what stands in brackets a list.
    args: [command, '--json', ...more(outputs), ...flagsOf(options), '--', /^(-|\[.*\])$/s.test(name) ? `./${name}` : name],
    files,
    outputs,
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
  const base = bakedName(String(options.name ?? nameOf(bytesOf(input))));
  const done = await execute(taskOf('bake', input, options, (outputs) => ['-o', `${outputs}/${base}`]), options);
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
