// Runs the program like a user. CHRONORMAL_PROGRAM is its path.
import { spawnSync } from 'node:child_process';

export function chronormal(...args) {
  const program = process.env.CHRONORMAL_PROGRAM;
  if (!program) throw new Error('CHRONORMAL_PROGRAM must name the program to test: ./test and ctest set it');
  const { status, stdout, stderr, error } = spawnSync(program, args, { encoding: 'utf8', maxBuffer: 1 << 28 });
  if (error) throw error;
  if (status !== 0) throw new Error(`chronormal ${args.join(' ')}: exit code ${status}\n${stderr}`);
  return stdout;
}
