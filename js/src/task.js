// A command on files in memory, as api.js describes it and worker.js or the caller's own thread does it.
import { run } from './run.js';

const FOLDER = '/work';
const BAR = /\r([^\r[]*) \[[= ]*\]\s+(\d+) %/g;

/**
 * @param {{args: string[], files: Object<string, Uint8Array>, outputs: string, memoryLimit?: number}} task the
 *   command line; the files that it finds, by their names; the folder whose files are the result; the most bytes of memory
 * @param {(progress: {label: string, percent: number}) => void} [onProgress]
 * @returns {Promise<{code: number, stdout: string, stderr: string, files: Object<string, Uint8Array>}>}
 */
export async function perform({ args, files, outputs, memoryLimit }, onProgress) {
  const stdout = [], decoder = new TextDecoder();
  let stderr = '';
  const hear = (bytes) => {
    stderr += decoder.decode(bytes, { stream: true });
    for (const [, label, percent] of stderr.matchAll(BAR)) onProgress?.({ label, percent: Number(percent) });
    stderr = stderr.replace(BAR, '').replaceAll('\r\x1b[K', '');
  };
  const { code, result } = await run(args, {
    prepare(FS) {
      FS.mkdir(FOLDER);
      FS.chdir(FOLDER);
      FS.mkdir(outputs);
      for (const [name, bytes] of Object.entries(files)) {
        let folder = '';
        for (const part of name.split('/').slice(0, -1)) {
          folder += `${part}/`;
          if (!FS.analyzePath(folder).exists) FS.mkdir(folder);
        }
        FS.writeFile(name, bytes);
      }
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
  });
  const whole = new Uint8Array(stdout.reduce((size, bytes) => size + bytes.length, 0));
  stdout.reduce((at, bytes) => (whole.set(bytes, at), at + bytes.length), 0);
  return { code, stdout: new TextDecoder().decode(whole), stderr: stderr.trim(), files: result };
}
