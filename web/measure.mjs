// Measures how long a step of a slider takes in the code of the page, without the drawing.
//
//   chronormal report FACE.glb -o face.bin --no-plan && node web/measure.mjs face.bin
//
// Moves each target alone, while all others keep the weights that they have at the worst moment. Then plays the first
// animation.
import { readFileSync } from 'node:fs';
import { readContainer } from './src/data.js';
import { makePlayer } from './src/player.js';

const player = makePlayer(readContainer(readFileSync(process.argv[2])), () => {});
player.choosePart(0);
const { part } = player;
const count = (n) => n.toLocaleString('en');
console.log(`${part.name}: ${count(part.vertices)} vertices, ${count(part.triangles.length / 3)} triangles, ${part.targets?.length ?? 0} targets, by ${part.weighting}`);

// Prints processor time as well as elapsed time, since elapsed time grows when other programs use the machine.
function measure(what, steps, step) {
  for (let i = 0; i < 50; ++i) step(i % steps);
  const before = process.cpuUsage();
  const times = Array.from({ length: 200 }, (_, i) => {
    const begin = performance.now();
    step(i % steps);
    return performance.now() - begin;
  }).sort((a, b) => a - b);
  const { user, system } = process.cpuUsage(before);
  const clock = `on the clock median ${times[100].toFixed(2)} ms, 9 of 10 below ${times[180].toFixed(2)} ms`;
  console.log(`${what}: ${((user + system) / 200_000).toFixed(2)} ms of a processor; ${clock}`);
}

for (const [i, motion] of part.motions.entries()) {
  if (motion.kind === 'target') continue;
  player.chooseMotion(i);
  measure(`played: ${motion.name || motion.kind}`, motion.at.length, (at) => player.go(at));
  break;
}
if (part.targets) {
  measure('a slider, all other weights as they were', part.targets.length, (k) => player.setWeight(k, Math.random()));
  player.rest();
  measure('a slider, all other weights 0', 100, (i) => player.setWeight(0, i / 100));
}
