// Draws random numbers and directions, which for the same seed are the same on every machine.
import { length } from './exact.mjs';

// Returns a function that draws numbers from 0 to 1 by the algorithm mulberry32.
export function randomNumbers(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

// Draws a unit vector whose z is at least leastZ.
export function randomDirection(random, leastZ = -1) {
  for (;;) {
    const v = [0, 1, 2].map(() => 2 * random() - 1);
    const size = length(v);
    if (size > 0.1 && size < 1 && v[2] >= leastZ * size) return v.map((c) => c / size);
  }
}
