// Computes a mesh with morph targets at given weights: the positions of its vertices, the normals that a viewer
// renders, the true normals, and the angles between rendered and true normals (docs/viewers.md). All arrays are
// allocated once, and each step fills them.
import { NONE, copy, degreesBetween, normalsOf, truthOf } from './geometry.js';

// The largest float32. A normal with a larger component cannot be lit.
const MOST = 3.4028234663852886e38;

// Returns the deltas of all targets in the order of the vertices. The deltas of vertex v are from offsets[v] to
// offsets[v + 1], each with its target. Summing a vertex in registers takes a quarter of the time of adding target
// after target.
function byVertex(targets, member, vertices) {
  const isMoved = (values, n) => values[n] !== 0 || values[n + 1] !== 0 || values[n + 2] !== 0;
  const offsets = new Uint32Array(vertices + 1);
  const walk = (visit) => targets.forEach((target, k) => {
    const values = target[member], { indices } = target;
    for (let n = 0; n < values.length; n += 3) if (isMoved(values, n)) visit(indices ? indices[n / 3] : n / 3, k, values, n);
  });
  walk((v) => ++offsets[v + 1]);
  for (let v = 0; v < vertices; ++v) offsets[v + 1] += offsets[v];
  const next = offsets.slice(), of = new Uint16Array(offsets[vertices]), deltas = new Float32Array(3 * offsets[vertices]);
  walk((v, k, values, n) => {
    const at = next[v]++;
    of[at] = k;
    deltas[3 * at] = values[n];
    deltas[3 * at + 1] = values[n + 1];
    deltas[3 * at + 2] = values[n + 2];
  });
  return { offsets, of, deltas };
}

// Adds the weighted deltas to the base, or to zero if there is no base, in double.
function addUp(base, { offsets, of, deltas }, weights, sums) {
  for (let v = 0, at = 0; v + 1 < offsets.length; ++v, at += 3) {
    let x = 0, y = 0, z = 0;
    if (base !== null) {
      x = base[at];
      y = base[at + 1];
      z = base[at + 2];
    }
    for (let i = offsets[v], end = offsets[v + 1], from = 3 * i; i < end; ++i, from += 3) {
      const w = weights[of[i]];
      x += w * deltas[from];
      y += w * deltas[from + 1];
      z += w * deltas[from + 2];
    }
    sums[at] = x;
    sums[at + 1] = y;
    sums[at + 2] = z;
  }
}

// Returns the nearest 16-bit float. Values in the middle between two such floats are rounded away from zero.
function half(value) {
  if (value === 0 || !Number.isFinite(value)) return value;
  const step = 2 ** Math.max(Math.floor(Math.log2(Math.abs(value))) - 10, -24);
  return Math.sign(value) * Math.floor(Math.abs(value) / step + 0.5) * step;
}

// Returns, for each vertex, the smallest rotation from the true normal of the base to the stored normal, as four
// numbers: its axis, whose length is the sine of the angle, and the cosine of the angle. If the angle is above 90
// degrees, the axis belongs to the rotation to the negated stored normal, and the cosine is negative.
function turnsOf({ element, normals }, base) {
  const turns = new Float64Array(4 * element.length);
  for (let v = 0; v < element.length; ++v) {
    turns[4 * v + 3] = 1;
    if (element[v] === NONE || !normals) continue;
    const e = 3 * element[v], n = Math.hypot(base[e], base[e + 1], base[e + 2]);
    const m = Math.hypot(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]);
    if (n === 0 || m === 0) continue;
    const ax = base[e] / n, ay = base[e + 1] / n, az = base[e + 2] / n;
    const bx = normals[3 * v] / m, by = normals[3 * v + 1] / m, bz = normals[3 * v + 2] / m;
    const along = ax * bx + ay * by + az * bz, side = along < 0 ? -1 : 1;
    turns.set([side * (ay * bz - az * by), side * (az * bx - ax * bz), side * (ax * by - ay * bx), along], 4 * v);
  }
  return turns;
}

// Returns a flag for each vertex that tells whether its normal is judged. A normal is judged if some target moves the
// surface around the vertex or changes the normal.
function judgedVertices({ vertices, triangles, element, elements, truth }, moved, shown) {
  const has = ({ offsets }, v) => offsets[v] < offsets[v + 1];
  const elementMoves = new Uint8Array(elements), judged = new Uint8Array(vertices);
  for (let t = 0; t < triangles.length; t += 3) {
    if (!has(moved, triangles[t]) && !has(moved, triangles[t + 1]) && !has(moved, triangles[t + 2])) continue;
    for (let i = t; i < t + 3; ++i) if (element[triangles[i]] !== NONE) elementMoves[element[triangles[i]]] = 1;
  }
  if (truth?.polygons) {
    const { first, corners } = truth.polygons, moves = new Uint8Array(corners.length);
    for (let f = 0; f + 1 < first.length; ++f) if (corners.subarray(first[f], first[f + 1]).some((v) => has(moved, v))) moves.fill(1, first[f], first[f + 1]);
    const move = (c, e) => moves[c] === 1 && e !== NONE && (elementMoves[e] = 1);
    if (truth.terms) for (let i = 0; i < truth.terms.length; i += 2) move(truth.terms[i], truth.terms[i + 1]);
    else corners.forEach((v, c) => move(c, element[v]));
  }
  for (const { indices } of truth?.offsets?.targets ?? []) for (const f of indices) elementMoves[truth.offsets.elements[f]] = 1;
  for (let v = 0; v < vertices; ++v) {
    judged[v] = element[v] !== NONE && (elementMoves[element[v]] === 1 || shown.some(({ targets }) => has(targets, v))) ? 1 : 0;
  }
  return judged;
}

