// Computes a sequence of keyframes at a moment: the positions of its vertices, the rendered normals of a scheme that
// interpolates between keyframes, the true normals, and the angles between rendered and true normals. All arrays are
// allocated once, and each step fills them.
import { NONE, copy, degreesBetween, normalsOf, unitAt } from './geometry.js';
import { schemeOf } from './schemes.js';

// Returns all numbers of a keyframe, which may store only the vertices that differ from the first keyframe.
function whole(values, first) {
  if (!values.indices) return values;
  const result = first.slice();
  values.indices.forEach((v, n) => result.set(values.values.subarray(3 * n, 3 * n + 3), 3 * v));
  return result;
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
const sum = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const anglesBetween = (a, b) => Math.atan2(Math.hypot(...cross(a, b)), dot(a, b));
const isZero = (a) => a[0] === 0 && a[1] === 0 && a[2] === 0;

function perpendicular(a) {
  const [x, y, z] = a.map(Math.abs), axis = x <= y && x <= z ? [1, 0, 0] : y <= z ? [0, 1, 0] : [0, 0, 1];
  return unitAt(cross(a, axis), 0);
}

// Returns vector v after the smallest rotation that turns one unit vector into another.
function turned(from, to, v) {
  const sine = cross(from, to), cosine = dot(from, to), length = Math.hypot(...sine);
  if (cosine < 0 && length < 1e-12) {
    const across = perpendicular(from);
    return sum(scaled(2 * dot(across, v), across), scaled(-1, v));
  }
  const axis = length > 0 ? scaled(1 / length, sine) : sine;
  return sum(sum(scaled(cosine, v), cross(sine, v)), scaled((1 - cosine) * dot(axis, v), axis));
}

// Returns `direction`, turned by the rotation from the normal of the geometry at a keyframe to the author's stored
// normal, but by at most `allowed` radians.
function offsetBy(geometry, stored, allowed, direction) {
  if (isZero(geometry) || isZero(stored) || allowed === undefined) return direction;
  if (anglesBetween(geometry, stored) <= allowed) return turned(geometry, stored, direction);
  const side = sum(stored, scaled(-dot(geometry, stored), geometry));
  const across = Math.hypot(...side) > 1e-4 ? unitAt(side, 0) : perpendicular(geometry);
  return turned(geometry, sum(scaled(Math.cos(allowed), geometry), scaled(Math.sin(allowed), across)), direction);
}

/**
 * Makes the surface of a sequence.
 * @param part a part of a report, of kind "sequence" or "targets"
 * @returns the arrays that are drawn, as makeSurface() of surface.js returns them, and the function pose(segment, t,
 *   scheme, least), which fills them
 */
export function makeSequence(part) {
  const { vertices: V, elements: E, element, keyframes } = part;
  const first = keyframes.positions[0];
  const positionsOf = (k) => whole(keyframes.positions[k], first);
  const storedOf = (k) => keyframes.normals && whole(keyframes.normals[k], keyframes.normals[0]);
  const computeNormals = normalsOf(part);
  const p = new Float64Array(3 * V), n = new Float64Array(3 * E + 3), sizes = new Float64Array(E + 1);
  const shownOfElement = new Float64Array(3 * E + 3);
  const surface = {
    positions: Float32Array.from(first),
    shown: new Float32Array(3 * V),
    right: new Float32Array(3 * V),
    degrees: new Float32Array(V),
    normals: n,
  };

  function place({ from, to }, t) {
    for (let i = 0; i < 3 * V; ++i) p[i] = (1 - t) * from[i] + t * to[i];
    computeNormals(p, n, sizes);
  }

  // The data of the current segment, and of the current scheme in this segment. The data are computed again when
  // another segment or scheme is shown.
  let segment = {}, fit = {};
  function enter(number) {
    if (segment.number === number) return;
    const [a, b] = [keyframes.segments[2 * number], keyframes.segments[2 * number + 1]];
    segment = { number, from: positionsOf(a), to: positionsOf(b), storedFrom: storedOf(a), storedTo: storedOf(b) };
    fit = {};
  }
  // Returns the unit normals of all elements at t = 0, 1/K, ..., 1, where K is the number of intervals. An element
  // without a normal at t = 0 or 1 gets its normal just inside the segment.
  function unitsAt(intervals) {
    const units = [];
    for (let i = 0; i <= intervals; ++i) {
      place(segment, i / intervals);
      const unit = new Float64Array(3 * E + 3), three = [0, 0, 0];
      for (let e = 0; e < E; ++e) unit.set(unitAt(n, 3 * e, three), 3 * e);
      units.push(unit);
    }
    for (const [end, near] of [[0, 1e-6], [intervals, 1 - 1e-6]]) {
      const unit = units[end], missing = [];
      for (let e = 0; e < E; ++e) if (unit[3 * e] === 0 && unit[3 * e + 1] === 0 && unit[3 * e + 2] === 0) missing.push(e);
      if (missing.length === 0) continue;
      place(segment, near);
      for (const e of missing) unit.set(unitAt(n, 3 * e), 3 * e);
    }
    return units;
  }

  // The largest angle, in radians, that is allowed at each vertex between the author's normal and the normal of the
  // geometry. The allowed angle is the angle in the first keyframe. The array is empty unless each keyframe has its own
  // normals.
  const allowed = new Float64Array(keyframes.normals ? V : 0);
  if (keyframes.normals) {
    enter(0);
    p.set(first);
    computeNormals(p, n, sizes);
    for (let v = 0; v < V; ++v) {
      if (element[v] === NONE) continue;
      const geometry = unitAt(n, 3 * element[v]), stored = unitAt(keyframes.normals[0], 3 * v);
      allowed[v] = isZero(geometry) || isZero(stored) ? NaN : anglesBetween(geometry, stored);
    }
  }

  function judge(t, byElement, ends, least) {
    const { shown, right, degrees } = surface, { storedFrom, storedTo } = segment;
    for (let v = 0, at = 0; v < V; ++v, at += 3) {
      const e = element[v], from = 3 * e;
      if (e === NONE) {
        shown.fill(0, at, at + 3);
        right.fill(0, at, at + 3);
        degrees[v] = -1;
        continue;
      }
      const size = Math.sqrt(n[from] ** 2 + n[from + 1] ** 2 + n[from + 2] ** 2), by = size > 0 ? 1 / size : 0;
      let rx = n[from] * by, ry = n[from + 1] * by, rz = n[from + 2] * by;
      let sx = shownOfElement[from], sy = shownOfElement[from + 1], sz = shownOfElement[from + 2];
      if (ends) {
        const now = [rx, ry, rz], most = Number.isNaN(allowed[v]) ? undefined : allowed[v];
        const a = unitAt(storedFrom, at), b = unitAt(storedTo, at);
        const begin = offsetBy(unitAt(ends[0], from), a, most, now), end = offsetBy(unitAt(ends[1], from), b, most, now);
        const between = unitAt(sum(scaled(1 - t, begin), scaled(t, end)), 0);
        if (!isZero(between)) [rx, ry, rz] = between;
        if (!byElement) [sx, sy, sz] = unitAt(sum(scaled(1 - t, a), scaled(t, b)), 0);
      }
      shown[at] = sx;
      shown[at + 1] = sy;
      shown[at + 2] = sz;
      right[at] = rx;
      right[at + 1] = ry;
      right[at + 2] = rz;
      const limit = least && e < least.length ? least[e] : 0, unlit = sx === 0 && sy === 0 && sz === 0;
      if (unlit && sizes[e] > limit) degrees[v] = 180;
      else if (!(size > limit)) degrees[v] = -1;
      else degrees[v] = degreesBetween(shown[at], shown[at + 1], shown[at + 2], rx, ry, rz);
    }
  }

  /** Fills all arrays for a moment. `scheme` is a name in schemes.js. If the keyframes store normals, the scheme linear
   * interpolates the stored normals. */
  surface.pose = (number, t, scheme, least) => {
    enter(number);
    const { intervals, evaluate } = schemeOf(scheme);
    if (fit.scheme !== scheme) fit = { scheme, units: unitsAt(intervals), ends: keyframes.normals ? unitsAt(1) : undefined };
    place(segment, t);
    copy(p, surface.positions);
    evaluate(fit.units, t, shownOfElement, n);
    judge(t, scheme !== 'linear', fit.ends, least);
  };
  return surface;
}
