// Reads a glTF file into plain arrays, and computes what every viewer must show at a time by the formulas of glTF 2.0.
// Computes in float32 wherever viewers do. Treats correction targets like all other targets.
import { Logger, NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';

const TRIANGLES = 4;

export const errorsOnly = new Logger(Logger.Verbosity.ERROR);

export function newIO() {
  return new NodeIO().setLogger(errorsOnly).registerExtensions(ALL_EXTENSIONS);
}

// Returns all numbers of an accessor. Normalised integers are converted to the values that they stand for.
function numbers(accessor) {
  const width = accessor.getElementSize();
  const result = new Float32Array(accessor.getCount() * width);
  const element = [];
  for (let i = 0; i < accessor.getCount(); ++i) result.set(accessor.getElement(i, element), i * width);
  return result;
}

function readPrimitive(primitive) {
  const attribute = (owner, name) => {
    const accessor = owner.getAttribute(name);
    return accessor ? numbers(accessor) : null;
  };
  const positions = attribute(primitive, 'POSITION');
  const count = positions.length / 3;
  return {
    positions,
    normals: attribute(primitive, 'NORMAL'),
    indices: primitive.getIndices()?.getArray() ?? Uint32Array.from({ length: count }, (_, i) => i),
    triangles: primitive.getMode() === TRIANGLES,
    targets: primitive.listTargets().map((target) => ({
      positions: attribute(target, 'POSITION'),
      normals: attribute(target, 'NORMAL'),
    })),
  };
}

// Describes a document as {meshes: [{name, primitives, weights, extras}], nodes: [{mesh, weights}], animations: [{name,
// start, end, tracks}]}. `nodes` has only the nodes with a mesh, in the order of the file. A track names its node by
// the index in `nodes`.
export function describe(document) {
  const root = document.getRoot();
  const meshes = root.listMeshes();
  const nodes = root.listNodes().filter((node) => node.getMesh());
  return {
    meshes: meshes.map((mesh) => {
      const primitives = mesh.listPrimitives().map(readPrimitive);
      const count = primitives[0].targets.length;
      const weights = Float32Array.from({ length: count }, (_, k) => mesh.getWeights()[k] ?? 0);
      return { name: mesh.getName(), primitives, weights, extras: mesh.getExtras() };
    }),
    nodes: nodes.map((node) => ({
      name: node.getName(),
      mesh: meshes.indexOf(node.getMesh()),
      weights: node.getWeights().length > 0 ? Float32Array.from(node.getWeights()) : null,
    })),
    animations: root.listAnimations().map((animation) => {
      const tracks = animation
        .listChannels()
        .filter((channel) => channel.getTargetPath() === 'weights')
        .map((channel) => ({
          node: nodes.indexOf(channel.getTargetNode()),
          interpolation: channel.getSampler().getInterpolation(),
          times: numbers(channel.getSampler().getInput()),
          values: numbers(channel.getSampler().getOutput()),
        }));
      return {
        name: animation.getName(),
        start: Math.min(...tracks.map((track) => track.times[0])),
        end: Math.max(...tracks.map((track) => track.times.at(-1))),
        tracks,
      };
    }),
  };
}

export async function read(path) {
  return describe(await newIO().read(path));
}

// Returns the weights of a track at a time, by appendix C of glTF 2.0. Rounds them to float32, as viewers do.
export function weightsAt(track, time) {
  const { times, values, interpolation } = track;
  const spline = interpolation === 'CUBICSPLINE';
  const last = times.length - 1;
  const count = values.length / times.length / (spline ? 3 : 1);
  // Returns number i of keyframe k. For a keyframe of a spline, parts 0, 1 and 2 are its in-tangents, its values and
  // its out-tangents. Other keyframes have only values.
  const at = (k, part, i) => values[spline ? (3 * k + part) * count + i : k * count + i];
  const weights = (weight) => Float32Array.from({ length: count }, (_, i) => weight(i));
  if (time <= times[0]) return weights((i) => at(0, 1, i));
  if (time >= times[last]) return weights((i) => at(last, 1, i));
  let k = 0;
  while (times[k + 1] <= time) ++k;
  if (interpolation === 'STEP') return weights((i) => at(k, 1, i));
  const length = times[k + 1] - times[k];
  const t = (time - times[k]) / length;
  if (!spline) return weights((i) => (1 - t) * at(k, 1, i) + t * at(k + 1, 1, i));
  return weights(
    (i) =>
      (2 * t ** 3 - 3 * t ** 2 + 1) * at(k, 1, i) +
      length * (t ** 3 - 2 * t ** 2 + t) * at(k, 2, i) +
      (-2 * t ** 3 + 3 * t ** 2) * at(k + 1, 1, i) +
      length * (t ** 3 - t ** 2) * at(k + 1, 0, i),
  );
}

// Returns the weights of a node at a time of an animation. If the animation has no track for the node, returns the
// weights of the node itself or, if the node has none, the weights of its mesh.
export function nodeWeights(file, node, animation, time) {
  const track = animation?.tracks.find((candidate) => candidate.node === node);
  if (track) return weightsAt(track, time);
  return file.nodes[node].weights ?? file.meshes[file.nodes[node].mesh].weights;
}

// Returns base + sum_i w_i delta_i in float32, which rounds after each product and each sum.
export function morphed(base, deltas, weights) {
  const result = Float32Array.from(base);
  deltas.forEach((delta, i) => {
    const weight = Math.fround(weights[i]);
    if (!delta || weight === 0) return;
    for (let c = 0; c < result.length; ++c) result[c] += Math.fround(weight * delta[c]);
  });
  return result;
}

export function shownNormals(primitive, weights) {
  return morphed(primitive.normals, primitive.targets.map((target) => target.normals), weights);
}

export function shownPositions(primitive, weights) {
  return morphed(primitive.positions, primitive.targets.map((target) => target.positions), weights);
}
