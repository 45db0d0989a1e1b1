// Runs the program inside the page. Each command runs in its own worker, which can be stopped at any time.
import { fromBase64, unzipped } from './data.js';

const DONE = 0, BEYOND = 4; // exit codes for success, and for a result that exceeds the tolerance
const OUTPUTS = 'out';

/** An error of the program, with its exit code and its message. */
export class EngineError extends Error {
  constructor(code, message) {
    super(message);
    this.code = code;
  }
}

/**
 * Makes the engine of the page: a function that runs commands of the program.
 * @param {HTMLElement} element contains the wasm module, packed by gzip and encoded as base64
 * @param {string} workerSource the script of engine_worker.js
 */
export function makeEngine(element, workerSource) {
  const address = URL.createObjectURL(new Blob([workerSource], { type: 'text/javascript' }));
  let module;
  const compile = () => (module ??= unzipped(fromBase64(element.textContent)).then((bytes) => WebAssembly.compile(bytes)));

  /**
   * Runs a command. Files are {name: Uint8Array}. The result contains all files that the command writes below out/.
   * @returns {Promise<{code: number, stdout: string, stderr: string, files: Object<string, Uint8Array>}>}
   */
  return async function run(args, files, { signal, onProgress }) {
    const compiled = await compile();
    signal.throwIfAborted();
    const done = await new Promise((resolve, reject) => {
      const worker = new Worker(address);
      const end = (settle, value) => {
        signal.removeEventListener('abort', stop);
        worker.terminate();
        settle(value);
      };
      const stop = () => end(reject, signal.reason);
      worker.onmessage = ({ data: { progress, done: result, failed } }) => {
        if (progress) onProgress(progress);
        else if (result) end(resolve, result);
        else end(reject, new EngineError(1, failed));
      };
      worker.onerror = (event) => end(reject, new EngineError(1, event.message ?? 'the program could not be started in this browser; use a newer browser'));
      signal.addEventListener('abort', stop, { once: true });
      worker.postMessage({ task: { args, files, outputs: OUTPUTS }, wantsProgress: true, module: compiled });
    });
    if (done.code !== DONE && done.code !== BEYOND) throw new EngineError(done.code, done.stderr.replaceAll(/^chronormal \w+: /gm, ''));
    return done;
  };
}
