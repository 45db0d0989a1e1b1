// Runs the program once. Each run makes a fresh module, with files in memory or with the files of this machine. A run
// therefore never sees the state of an earlier run, even if that run crashed.
import createProgram from './program.js';

// The smallest WebAssembly module that uses vectors and exceptions, both of which the program needs. A runtime that
// lacks vectors or exceptions says that this module is invalid.
const NEEDED = [0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 10, 13, 1, 11, 0, 6, 64, 65, 0, 253, 17, 26, 25, 11, 11];
const TOO_OLD = 'WebAssembly with vectors (SIMD) and exceptions is missing here: chronormal needs Chrome or Edge 95, Firefox 100, Safari 16.4, \
Node.js 18, or later, on a processor that has vectors';

let compiled; // promise of the compiled module, which all runs share

/** Lets all runs in this thread use a module that another thread has compiled. */
export function useCompiled(module) {
  compiled ??= Promise.resolve(module);
}

async function compileWith(platform) {
  if (!WebAssembly.validate(new Uint8Array(NEEDED))) throw new Error(TOO_OLD);
  const url = new URL('./program.wasm', import.meta.url), bytes = await platform.read(url);
  if (!WebAssembly.validate(bytes.subarray(0, 8))) {
    throw new Error(`${url} is not a WebAssembly module; copy program.wasm from the package to the folder of your script, as the README of the package describes`);
  }
  return WebAssembly.compile(bytes);
}

/**
 * Compiles the program, unless it is already compiled. A short run spends most of its time on compiling.
 * @returns {Promise<WebAssembly.Module>}
 */
export function compile(platform) {
  if (!compiled) {
    compiled = compileWith(platform);
    compiled.catch(() => { compiled = undefined; }); // the next call tries again
  }
  return compiled;
}

// The number of bytes after which output is passed on. Output to a terminal is also passed on at the end of each line
// and of each progress bar.
const PIECE = 65536;

class Sink {
  constructor(write, byLine) {
    this.write = write;
    this.byLine = byLine;
    this.bytes = new Uint8Array(PIECE);
    this.count = 0;
  }
  put(byte) {
    this.bytes[this.count++] = byte;
    // Byte 10 is a line feed, and byte 37 is the "%" that ends a progress bar.
    if (this.count === PIECE || (this.byLine && (byte === 10 || byte === 37))) this.flush();
  }
  flush() {
    if (this.count > 0) this.write(this.bytes.slice(0, this.count));
    this.count = 0;
  }
}

/**
 * Runs the program.
 * @param {typeof import('./platform.browser.js')} platform the platform on which this code runs
 * @param {string[]} args the command line, without the name of the program
 * @param {object} world the environment of the program:
 *   prepare(FS, NODEFS)   puts files into the program's file system before it starts
 *   finish(FS)            takes files out of the file system after the end; the return value becomes `result`
 *   stdout, stderr        functions that get the output as pieces of bytes (Uint8Array)
 *   terminals             {stdout, stderr}: true for each of them that is a terminal
 *   stdin                 the content of standard input (Uint8Array)
 *   env                   variables of the environment
 *   memoryLimit           the limit of the program's memory in bytes, at least 16 MiB
 * @returns {Promise<{code: number, result: any}>} the exit code, and the value that finish() returned
 */
export async function run(platform, args, { prepare, finish, stdout, stderr, terminals = {}, stdin, env = {}, memoryLimit }) {
  const module = await compile(platform);
  const out = new Sink(stdout, terminals.stdout), err = new Sink(stderr, terminals.stderr);
  let code = 1;
  // The promise of a module that cannot start never settles. Every error before the start, including an error of
  // prepare(), therefore rejects this outer promise.
  const program = await new Promise((resolve, reject) => createProgram({
    require: platform.require,
    thisProgram: 'chronormal',
    memoryLimit,
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(module, imports).then(done).catch(reject);
      return {};
    },
    preRun: [
      ({ ENV, FS, NODEFS }) => {
        for (const name of Object.keys(ENV)) delete ENV[name];
        Object.assign(ENV, env);
        FS.init(() => null, (byte) => out.put(byte), (byte) => err.put(byte));
        if (stdin) {
          // The program would read a device until its end, which may never come. The content of standard input is
          // therefore put into a file, whose end is known.
          FS.close(FS.getStream(0));
          FS.writeFile('/.stdin', stdin);
          FS.open('/.stdin', 'r');
        }
        prepare(FS, NODEFS);
      },
    ],
    quit(status, error) {
      code = status;
      throw error;
    },
    print: (text) => stdout(new TextEncoder().encode(`${text}\n`)),
    printErr: (text) => stderr(new TextEncoder().encode(`${text}\n`)),
  }).then(resolve, reject));
  for (const [stream, isTerminal] of [[1, terminals.stdout], [2, terminals.stderr]]) {
    if (isTerminal) program.FS.getStream(stream).tty = true;
  }
  try {
    code = program.callMain(args) ?? code;
  } finally {
    out.flush();
    err.flush();
  }
  return { code, result: finish?.(program.FS) };
}
