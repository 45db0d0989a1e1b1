// Computes the true normals of the vertices of a mesh from positions, in double. The sum of cross products over the
// faces around a point gives the normal of the geometry. A rotation that takes the geometry's normal in the base to the
// stored normal turns this sum into the true normal.
const SAME_NORMAL = Math.cos((0.1 * Math.PI) / 180);

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const vector = (array, i) => [array[3 * i], array[3 * i + 1], array[3 * i + 2]];

// Returns the angle between two vectors in degrees.
export function angle(a, b) {
  return (Math.atan2(length(cross(a, b)), dot(a, b)) * 180) / Math.PI;
}

// Turns v by the smallest rotation from the direction of `from` to the direction of `to`. Returns v if there is no such
// rotation, because `from` or `to` is zero or because they are opposite.
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
  // Takes a mesh in the form of reader.mjs. Vertices that are at the same place in the base and in every target are one
  // point, even in different primitives. Vertices at one point share a normal if their stored normals agree. Primitives
  // without normals are flat: viewers compute their normals.
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

  // Returns the sum of cross products of every element, a group of vertices that share a normal, at these weights. The
  // vectors do not have length 1.
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

  // Returns for each primitive null if the primitive is flat, and otherwise {directions, lengths}. `directions` has the
  // true normal of each vertex, not scaled to length 1. `lengths` has the length of the sum of cross products at the
  // vertex. If no triangle of the primitive uses a vertex, its direction and its length are zero.
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