/** Writes the weight of each target at a place of a motion. `at` is the index of a sample; between two samples, weights
 * are linear. */
export function weightsAt(motion, viewer, at, result) {
  const track = motion.weights.find(({ viewers }) => viewers.includes(viewer)) ?? motion.weights[0];
  const count = track.targets.length, from = Math.min(Math.floor(at), motion.at.length - 1), to = Math.min(from + 1, motion.at.length - 1);
  const t = at - from;
  result.fill(0);
  for (let k = 0; k < count; ++k) {
    const first = track.values[from * count + k];
    result[track.targets[k]] = t === 0 ? first : first + t * (track.values[to * count + k] - first);
  }
  return result;
}

/**
 * Makes the surface of a part.
 * @param part a part of a report, of kind "gltf"
 * @returns the arrays that are drawn, and the function pose(weights, viewer, least), which fills them. The arrays are
 *   positions, rendered normals (`shown`) and true normals (`right`), all (V x 3, float32), and the errors in degrees
 *   (V), which are -1 for vertices that are not judged. A vertex is not judged if its true normal is at most as long as
 *   `least` says for its element. The weights are those that this viewer plays, and the true normals are computed
 *   from the same weights
 */
export function makeSurface(part) {
  const { vertices: V, elements: E, element } = part;
  const moved = byVertex(part.targets, 'positions', V);
  const shownBy = part.shown.map((entry) => ({ ...entry, targets: byVertex(entry.targets, 'deltas', V) }));
  const judged = judgedVertices(part, moved, shownBy);
  const computeNormals = normalsOf(part), computeTruth = part.truth ? truthOf(part) : undefined;
  const p = new Float64Array(3 * V), sums = new Float64Array(3 * V), kept = new Float64Array(part.targets.length);
  // The sums over triangles show if an element has a normal. The direction of the normal comes from `truth`.
  const n = new Float64Array(3 * E + 3), r = computeTruth ? new Float64Array(3 * E + 3) : n, sizes = new Float64Array(E + 1);
  p.set(part.positions);
  computeNormals(p, n, sizes);
  computeTruth?.(p, kept, n, r);
  const turns = turnsOf(part, r);
  const surface = {
    positions: Float32Array.from(part.positions),
    shown: new Float32Array(3 * V),
    right: new Float32Array(3 * V),
    degrees: new Float32Array(V),
    normals: n,
  };

  function judge({ normals: base, halves }, least) {
    const { shown, right, degrees } = surface;
    for (let v = 0, at = 0; v < V; ++v, at += 3) {
      let sx = sums[at], sy = sums[at + 1], sz = sums[at + 2];
      if (halves) {
        sx = base[at] + half(sx);
        sy = base[at + 1] + half(sy);
        sz = base[at + 2] + half(sz);
      }
      const length = Math.sqrt(sx * sx + sy * sy + sz * sz);
      const unlit = !(length > 1e-30) || !(Math.max(Math.abs(sx), Math.abs(sy), Math.abs(sz)) <= MOST);
      const scale = unlit ? 0 : 1 / length;
      sx = shown[at] = unlit ? 0 : sx * scale;
      sy = shown[at + 1] = unlit ? 0 : sy * scale;
      sz = shown[at + 2] = unlit ? 0 : sz * scale;
      const e = element[v];
      if (e === NONE) {
        right[at] = sx;
        right[at + 1] = sy;
        right[at + 2] = sz;
        degrees[v] = -1;
        continue;
      }
      const size = Math.sqrt(n[3 * e] ** 2 + n[3 * e + 1] ** 2 + n[3 * e + 2] ** 2);
      const x = r[3 * e], y = r[3 * e + 1], z = r[3 * e + 2], by = 1 / (Math.sqrt(x * x + y * y + z * z) || 1);
      const ux = x * by, uy = y * by, uz = z * by;
      const ax = turns[4 * v], ay = turns[4 * v + 1], az = turns[4 * v + 2], signed = turns[4 * v + 3];
      const cosine = Math.abs(signed), side = signed < 0 ? -1 : 1, along = (ax * ux + ay * uy + az * uz) / (1 + cosine);
      const rx = side * (cosine * ux + ay * uz - az * uy + along * ax);
      const ry = side * (cosine * uy + az * ux - ax * uz + along * ay);
      const rz = side * (cosine * uz + ax * uy - ay * ux + along * az);
      right[at] = rx;
      right[at + 1] = ry;
      right[at + 2] = rz;
      const limit = least && e < least.length ? least[e] : 0;
      if (!judged[v]) degrees[v] = 0;
      // If weights are NaN or infinite, the sizes are NaN or infinite too. The rendered normal cannot be lit then, so
      // this condition also holds for a size that is NaN.
      else if (unlit && !(sizes[e] <= limit)) degrees[v] = 180;
      else if (!(size > limit)) degrees[v] = -1;
      else degrees[v] = degreesBetween(Math.fround(sx), Math.fround(sy), Math.fround(sz), rx, ry, rz);
    }
  }

  surface.pose = (weights, viewer, least) => {
    const entry = shownBy.find(({ viewers }) => viewers.includes(viewer)) ?? shownBy[0];
    for (let k = 0; k < kept.length; ++k) kept[k] = Math.abs(weights[k]) <= entry.least_weight ? 0 : weights[k];
    addUp(part.positions, moved, kept, p);
    copy(p, surface.positions);
    computeNormals(p, n, sizes);
    computeTruth?.(p, kept, n, r);
    addUp(entry.halves ? null : entry.normals, entry.targets, kept, sums);
    judge(entry, least);
  };
  return surface;
}
