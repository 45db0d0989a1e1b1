// Runs the program as a user does. CHRONORMAL_PROGRAM is the path of the program.
import { spawnSync } from 'node:child_process';

export function chronormal(...args) {
  const program = process.env.CHRONORMAL_PROGRAM;
  if (!program) throw new Error('CHRONORMAL_PROGRAM must name the program to test: ./test and ctest set it');
  const { status, stdout, stderr, error } = spawnSync(program, args, { encoding: 'utf8', maxBuffer: 1 << 28 });
  if (error) throw error;
  if (status !== 0) throw new Error(`chronormal ${args.join(' ')}: exit code ${status}\n${stderr}`);
  return stdout;
}
