// Computes true normals from positions. True normals are the cross products of faces, summed over the corners that
// share a normal (docs/theory.md, sections 1, 8 and 9), with the offsets and polygons of a file's author
// (docs/formats.md). All arithmetic is in double, and a step allocates no memory.

/** The number in place of an element for a vertex that has no element: a vertex of a flat primitive, or a vertex
 * without a face. */
export const NONE = 0xffffffff;

// A sum is treated as zero if its length is below this share of the sum of the lengths of its terms. Terms that cancel
// leave only a rounding error, which has no meaningful direction.
const ROUNDING = 1e-13;

// For each weighting, a function that returns the factor by which the vector area n of a face counts at one of its
// corners. e and f are the edges at the corner. `area` is |n|, `dot` is e.f, `sine` the length of e x f, and `squares`
// the product of e.e and f.f.
const WEIGHTS = {
  area: () => 1,
  uniform: (area) => 1 / area,
  angle: (area, dot, sine) => Math.atan2(sine, dot) / area,
  'area-angle': (area, dot, sine) => Math.atan2(sine, dot),
  'inverse-edges': (area, dot, sine, squares) => 1 / (Math.sqrt(squares) * area),
  'inverse-roots': (area, dot, sine, squares) => 1 / (Math.sqrt(Math.sqrt(squares)) * area),
};

// Returns the polygons from which the triangles were made. Consecutive triangles of one face are the fan of its
// polygon.
function cornersOfFaces(triangles, faces) {
  const offsets = [0], corners = [];
  for (let t = 0; t < faces.length; ++t) {
    if (t > 0 && faces[t] === faces[t - 1]) {
      corners.push(triangles[3 * t + 2]);
    } else {
      if (t > 0) offsets.push(corners.length);
      corners.push(triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2]);
    }
  }
  if (faces.length > 0) offsets.push(corners.length);
  return { offsets: Uint32Array.from(offsets), corners: Uint32Array.from(corners) };
}

// Adds the area-weighted terms of all triangles to `normals`, and the largest absolute component of each term to
// `sizes`. Most of the time of a step is spent here.
function addAreas({ triangles }, slots, p, normals, sizes) {
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ax = p[a], ay = p[a + 1], az = p[a + 2];
    const ex = p[b] - ax, ey = p[b + 1] - ay, ez = p[b + 2] - az, fx = p[c] - ax, fy = p[c + 1] - ay, fz = p[c + 2] - az;
    const x = ey * fz - ez * fy, y = ez * fx - ex * fz, z = ex * fy - ey * fx;
    const size = Math.max(Math.abs(x), Math.abs(y), Math.abs(z));
    for (let i = t; i < t + 3; ++i) {
      const e = slots[i], at = 3 * e;
      normals[at] += x;
      normals[at + 1] += y;
      normals[at + 2] += z;
      sizes[e] += size;
    }
  }
}

// Adds the weighted terms of all polygons, for weightings other than area and for faces with more than three corners.
// `slots` has the element of each corner. If `starts` is given, corner c has several elements, from slots[starts[c]] to
// slots[starts[c + 1]].
function addWeighted({ offsets, corners }, { starts, slots }, weighting, p, normals, sizes) {
  const weightOf = WEIGHTS[weighting];
  for (let f = 0; f + 1 < offsets.length; ++f) {
    const first = offsets[f], end = offsets[f + 1], o = 3 * corners[first];
    let x = 0, y = 0, z = 0;
    for (let i = first + 1; i + 1 < end; ++i) {
      const b = 3 * corners[i], c = 3 * corners[i + 1];
      const ex = p[b] - p[o], ey = p[b + 1] - p[o + 1], ez = p[b + 2] - p[o + 2];
      const fx = p[c] - p[o], fy = p[c + 1] - p[o + 1], fz = p[c + 2] - p[o + 2];
      x += ey * fz - ez * fy;
      y += ez * fx - ex * fz;
      z += ex * fy - ey * fx;
    }
    const area = Math.sqrt(x * x + y * y + z * z);
    if (area === 0) continue;
    for (let i = first; i < end; ++i) {
      const h = 3 * corners[i], b = 3 * corners[i + 1 < end ? i + 1 : first], c = 3 * corners[i > first ? i - 1 : end - 1];
      const ex = p[b] - p[h], ey = p[b + 1] - p[h + 1], ez = p[b + 2] - p[h + 2];
      const fx = p[c] - p[h], fy = p[c + 1] - p[h + 1], fz = p[c + 2] - p[h + 2];
      const cx = ey * fz - ez * fy, cy = ez * fx - ex * fz, cz = ex * fy - ey * fx;
      let tx = x, ty = y, tz = z, weight;
      const squares = (ex * ex + ey * ey + ez * ez) * (fx * fx + fy * fy + fz * fz);
      if (weighting === 'max') {
        if (squares === 0) continue;
        (tx = cx), (ty = cy), (tz = cz), (weight = 1 / squares);
      } else {
        weight = weightOf(area, ex * fx + ey * fy + ez * fz, Math.sqrt(cx * cx + cy * cy + cz * cz), squares);
        if (weight === Infinity) continue; // an edge at the corner has length zero
      }
      tx *= weight;
      ty *= weight;
      tz *= weight;
      const size = Math.max(Math.abs(tx), Math.abs(ty), Math.abs(tz));
      for (let s = starts ? starts[i] : i, last = starts ? starts[i + 1] : i + 1; s < last; ++s) {
        const e = slots[s], at = 3 * e;
        normals[at] += tx;
        normals[at + 1] += ty;
        normals[at + 2] += tz;
        sizes[e] += size;
      }
    }
  }
}

