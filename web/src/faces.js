// Finds the faces of a part: their numbers, their corners, and the straight paths on which they move. This file draws
// nothing.
import { segmentAt } from './motions.js';

/** Returns the face to which a triangle of a part belongs, as {number, triangle, corners}. The triangles of a face form
 * a fan, and `triangle` is the index of the first triangle. */
export function faceOf({ triangles, faces }, triangle) {
  let first = triangle, end = triangle + 1;
  const isSame = (t) => faces && faces[t] === faces[triangle];
  while (first > 0 && isSame(first - 1)) --first;
  while (3 * end < triangles.length && isSame(end)) ++end;
  const corners = [...triangles.subarray(3 * first, 3 * first + 3)];
  for (let t = first + 1; t < end; ++t) corners.push(triangles[3 * t + 2]);
  return { number: faces ? faces[first] : first, triangle: first, corners };
}

/** Returns the face with a number, or undefined if the part has no such face. */
export function faceOfNumber(part, number) {
  const triangle = part.faces ? part.faces.indexOf(number) : number;
  return Number.isInteger(number) && triangle >= 0 && 3 * triangle < part.triangles.length ? faceOf(part, triangle) : undefined;
}

const vectorAt = (array, v) => [array[3 * v], array[3 * v + 1], array[3 * v + 2]];

// Returns the position of vertex v at keyframe k. Later keyframes may store only the vertices that differ from the
// first keyframe.
function keyframeAt(keyframes, k, v) {
  const keyframe = keyframes.positions[k];
  if (ArrayBuffer.isView(keyframe)) return vectorAt(keyframe, v);
  const i = keyframe.indices ? keyframe.indices.indexOf(v) : v;
  return i < 0 ? vectorAt(keyframes.positions[0], v) : vectorAt(keyframe.values, i);
}

function blendedAt({ positions, targets }, weights, v) {
  const at = vectorAt(positions, v);
  targets.forEach(({ indices, positions: deltas }, k) => {
    const i = indices ? indices.indexOf(v) : v;
    if (i >= 0 && weights[k] !== 0) for (let c = 0; c < 3; ++c) at[c] += weights[k] * deltas[3 * i + c];
  });
  return at;
}

/**
 * Returns the straight path of a face at the moment that a player shows. In a sequence, the path goes through the
 * current segment. In a glTF file, the path goes from the base to the pose of the moment, or to weight 1 of a target.
 * @returns {{from: number[][], to: number[][], t: number, segment: number, words: string}}
 */
export function wayOf(player, { corners }) {
  const { part, motion, at, weights, byHand } = player;
  if (part.keyframes) {
    const [segment, t] = segmentAt(motion, at), { keyframes } = part;
    const [a, b] = [keyframes.segments[2 * segment], keyframes.segments[2 * segment + 1]];
    const ends = [a, b].map((k) => corners.map((v) => keyframeAt(keyframes, k, v)));
    return { from: ends[0], to: ends[1], t, segment, words: `from keyframe ${keyframes.numbers[a]} to keyframe ${keyframes.numbers[b]}` };
  }
  const isWeighed = !byHand && motion && !motion.seconds, whole = Array.from(weights);
  if (isWeighed) {
    const { targets, values } = motion.weights[0], last = (motion.at.length - 1) * targets.length;
    whole.fill(0);
    targets.forEach((k, i) => (whole[k] = values[last + i]));
  }
  const from = corners.map((v) => vectorAt(part.positions, v)), to = corners.map((v) => blendedAt(part, whole, v));
  const words = isWeighed ? 'from the base to weight 1' : 'from the base to this moment';
  return { from, to, t: isWeighed ? player.value() : 1, segment: 0, words };
}

const objOf = (corners) => `${corners.map((p) => `v ${p.join(' ')}`).join('\n')}\nf ${corners.map((_, i) => i + 1).join(' ')}\n`;

/** Returns the words of the command line that computes the figures of a face on its path, and the files that the
 * command reads. */
export function commandOf({ from, to }, schemes, samples) {
  const bytes = (corners) => new TextEncoder().encode(objOf(corners));
  return {
    args: ['compare', 'from.obj', 'to.obj', '--face', '0', '--schemes', schemes.join(','), '--samples', String(samples), '--json', '-q'],
    files: { 'from.obj': bytes(from), 'to.obj': bytes(to) },
  };
}
