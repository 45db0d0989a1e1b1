// Runs the program with the files and the terminal of this machine.
import { existsSync, readdirSync, readSync, writeSync } from 'node:fs';
import { Buffer } from 'node:buffer';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { fromWindows } from './paths.js';
import * as node from './platform.node.js';
import { run } from './run.js';

const isWindows = process.platform === 'win32';
const inside = (path) => (isWindows ? fromWindows(path, process.cwd()) : path);

// Makes the top-level folders of this machine visible to the program under the same names.
function mount(FS, NODEFS) {
  const roots = isWindows
    ? [...'ABCDEFGHIJKLMNOPQRSTUVWXYZ'].map((letter) => `${letter}:`).filter((drive) => existsSync(`${drive}\\`))
    : readdirSync('/').filter((name) => !['dev', 'proc', 'sys'].includes(name));
  for (const name of roots) {
    const folder = `/${name}`;
    try {
      if (!FS.analyzePath(folder).exists) FS.mkdir(folder);
      FS.mount(NODEFS, { root: isWindows ? `${name}\\` : folder }, folder);
    } catch {
      // The root cannot be mounted, because it is not a folder, but a file or a dangling link.
    }
  }
  // The program looks for share/chronormal/report.html beside its own file, whose path it reads from the link
  // /proc/self/exe.
  FS.symlink(inside(fileURLToPath(new URL('../bin/chronormal.js', import.meta.url))), '/proc/self/exe');
  FS.chdir(inside(process.cwd()));
}

const writeAll = (stream) => (bytes) => {
  for (let at = 0; at < bytes.length; ) {
    try {
      at += writeSync(stream, bytes, at);
    } catch (error) {
      if (error.code === 'EPIPE') return; // the reader has closed the pipe
      if (error.code !== 'EAGAIN') throw error;
    }
  }
};

// Returns the content of the standard input, if the command line refers to it, and undefined otherwise.
function standardInput(args) {
  if (!args.some((word) => word === '-' || word === '/dev/stdin')) return undefined;
  const pieces = [], piece = Buffer.alloc(65536);
  for (;;) {
    try {
      const count = readSync(0, piece, 0, piece.length, null);
      if (count === 0) break;
      pieces.push(Buffer.from(piece.subarray(0, count)));
    } catch (error) {
      if (error.code === 'EOF') break;
      if (error.code !== 'EAGAIN') throw error;
    }
  }
  return new Uint8Array(Buffer.concat(pieces));
}

/** Runs the program with the arguments `args`, and returns the exit code of the program. */
export async function main(args) {
  const { stdout, stderr, env } = process;
  const columns = stdout.columns ?? stderr.columns;
  const { code } = await run(node, args.map(inside), {
    prepare: mount,
    stdout: writeAll(1),
    stderr: writeAll(2),
    stdin: standardInput(args),
    terminals: { stdout: stdout.isTTY, stderr: stderr.isTTY },
    env: { ...env, ...(columns && !env.COLUMNS ? { COLUMNS: String(columns) } : {}) },
  });
  return code;
}
