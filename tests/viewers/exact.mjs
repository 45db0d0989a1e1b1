// Computes the true normals of the vertices of a mesh from positions alone, in double. A true normal is the sum of
// cross products over the faces around a point, turned by the rotation that takes the normal of the base's geometry to
// the stored normal.
const SAME_NORMAL = Math.cos((0.1 * Math.PI) / 180);

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const vector = (array, i) => [array[3 * i], array[3 * i + 1], array[3 * i + 2]];

// Returns the degrees between two vectors.
export function angle(a, b) {
  return (Math.atan2(length(cross(a, b)), dot(a, b)) * 180) / Math.PI;
}

// Turns v by the smallest rotation that takes the direction of `from` to the direction of `to`. Returns v if one of the
// two is zero, or if they are opposite, since then no rotation is the smallest.
function turned(v, from, to) {
  if (length(from) === 0 || length(to) === 0) return v;
  const a = scaled(from, 1 / length(from));
  const b = scaled(to, 1 / length(to));
  const axis = cross(a, b);
  const cosine = dot(a, b);
  if (1 + cosine < 1e-12) return v;
  const side = cross(axis, v);
  const along = dot(axis, v) / (1 + cosine);
  return [0, 1, 2].map((c) => cosine * v[c] + side[c] + axis[c] * along);
}

export class ExactNormals {
  // Takes a mesh as reader.mjs describes it. Vertices at the same place in the base and in every target are one point,
  // even in different primitives. They share a normal if their stored normals agree. Primitives without normals are
  // flat: viewers compute their normals.
  constructor(mesh) {
    this.primitives = mesh.primitives.filter((primitive) => primitive.triangles);
    this.elements = 0;
    this.elementOf = this.primitives.map((primitive) => this.#elementsOf(primitive));
    this.base = this.sums([]);
  }

  #points = new Map();

  #elementsOf(primitive) {
    if (!primitive.normals) return null;
    const result = new Uint32Array(primitive.positions.length / 3);
    for (let v = 0; v < result.length; ++v) {
      const places = [primitive.positions, ...primitive.targets.map((target) => target.positions)];
      const key = places.map((place) => (place ? vector(place, v).map((c) => c + 0).join() : '0,0,0')).join(' ');
      const normal = vector(primitive.normals, v);
      if (!this.#points.has(key)) this.#points.set(key, []);
      const sharing = this.#points.get(key);
      let known = sharing.find((e) => dot(e.normal, normal) >= SAME_NORMAL * length(e.normal) * length(normal));
      if (!known) sharing.push((known = { normal, element: this.elements++ }));
      result[v] = known.element;
    }
    return result;
  }

  // Returns n(w) of every element, not normalised.
  sums(weights) {
    const sums = new Float64Array(3 * this.elements);
    this.primitives.forEach((primitive, p) => {
      if (!this.elementOf[p]) return;
      const positions = exactPositions(primitive, weights);
      for (let f = 0; f + 2 < primitive.indices.length; f += 3) {
        const corners = [0, 1, 2].map((c) => primitive.indices[f + c]);
        const [a, b, c] = corners.map((v) => vector(positions, v));
        const normal = cross([0, 1, 2].map((k) => b[k] - a[k]), [0, 1, 2].map((k) => c[k] - a[k]));
        for (const v of corners) for (let k = 0; k < 3; ++k) sums[3 * this.elementOf[p][v] + k] += normal[k];
      }
    });
    return sums;
  }

  // Returns for each primitive null if it is flat, or else {directions, lengths}. `directions` has the true normal of
  // each vertex, not normalised; `lengths` has the length of its sum of cross products. Both are zero for vertices in
  // no triangle of the primitive.
  at(weights) {
    const sums = this.sums(weights);
    return this.primitives.map((primitive, p) => {
      const elements = this.elementOf[p];
      if (!elements) return null;
      const directions = new Float64Array(3 * elements.length);
      const lengths = new Float64Array(elements.length);
      for (const v of new Set(primitive.indices)) {
        const sum = vector(sums, elements[v]);
        lengths[v] = length(sum);
        directions.set(turned(sum, vector(this.base, elements[v]), vector(primitive.normals, v)), 3 * v);
      }
      return { directions, lengths };
    });
  }
}

export function exactPositions(primitive, weights) {
  const result = Float64Array.from(primitive.positions);
  primitive.targets.forEach((target, i) => {
    if (!target.positions || !weights[i]) return;
    for (let c = 0; c < result.length; ++c) result[c] += weights[i] * target.positions[c];
  });
  return result;
}