// Lists the elements to which each corner contributes. `terms` are pairs of a corner and an element. Without `terms`, a
// corner contributes to the element of its vertex.
function elementsOfCorners({ element, elements, triangles, backs }, corners, terms) {
  if (!terms) {
    const slots = Uint32Array.from(corners, (v) => (element[v] === NONE ? elements : element[v]));
    if (corners === triangles && backs) for (const corner of backs) slots[corner] = elements;
    return { slots };
  }
  const starts = new Uint32Array(corners.length + 1);
  for (let i = 0; i < terms.length; i += 2) ++starts[terms[i] + 1];
  for (let i = 0; i < corners.length; ++i) starts[i + 1] += starts[i];
  return { starts, slots: Uint32Array.from({ length: terms.length / 2 }, (_, i) => terms[2 * i + 1]) };
}

/**
 * Returns a function that sums face normals over elements.
 * @param part a part of a report
 * @param sums the `truth` of the part, to sum the author's polygons; by default the triangles are summed
 * @returns {(positions: Float64Array, normals: Float64Array, sizes: Float64Array) => void} writes the sum n of each element, not
 *   normalised, and the sum of the sizes of its terms, which bounds the rounding error; both arrays have one more element, for
 *   corners without an element
 */
export function normalsOf(part, { polygons: given, terms } = {}) {
  const { triangles, faces, elements, weighting } = part;
  const polygons = given ? { offsets: given.first, corners: given.corners } : faces ? cornersOfFaces(triangles, faces) : undefined;
  const corners = polygons?.corners ?? triangles, counted = elementsOfCorners(part, corners, terms);
  const simple = weighting === 'area' && !polygons;
  const { offsets } = polygons ?? { offsets: simple ? undefined : Uint32Array.from({ length: triangles.length / 3 + 1 }, (_, t) => 3 * t) };
  return (positions, normals, sizes) => {
    normals.fill(0);
    sizes.fill(0);
    if (simple) addAreas(part, counted.slots, positions, normals, sizes);
    else addWeighted({ offsets, corners }, counted, weighting, positions, normals, sizes);
    for (let e = 0, at = 0; e < elements; ++e, at += 3) {
      const most = Math.max(Math.abs(normals[at]), Math.abs(normals[at + 1]), Math.abs(normals[at + 2]));
      if (!(most > ROUNDING * sizes[e])) normals[at] = normals[at + 1] = normals[at + 2] = 0;
    }
  };
}

