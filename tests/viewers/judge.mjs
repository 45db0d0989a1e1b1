// Compares the normals that a viewer renders from a file, at many times, with the exact normals of the file before the
// bake.
import { drive } from '../../examples/drive.mjs';
import { ExactNormals, angle, exactPositions, length } from './exact.mjs';
import { nodeWeights, shownNormals, shownPositions } from './reader.mjs';

// If the sum of cross products at a vertex is shorter than this share of the longest sum at the vertex over all states,
// its direction is not reliable.
const NO_DIRECTION = 1e-4;

export function timesOf(animation, count) {
  const { start, end } = animation;
  return Array.from({ length: count }, (_, i) => start + ((end - start) * i) / (count - 1));
}

// Returns the midpoints of equal parts of an animation. All viewers treat these times as inside the animation.
export function timesWithin({ start, end }, count) {
  return Array.from({ length: count }, (_, i) => start + ((end - start) * (i + 0.5)) / count);
}

// Tells whether any target of a mesh moves any vertex.
export function moves(mesh) {
  const somewhere = (array) => array?.some((number) => number !== 0) ?? false;
  return mesh.primitives.some((primitive) => primitive.targets.some((target) => somewhere(target.positions)));
}

// Returns an empty result: {mean, max, where, pairs, excluded, flat, drift}. A sample is a vertex in one state of a
// mesh. `mean` and `max` are errors in degrees, `where` names the sample with the largest error, and `pairs` is the
// number of samples. `excluded` counts samples without a direction or a triangle. `flat` counts primitives without
// normals, which viewers shade by themselves. `drift` is the largest distance between a vertex in `shown` and in
// `source`, as a share of the size of its mesh.
function nothing() {
  return { mean: 0, max: 0, where: '', pairs: 0, excluded: 0, flat: 0, drift: 0 };
}

// Adds the errors of a mesh to a result. Until all meshes are added, `mean` is a sum. A state is {name, weights,
// shownWeights}, with the weights of the targets in both files.
function addMesh(result, source, shown, states) {
  const exact = new ExactNormals(source);
  const shownPrimitives = shown.primitives.filter((primitive) => primitive.triangles);
  const truths = states.map(({ weights }) => exact.at(weights));
  exact.primitives.forEach((primitive, p) => {
    if (!truths[0][p]) {
      ++result.flat;
      return;
    }
    const longest = new Float64Array(primitive.positions.length / 3);
    for (const truth of truths) truth[p].lengths.forEach((l, v) => (longest[v] = Math.max(longest[v], l)));
    const size = primitive.positions.reduce((most, c) => Math.max(most, Math.abs(c)), 0);
    states.forEach(({ name, weights, shownWeights }, s) => {
      const { directions, lengths } = truths[s][p];
      const normals = shownNormals(shownPrimitives[p], shownWeights);
      const places = shownPositions(shownPrimitives[p], shownWeights);
      exactPositions(primitive, weights).forEach((place, c) => {
        result.drift = Math.max(result.drift, Math.abs(place - places[c]) / size);
      });
      for (let v = 0; v < longest.length; ++v) {
        if (!(lengths[v] > NO_DIRECTION * longest[v])) {
          ++result.excluded;
          continue;
        }
        const normal = normals.subarray(3 * v, 3 * v + 3);
        const degrees = length(normal) > 0 ? angle(normal, directions.subarray(3 * v, 3 * v + 3)) : 180;
        result.mean += degrees;
        ++result.pairs;
        if (!(degrees <= result.max)) {
          result.max = degrees;
          result.where = `${name}, primitive ${p}, vertex ${v}`;
        }
      }
    });
  });
}

function averaged(result) {
  return { ...result, mean: result.mean / Math.max(result.pairs, 1) };
}

// Compares the rendered normals of all nodes with the exact normals, at some times of an animation. Skips meshes that
// never move.
export function compareAnimation(source, shown, animation, times) {
  const result = nothing();
  source.nodes.forEach((node, n) => {
    if (!moves(source.meshes[node.mesh])) return;
    const states = times.map((time) => ({
      name: `node ${n} at ${time}`,
      weights: nodeWeights(source, n, source.animations[animation], time),
      shownWeights: nodeWeights(shown, n, shown.animations[animation], time),
    }));
    addMesh(result, source.meshes[node.mesh], shown.meshes[shown.nodes[n].mesh], states);
  });
  return averaged(result);
}

// Tells whether the weights of a track never change.
function stands({ times, values, interpolation }) {
  const width = values.length / times.length;
  return interpolation !== 'CUBICSPLINE' && values.every((value, i) => value === values[i % width]);
}

// Compares the normals of the meshes that no animation moves, in a viewer that sets each target alone, and then all
// targets together. The extras of a mesh tell how its correction targets are driven.
function compareUndriven(source, shown) {
  const moving = source.animations.flatMap(({ tracks }) => tracks.filter((track) => !stands(track)));
  const driven = new Set(moving.map(({ node }) => source.nodes[node].mesh));
  const result = nothing();
  source.meshes.forEach((mesh, m) => {
    if (driven.has(m) || !moves(mesh)) return;
    const count = mesh.weights.length;
    const steps = Array.from({ length: 11 }, (_, i) => i / 10);
    const onlyOne = (w, k) => mesh.weights.map((_, i) => (i === k ? w : 0));
    const alone = steps.flatMap((w) => Array.from({ length: count }, (_, k) => onlyOne(w, k)));
    const together = steps.map((w) => mesh.weights.map((_, i) => w / (1 + i)));
    const states = [...alone, ...together].map((weights) => {
      const shownWeights = new Float32Array(shown.meshes[m].weights.length);
      shownWeights.set(weights);
      if (shown.meshes[m].extras.chronormal) drive(shown.meshes[m].extras.chronormal, shownWeights);
      return { name: `mesh ${m} at weights ${weights}`, weights, shownWeights };
    });
    addMesh(result, mesh, shown.meshes[m], states);
  });
  return averaged(result);
}

// Returns a result for each animation with weights, and one result for the meshes that no animation moves. If the
// weights of an animation are constant, compares normals at only one time.
export function compareFiles(source, shown, count = 101) {
  const results = source.animations.flatMap((animation, a) => {
    if (animation.tracks.length === 0) return [];
    const times = animation.tracks.every(stands) ? [animation.start] : timesOf(animation, count);
    return [compareAnimation(source, shown, a, times)];
  });
  return [...results, compareUndriven(source, shown)];
}
