// Defines the functions of the package: audit, inspect, compare, bake and sample. The functions take bytes, return
// bytes and reports, and touch neither a file system nor the network. index.d.ts has the types.
import { ChronormalError } from './error.js';
import { readNpy } from './npy.js';
import { flagsOf } from './options.js';
import { compile } from './run.js';
import { perform } from './task.js';

// The exit codes of the program for success, and for a result that exceeds the tolerance.
const DONE = 0, BEYOND = 4;

const bytesOf = (data) => {
  if (data instanceof Uint8Array) return data;
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (ArrayBuffer.isView(data)) return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  throw new TypeError('the input must be a Uint8Array, an ArrayBuffer or a view of an ArrayBuffer');
};

// Returns a name for an input that has no name. A GLB is recognised by its first bytes, and other bytes are taken for
// JSON.
const nameOf = (bytes) => (bytes[0] === 0x67 && bytes[1] === 0x6c && bytes[2] === 0x54 ? 'input.glb' : 'input.gltf');

// Performs a task in a worker. The worker ends with the task, which frees its memory, and can be stopped at any time.
// The memory of the input files moves to the worker and is not copied.
async function inWorker(platform, task, { signal, onProgress }) {
  const module = await compile(platform); // compiled once for all workers
  signal?.throwIfAborted();
  return new Promise((resolve, reject) => {
    const end = (settle, value) => {
      signal?.removeEventListener('abort', stop);
      worker.terminate();
      settle(value);
    };
    const stop = () => end(reject, signal.reason);
    // Calls work(). If work() throws an error, the promise of the caller is rejected with this error, because nobody
    // else catches errors of an event handler.
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

// Adds to the message about a missing file how a call names this file. The program looks for files in its folder, which
// a caller does not see.
const withRemedy = (line) => line.replace(/(: this file is missing: )(?:\.\/)?(.+)$/, (_, words, name) =>
  `${words}${name}; give its bytes in the option resources: { ${JSON.stringify(name)}: bytes }`);

// Returns the message of an error: the lines of the program without its name, each line once.
const messageOf = (stderr) => [...new Set(stderr.split('\n').map((line) => withRemedy(line.replace(/^chronormal(?: \w+)?: /, ''))))].join('\n');

async function execute(platform, task, options) {
  options.signal?.throwIfAborted();
  const done = await (options.worker === false ? perform(platform, task, options.onProgress) : inWorker(platform, task, options));
  if (done.code !== DONE && done.code !== BEYOND) {
    throw new ChronormalError(done.code, messageOf(done.stderr));
  }
  return done;
}

// Returns the task of a command. The inputs are copied, so the caller may change them during the call. more(folder)
// returns the arguments that ask for outputs in this folder.
function taskOf(command, input, options, more = () => ['--json']) {
  const flags = flagsOf(command, options);
  const copyOf = (data) => new Uint8Array(bytesOf(data));
  const bytes = copyOf(input), name = options.name ?? nameOf(bytes);
  const resources = Object.entries(options.resources ?? {}).map(([uri, data]) => [uri, copyOf(data)]);
  const files = { ...Object.fromEntries(resources), [name]: bytes };
  const folders = new Set(Object.keys(files).flatMap((path) => path.split('/')));
  let outputs = 'out';
  while (folders.has(outputs)) outputs += '_';
  return {
    // Without ./ in front, the program would take "-" for the standard input, and a name in brackets for a list.
    args: [command, ...more(outputs), ...flags, '--', /^(-|\[.*\])$/s.test(name) ? `./${name}` : name],
    files,
    outputs,
    memoryLimit: options.memoryLimit,
  };
}

const warningsOf = (stderr) => (stderr === '' ? [] : stderr.split('\n'));

const resultOf = ({ stdout, stderr, code }) => ({ report: JSON.parse(stdout), warnings: warningsOf(stderr), within: code === DONE });

// Returns the name of a baked file: the name of the input, with .glb added if the input is a sequence in another
// format.
const bakedName = (name) => {
  const base = name.split('/').pop();
  return /\.(glb|gltf)$/i.test(base) ? base : `${base}.glb`;
};

/**
 * Returns the functions of the package for a platform, which is platform.browser.js or platform.node.js. index.js and
 * index.node.js each import their own platform, so that neither module loads the code of the other platform. No module
 * has a side effect.
 */
export function apiOf(platform) {
  const report = (command) => async (input, options = {}) => resultOf(await execute(platform, taskOf(command, input, options), options));
  return {
    audit: report('audit'),
    inspect: report('inspect'),
    compare: report('compare'),
    async bake(input, options = {}) {
      const base = bakedName(String(options?.name ?? nameOf(bytesOf(input))));
      const done = await execute(platform, taskOf('bake', input, options, (outputs) => ['--json', '-o', `${outputs}/${base}`]), options);
      const { [base]: bytes, ...files } = done.files;
      return { bytes, files, ...resultOf(done) };
    },
    async sample(input, options = {}) {
      const task = taskOf('sample', input, options, (outputs) => ['-o', `${outputs}/normals.npy`]);
      const { files, stderr } = await execute(platform, task, options);
      const { numbers, shape } = readNpy(files['normals.npy']);
      // Leaves out the line with the name of the file inside the program, which says nothing to the caller.
      return { normals: numbers, shape, warnings: warningsOf(stderr).filter((line) => !line.startsWith(`-> ${task.outputs}/`)) };
    },
  };
}
