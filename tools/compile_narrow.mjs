// Compiles the libraries chronormal and chronormal_io for a 32-bit machine, where std::size_t cannot hold most counts
// that a file can contain, and shows the warnings of the compiler. `./test --full embedding` runs this script. Nothing
// is linked or run, since Debian's libraries are 64-bit.
//
//   node tools/compile_narrow.mjs BUILD      BUILD has compile_commands.json
import { execFile } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { availableParallelism, cpus } from 'node:os';
import { join } from 'node:path';
import { promisify } from 'node:util';

const run = promisify(execFile);
// The commands that compile the sources of chronormal and chronormal_io. Each command compiles one source, or a
// generated file that includes several sources.
const commands = JSON.parse(readFileSync(join(process.argv[2], 'compile_commands.json'), 'utf8')).filter(({ command }) =>
  / -o CMakeFiles\/chronormal(_io)?\.dir\//.test(command),
);
const failed = [];

async function work() {
  for (let next = commands.pop(); next; next = commands.pop()) {
    const { directory, command, file } = next;
    const narrow = command.replace(/ -o \S+ -c /, ' -m32 -msse2 -mfpmath=sse -fsyntax-only ');
    await run('/bin/sh', ['-c', narrow], { cwd: directory }).catch((error) => failed.push(`${file}\n${error.stderr}`));
  }
}

const total = commands.length;
await Promise.all(Array.from({ length: availableParallelism?.() ?? cpus().length }, work));
for (const text of failed) console.error(text);
console.log(`for 32 bits: ${total - failed.length} of ${total} files compile`);
process.exitCode = failed.length > 0 || total === 0 ? 1 : 0;