// Returns a function that rotates the sums of some elements as an author has rotated the normals of a file by hand. The
// author's rotations are relative to the surface, and move with it.
function offsetsOf({ elements, sides, first, edges, references, turned, base, targets }) {
  const now = new Float64Array(base.length);
  return (p, weights, normals) => {
    copy(base, now);
    for (let k = 0; k < targets.length; ++k) {
      const { indices, changes } = targets[k], w = weights[k];
      for (let i = 0; w !== 0 && i < indices.length; ++i) {
        now[2 * indices[i]] += w * changes[2 * i];
        now[2 * indices[i] + 1] += w * changes[2 * i + 1];
      }
    }
    for (let f = 0, t = -6; f < elements.length; ++f) {
      const at = 3 * elements[f], isTurned = references[f] === NONE;
      if (isTurned) t += 6;
      const size = Math.sqrt(normals[at] ** 2 + normals[at + 1] ** 2 + normals[at + 2] ** 2), scale = sides[f] / size;
      if (size === 0) continue;
      const zx = scale * normals[at], zy = scale * normals[at + 1], zz = scale * normals[at + 2];
      // The next lines compute the average angle between the edges and the normal z, and the direction in which the
      // reference edge leaves the vertex.
      let angles = 0, count = 0, xx = 0, xy = 0, xz = 0;
      for (let i = first[f]; i < first[f + 1]; ++i) {
        const a = 3 * edges[2 * i], b = 3 * edges[2 * i + 1], ex = p[b] - p[a], ey = p[b + 1] - p[a + 1], ez = p[b + 2] - p[a + 2];
        const along = ex * zx + ey * zy + ez * zz, cx = ey * zz - ez * zy, cy = ez * zx - ex * zz, cz = ex * zy - ey * zx;
        if (ex === 0 && ey === 0 && ez === 0) continue;
        angles += Math.atan2(Math.sqrt(cx * cx + cy * cy + cz * cz), along);
        ++count;
        if (i - first[f] === references[f]) {
          xx = ex - along * zx;
          xy = ey - along * zy;
          xz = ez - along * zz;
        }
      }
      if (isTurned) {
        // Applies the smallest rotation from the normal z in the base to the current z. If the two directions are
        // opposite, the rotation is by 180 degrees about a perpendicular axis.
        const bx = turned[t], by = turned[t + 1], bz = turned[t + 2], ux = turned[t + 3], uy = turned[t + 4], uz = turned[t + 5];
        const sx = by * zz - bz * zy, sy = bz * zx - bx * zz, sz = bx * zy - by * zx, cosine = bx * zx + by * zy + bz * zz;
        const along = cosine > -1 + 1e-12 ? (sx * ux + sy * uy + sz * uz) / (1 + cosine) : 0;
        xx = cosine * ux + sy * uz - sz * uy + along * sx;
        xy = cosine * uy + sz * ux - sx * uz + along * sy;
        xz = cosine * uz + sx * uy - sy * ux + along * sz;
      }
      const length = Math.sqrt(xx * xx + xy * xy + xz * xz), ox = now[2 * f], oy = now[2 * f + 1], offset = Math.sqrt(ox * ox + oy * oy);
      const alpha = length > 0 ? Math.min(offset * (angles > 0 ? angles / count : 1), Math.PI / 2) : 0;
      const cosine = size * Math.cos(alpha), sine = offset > 0 && length > 0 ? (size * Math.sin(alpha)) / (offset * length) : 0;
      normals[at] = cosine * zx + sine * (ox * xx + oy * (zy * xz - zz * xy));
      normals[at + 1] = cosine * zy + sine * (ox * xy + oy * (zz * xx - zx * xz));
      normals[at + 2] = cosine * zz + sine * (ox * xz + oy * (zx * xy - zy * xx));
    }
  };
}

/**
 * Returns a function that computes the true normals of a part that has `truth`. True normals are the normals that the
 * author of the file sees.
 * @param part a part of a report on a glTF file
 * @returns {(positions: Float64Array, weights: ArrayLike<number>, normals: Float64Array, right: Float64Array) => void}
 *   writes the true normal of each element into `right`. An element without a true normal gets its vector from
 *   `normals`, the result of normalsOf(part)
 */
export function truthOf(part) {
  const { truth, elements } = part;
  const addUp = truth.polygons ? normalsOf(part, truth) : undefined, sizes = new Float64Array(elements + 1);
  const addOffsets = truth.offsets ? offsetsOf(truth.offsets) : undefined;
  return (positions, weights, normals, right) => {
    if (addUp) addUp(positions, right, sizes);
    else copy(normals, right);
    addOffsets?.(positions, weights, right);
    for (let at = 0; at < right.length; at += 3) {
      if (right[at] !== 0 || right[at + 1] !== 0 || right[at + 2] !== 0) continue;
      for (let c = at; c < at + 3; ++c) right[c] = normals[c];
    }
  };
}

/** Copies an array of numbers. This loop is always fast, while set() of typed arrays is five times slower if the types
 * of the arrays differ. */
export function copy(from, to) {
  for (let i = 0; i < from.length; ++i) to[i] = from[i];
}

/** Returns the unit vector of three numbers that begin at index `at`, or the zero vector if they are all 0. */
export function unitAt(array, at, result = [0, 0, 0]) {
  const length = Math.hypot(array[at], array[at + 1], array[at + 2]);
  for (let c = 0; c < 3; ++c) result[c] = length > 0 ? array[at + c] / length : 0;
  return result;
}

/** Returns the angle between two vectors, in degrees. */
export function degreesBetween(ax, ay, az, bx, by, bz) {
  const x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
  return (Math.atan2(Math.sqrt(x * x + y * y + z * z), ax * bx + ay * by + az * bz) * 180) / Math.PI;
}
