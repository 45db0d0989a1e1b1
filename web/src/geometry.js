// Right normals from positions: the cross products of faces, added up over those who share a normal (docs/theory.md, sections 1,
// 8 and 9). Everything is double, and nothing is allocated in a step.

/** No element: a vertex of a flat primitive, or one without a face. */
export const NONE = 0xffffffff;

// What is left of terms that cancel is their rounding, and no direction.
const ROUNDING = 1e-13;

// What a corner adds where the vector area of its face is n: n itself times the result. dot is e.f of its edges; ee and ff are
// their squares, and area is |n|.
const WEIGHTS = {
  area: () => 1,
  uniform: (area) => 1 / area,
  angle: (area, dot, sine) => Math.atan2(sine, dot) / area,
  'area-angle': (area, dot, sine) => Math.atan2(sine, dot),
};

// Polygons: the triangles of one face follow each other as its fan.
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

// Adds the terms of all triangles by area, which is most of the time of a step.
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

// The same by another weighting, and of polygons. slots has the element of each corner.
function addWeighted({ offsets, corners }, slots, weighting, p, normals, sizes) {
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
      if (weighting === 'max') {
        const squares = (ex * ex + ey * ey + ez * ez) * (fx * fx + fy * fy + fz * fz);
        if (squares === 0) continue;
        (tx = cx), (ty = cy), (tz = cz), (weight = 1 / squares);
      } else {
        weight = weightOf(area, ex * fx + ey * fy + ez * fz, Math.sqrt(cx * cx + cy * cy + cz * cz));
      }
      const e = slots[i], at = 3 * e;
      tx *= weight;
      ty *= weight;
      tz *= weight;
      normals[at] += tx;
      normals[at + 1] += ty;
      normals[at + 2] += tz;
      sizes[e] += Math.max(Math.abs(tx), Math.abs(ty), Math.abs(tz));
    }
  }
}

/**
 * How the right normals of a part are computed.
 * @param part of a report
 * @returns {(positions: Float64Array, normals: Float64Array, sizes: Float64Array) => void} writes n of each element, of any
 *   length, and the size of what it was added up from; both arrays have one more element, for corners without any
 */
export function normalsOf(part) {
  const { triangles, faces, element, elements, weighting } = part;
  const polygons = faces ? cornersOfFaces(triangles, faces) : undefined;
  const corners = polygons?.corners ?? triangles;
  const slots = Uint32Array.from(corners, (v) => (element[v] === NONE ? elements : element[v]));
  const simple = weighting === 'area' && !polygons;
  const { offsets } = polygons ?? { offsets: simple ? undefined : Uint32Array.from({ length: triangles.length / 3 + 1 }, (_, t) => 3 * t) };
  return (positions, normals, sizes) => {
    normals.fill(0);
    sizes.fill(0);
    if (simple) addAreas(part, slots, positions, normals, sizes);
    else addWeighted({ offsets, corners }, slots, weighting, positions, normals, sizes);
    for (let e = 0, at = 0; e < elements; ++e, at += 3) {
      const most = Math.max(Math.abs(normals[at]), Math.abs(normals[at + 1]), Math.abs(normals[at + 2]));
      if (!(most > ROUNDING * sizes[e])) normals[at] = normals[at + 1] = normals[at + 2] = 0;
    }
  };
}

/** As set() of typed arrays, which takes five times as long where the types differ. */
export function copy(from, to) {
  for (let i = 0; i < from.length; ++i) to[i] = from[i];
}

/** The unit vector of three numbers from `at` on, or zero. */
export function unitAt(array, at, result = [0, 0, 0]) {
  const length = Math.hypot(array[at], array[at + 1], array[at + 2]);
  for (let c = 0; c < 3; ++c) result[c] = length > 0 ? array[at + c] / length : 0;
  return result;
}

/** The angle between two vectors, in degrees. */
export function degreesBetween(ax, ay, az, bx, by, bz) {
  const x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
  return (Math.atan2(Math.sqrt(x * x + y * y + z * z), ax * bx + ay * by + az * bz) * 180) / Math.PI;
}
