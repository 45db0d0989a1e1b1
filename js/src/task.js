// Runs a command on files in memory, for the functions of api.js. The code runs in worker.js or in the caller's own
// thread.
import { run } from './run.js';

const FOLDER = '/work';
const USAGE = 2; // the exit code of the program for a wrong call
// The last line of a message about a wrong call. It names a command line, which a caller of a function does not have.
const TRY = /(^|\n)Try: chronormal[^\n]* --help$/;
const BAR = /\r([^\r[]*) \[[= ]*\]\s+(\d+) %/g;

class UnusableName extends Error {}

// Writes a file under its name, which may contain folders.
function write(FS, name, bytes) {
  try {
    let folder = '';
    for (const part of name.split('/').slice(0, -1)) {
      folder += `${part}/`;
      if (!FS.analyzePath(folder).exists) FS.mkdir(folder);
    }
    FS.writeFile(name, bytes);
  } catch (error) {
    if (!(error instanceof FS.ErrnoError)) throw error;
    throw new UnusableName(name);
  }
  // A name cannot be used if it cannot be written in UTF-8, contains the zero character that ends names in the program,
  // or names a device.
  const known = new TextDecoder().decode(new TextEncoder().encode(name));
  if (known !== name || name.includes('\0') || !FS.isFile(FS.stat(name).mode)) throw new UnusableName(name);
}

/**
 * Runs a command of the program on files in memory.
 * @param {typeof import('./platform.browser.js')} platform the platform on which this code runs
 * @param {{args: string[], files: Object<string, Uint8Array>, outputs: string, memoryLimit?: number}} task the
 *   command line; the files that the program finds, by their names; the folder whose files are the result; the limit of
 *   memory in bytes
 * @param {(progress: {label: string, percent: number}) => void} [onProgress]
 * @returns {Promise<{code: number, stdout: string, stderr: string, files: Object<string, Uint8Array>}>}
 */
export async function perform(platform, { args, files, outputs, memoryLimit }, onProgress) {
  const stdout = [], decoder = new TextDecoder();
  let stderr = '';
  const hear = (bytes) => {
    stderr += decoder.decode(bytes, { stream: true });
    for (const [, label, percent] of stderr.matchAll(BAR)) onProgress?.({ label, percent: Number(percent) });
    stderr = stderr.replace(BAR, '').replaceAll('\r\x1b[K', '');
  };
  const world = {
    prepare(FS) {
      FS.mkdir(FOLDER);
      FS.chdir(FOLDER);
      FS.mkdir(outputs);
      for (const [name, bytes] of Object.entries(files)) write(FS, name, bytes);
    },
    finish(FS) {
      const made = {};
      const collect = (folder, prefix) => {
        for (const name of FS.readdir(folder)) {
          if (name === '.' || name === '..') continue;
          const path = `${folder}/${name}`;
          if (FS.isDir(FS.stat(path).mode)) collect(path, `${prefix}${name}/`);
          else made[prefix + name] = FS.readFile(path);
        }
      };
      collect(`${FOLDER}/${outputs}`, '');
      return made;
    },
    stdout: (bytes) => stdout.push(bytes),
    stderr: hear,
    terminals: { stderr: onProgress !== undefined },
    memoryLimit,
    env: { NO_COLOR: '1', COLUMNS: '80', TERM: 'xterm', HOME: '/', LANG: 'C.UTF-8' },
  };
  let ended;
  try {
    ended = await run(platform, args, world);
  } catch (error) {
    if (!(error instanceof UnusableName)) throw error;
    return { code: USAGE, stdout: '', stderr: `${JSON.stringify(error.message)}: this text cannot be the name of a file; give another name`, files: {} };
  }
  const whole = new Uint8Array(stdout.reduce((size, bytes) => size + bytes.length, 0));
  stdout.reduce((at, bytes) => (whole.set(bytes, at), at + bytes.length), 0);
  return { code: ended.code, stdout: new TextDecoder().decode(whole), stderr: stderr.trim().replace(TRY, ''), files: ended.result };
}
