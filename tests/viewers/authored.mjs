// A sheet as an artist models it: quads, some hexagons, and some flat-shaded faces. The normal of a smooth point is the
// sum of the normals of all polygons around the point, weighted by the angles at their corners. Some normals are edited
// as if by hand, differently in each shape key. A few of the edited normals point to the back of the sheet.
import { writeFile } from './fixtures.mjs';
import { randomNumbers } from './random.mjs';

const minus = (a, b) => a.map((x, c) => x - b[c]);
const plus = (a, b, s = 1) => a.map((x, c) => x + s * b[c]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a) => a.map((x) => x / Math.hypot(...a));
const single = (a) => a.map(Math.fround);

// Makes polygons over n x n points. A polygon has its corners in counterclockwise order, and the triangles into which
// an exporter cuts the polygon.
function polygonsOf(n, random) {
  const polygons = [], middle = n >> 1, quad = [[0, 1, 2], [0, 2, 3]], ears = [[5, 0, 1], [2, 3, 4], [5, 1, 2], [5, 2, 4]];
  const isNear = (i, j) => Math.max(Math.abs(i + 0.5 - middle), Math.abs(j + 0.5 - middle)) < 1;
  for (let j = 0; j + 1 < n; ++j) {
    for (let i = 0; i + 1 < n; ++i) {
      const a = j * n + i, kind = random();
      const isWide = i + 2 < n && kind < 0.1 && !isNear(i, j) && !isNear(i + 1, j), isFlat = kind > 0.85 && !isNear(i, j);
      if (isWide) polygons.push({ corners: [a, a + 1, a + 2, a + n + 2, a + n + 1, a + n], triangles: ears, isFlat });
      else polygons.push({ corners: [a, a + 1, a + n + 1, a + n], triangles: quad, isFlat });
      if (isWide) ++i;
    }
  }
  return polygons;
}

const faceNormal = ({ corners }, p) => unit(corners.reduce((sum, v, i) => plus(sum, cross(p[v], p[corners[(i + 1) % corners.length]])), [0, 0, 0]));

// Returns the unit normals of all points. Each unit normal has the direction of the sum of the normals of the polygons
// around the point, weighted by the angles at their corners.
function pointNormals(polygons, p) {
  const sums = p.map(() => [0, 0, 0]);
  for (const polygon of polygons) {
    const { corners } = polygon, normal = faceNormal(polygon, p);
    corners.forEach((v, i) => {
      const e = minus(p[corners[(i + 1) % corners.length]], p[v]), f = minus(p[corners[(i + corners.length - 1) % corners.length]], p[v]);
      sums[v] = plus(sums[v], normal, Math.atan2(Math.hypot(...cross(e, f)), dot(e, f)));
    });
  }
  return sums.map(unit);
}

/** Writes the sheet as a file. Target 2 pulls the middle point up so far that all edges at this point are nearly
 * parallel to its normal. */
export async function writeAuthored(path, seed, n = 12) {
  const random = randomNumbers(seed), around = (size) => size * (2 * random() - 1);
  const polygons = polygonsOf(n, random), middle = (n >> 1) * n + (n >> 1), keys = [];
  const isStill = (v) => Math.abs((v % n) - (n >> 1)) < 2 && Math.abs(Math.floor(v / n) - (n >> 1)) < 2;
  const base = Array.from({ length: n * n }, (_, v) => single([v % n, Math.floor(v / n), isStill(v) ? 0 : around(0.4)]));
  keys.push(base);
  for (let k = 0; k < 2; ++k) keys.push(base.map((p) => single(plus(p, [around(0.25), around(0.25), around(0.7)]))));
  keys.push(base.map((p, v) => (v === middle ? [p[0], p[1], 90] : p)));
  const isBent = base.map((_, v) => v === middle || random() < 0.12), side = base.map((_, v) => (isBent[v] && random() < 0.3 ? -1 : 1));
  const stored = keys.map((p) => pointNormals(polygons, p).map((normal, v) => {
    const bent = isBent[v] ? unit(plus(normal, [around(1), around(1), around(1)], 0.25)) : normal;
    return bent.map((x) => side[v] * x);
  }));

  // Each smooth point has one vertex, and so has each corner of a flat-shaded polygon.
  const vertices = [], indices = [], vertexOf = new Map();
  for (const polygon of polygons) {
    const flat = polygon.isFlat ? keys.map((p) => faceNormal(polygon, p)) : null;
    const own = polygon.corners.map((point) => {
      if (!flat && vertexOf.has(point)) return vertexOf.get(point);
      vertices.push({ point, normals: flat ?? stored.map((normals) => normals[point]) });
      if (!flat) vertexOf.set(point, vertices.length - 1);
      return vertices.length - 1;
    });
    for (const triangle of polygon.triangles) indices.push(...triangle.map((i) => own[i]));
  }
  const flattened = (of) => Float32Array.from(vertices.flatMap(of));
  await writeFile(path, {
    primitives: [{
      positions: flattened(({ point }) => base[point]),
      normals: flattened(({ normals }) => normals[0]),
      indices: Uint16Array.from(indices),
      targets: [1, 2, 3].map((k) => ({
        positions: flattened(({ point }) => minus(keys[k][point], base[point])),
        normals: flattened(({ normals }) => minus(single(normals[k]), single(normals[0]))),
      })),
    }],
    tracks: [{ node: 0, interpolation: 'LINEAR', times: [0, 1, 3], values: [0, 0, 0, 1, 0.5, 0.25, 0.5, 1.5, -0.5] }],
  });
}
