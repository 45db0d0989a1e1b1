// Makes moving glTF files: a tube that twists, waves and swells. Each file has a property that makes a bake difficult.
import { Accessor, Document } from '@gltf-transform/core';
import { ExactNormals } from './exact.mjs';
import { newIO } from './reader.mjs';

// Makes the triangles of a tube around the y axis that is open at both ends: rows x columns quads of two triangles
// each.
function tube(columns, rows) {
  const indices = [];
  for (let r = 0; r < rows; ++r) {
    for (let c = 0; c < columns; ++c) {
      const next = (c + 1) % columns;
      const [a, b] = [r * columns + c, r * columns + next];
      indices.push(a, a + columns, b, b, a + columns, b + columns);
    }
  }
  return { columns, rows, indices: Uint16Array.from(indices) };
}

// Returns the positions of the vertices of a tube. place(angle, height) returns the position of a vertex, for a height
// between -1 and 1.
function placed({ columns, rows }, place) {
  const positions = [];
  for (let r = 0; r <= rows; ++r)
    for (let c = 0; c < columns; ++c) positions.push(...place((2 * Math.PI * c) / columns, (2 * r) / rows - 1));
  return Float32Array.from(positions);
}

const straight = (a, y) => [0.55 * Math.cos(a), y, 0.55 * Math.sin(a)];

function twisted(turn) {
  return (a, y) => straight(a + turn * (y + 1) * 0.5, y);
}

// Returns the position at the angle a and the height y on a tube with ripples around and along its axis.
function waved(a, y) {
  const radius = 0.55 + 0.22 * Math.sin(9 * y + 2 * a);
  return [radius * Math.cos(a), y, radius * Math.sin(a)];
}

const minus = (a, b) => a.map((x, i) => x - b[i]);

function unitNormals(positions, indices) {
  const zeros = new Float32Array(positions.length).map((_, i) => (i % 3 === 0 ? 1 : 0));
  const flat = { positions, normals: zeros, indices, triangles: true, targets: [] };
  const exact = new ExactNormals({ primitives: [flat] });
  const sums = exact.sums([]);
  const result = new Float32Array(positions.length);
  exact.elementOf[0].forEach((element, v) => {
    const sum = sums.subarray(3 * element, 3 * element + 3);
    const length = Math.hypot(...sum);
    for (let c = 0; c < 3; ++c) result[3 * v + c] = sum[c] / length;
  });
  return result;
}

// Makes a primitive for writeFile() with a base shape and targets. Stores the true normals of the base and, if
// targetNormals is true, of each target.
function primitiveOf(grid, base, targets, { targetNormals = true } = {}) {
  const positions = placed(grid, base);
  const normals = unitNormals(positions, grid.indices);
  return {
    positions,
    normals,
    indices: grid.indices,
    targets: targets.map((target) => {
      const there = placed(grid, target);
      return {
        positions: minus(there, positions),
        normals: targetNormals ? minus(unitNormals(there, grid.indices), normals) : null,
      };
    }),
  };
}

// Returns a primitive with only some of the triangles, but all vertices.
function part(primitive, from, to) {
  return { ...primitive, indices: primitive.indices.slice(from, to) };
}

// Writes a GLB file from {primitives, nodes: [{at, weights?}], tracks: [{node, interpolation, times, values}],
// weights?, names?}.
export async function writeFile(path, { primitives, nodes = [{ at: [0, 0, 0] }], tracks = [], weights, names }) {
  const document = new Document();
  const buffer = document.createBuffer();
  const accessor = (type, array) => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const mesh = document.createMesh('tube');
  for (const { positions, normals, indices, targets } of primitives) {
    const material = document.createMaterial().setDoubleSided(true);
    const primitive = document.createPrimitive().setMaterial(material);
    primitive.setIndices(accessor(Accessor.Type.SCALAR, indices));
    primitive.setAttribute('POSITION', accessor(Accessor.Type.VEC3, positions));
    if (normals) primitive.setAttribute('NORMAL', accessor(Accessor.Type.VEC3, normals));
    for (const [k, target] of targets.entries()) {
      const morph = document.createPrimitiveTarget(names?.[k]);
      morph.setAttribute('POSITION', accessor(Accessor.Type.VEC3, target.positions));
      if (normals && target.normals) morph.setAttribute('NORMAL', accessor(Accessor.Type.VEC3, target.normals));
      primitive.addTarget(morph);
    }
    mesh.addPrimitive(primitive);
  }
  mesh.setWeights(weights ?? primitives[0].targets.map(() => 0));
  const scene = document.createScene();
  document.getRoot().setDefaultScene(scene);
  const placedNodes = nodes.map(({ at, weights: own }) => {
    const node = document.createNode().setMesh(mesh).setTranslation(at);
    if (own) node.setWeights(own);
    scene.addChild(node);
    return node;
  });
  if (tracks.length > 0) {
    const animation = document.createAnimation('move');
    for (const { node, interpolation, times, values } of tracks) {
      const sampler = document.createAnimationSampler().setInterpolation(interpolation);
      sampler.setInput(accessor(Accessor.Type.SCALAR, Float32Array.from(times)));
      sampler.setOutput(accessor(Accessor.Type.SCALAR, Float32Array.from(values)));
      const channel = document.createAnimationChannel().setTargetPath('weights');
      channel.setTargetNode(placedNodes[node]).setSampler(sampler);
      animation.addSampler(sampler).addChannel(channel);
    }
  }
  await newIO().write(path, document);
}

export const linear = (values, node = 0, times = values.map((_, k) => 0.75 * k)) => ({
  node,
  interpolation: 'LINEAR',
  times,
  values: values.flat(),
});

const grid = tube(36, 48);
const twist = () => primitiveOf(grid, straight, [twisted(2.4)]);
const wave = () => primitiveOf(grid, straight, [waved]);

// The files by name, each with the function that writes it. In all files but `pair`, only one target is active at a
// time.
export const fixtures = {
  twist: (path) => writeFile(path, { primitives: [twist()], tracks: [linear([0, 1, 0.25])] }),
  wave: (path) => writeFile(path, { primitives: [wave()], tracks: [linear([0, 1])] }),
  no_target_normals: (path) =>
    writeFile(path, {
      primitives: [primitiveOf(grid, straight, [waved], { targetNormals: false })],
      tracks: [linear([0, 1])],
    }),
  spline: (path) =>
    writeFile(path, {
      primitives: [wave()],
      // Each of the three keys has an in-tangent, a weight and an out-tangent. Between the keys, the weight exceeds 0.8
      // and leaves [0, 1].
      tracks: [{ node: 0, interpolation: 'CUBICSPLINE', times: [0, 1, 2], values: [0, 0, 6, 0, 0.8, -3, 0.4, 0.2, 0] }],
    }),
  step: (path) =>
    writeFile(path, {
      primitives: [wave()],
      tracks: [{ node: 0, interpolation: 'STEP', times: [0, 0.5, 1, 1.5], values: [0, 0.5, 0.4, 0.25] }],
    }),
  two_primitives: (path) => {
    const whole = twist();
    const half = 3 * 36 * 48;
    return writeFile(path, {
      primitives: [part(whole, 0, half), part(whole, half, 2 * half)],
      tracks: [linear([0, 1])],
    });
  },
  one_flat_primitive: (path) => {
    const whole = wave();
    const half = 3 * 36 * 48;
    const targets = whole.targets.map(({ positions }) => ({ positions, normals: null }));
    return writeFile(path, {
      primitives: [part(whole, 0, half), { ...part(whole, half, 2 * half), normals: null, targets }],
      tracks: [linear([0, 1])],
    });
  },
  instances: (path) =>
    writeFile(path, {
      primitives: [twist()],
      nodes: [{ at: [-1.3, 0, 0] }, { at: [0, 0, 0] }, { at: [1.3, 0, 0], weights: [0.5] }],
      tracks: [linear([0, 1, 0]), linear([1, 0.25], 1, [0, 1.5])],
    }),
  // The base normals lean away from the normals of the surface, as if an author had edited them.
  authored: (path) => {
    const primitive = twist();
    for (let v = 0; v < primitive.normals.length; v += 3) {
      const [x, y, z] = [primitive.normals[v], 0.35, primitive.normals[v + 2]];
      primitive.normals.set([x, y, z].map((c) => c / Math.hypot(x, y, z)), v);
    }
    primitive.targets[0].normals = null;
    return writeFile(path, { primitives: [primitive], tracks: [linear([0, 1])] });
  },
  // The two targets are active one after the other, as in an exported sequence of keyframes.
  keyframes: (path) =>
    writeFile(path, {
      primitives: [primitiveOf(grid, straight, [twisted(1.8), waved])],
      tracks: [linear([[0, 0], [1, 0], [0, 1], [0, 0]])],
    }),
  pair: (path) =>
    writeFile(path, {
      primitives: [primitiveOf(grid, straight, [twisted(1.2), waved])],
      tracks: [linear([[0, 0], [1, 0.3], [0.2, 1]])],
    }),
};

// Writes a mesh with two targets and no animation. The mesh has `parts` primitives.
export function writeStill(path, { parts, weights = null }) {
  const whole = primitiveOf(grid, straight, [twisted(1.2), waved]);
  const size = whole.indices.length / parts;
  const primitives = Array.from({ length: parts }, (_, p) => part(whole, p * size, (p + 1) * size));
  return writeFile(path, { primitives, weights });
}

// Writes a tube on which a bump grows around an angle, and inside it a thinner tube with a steeper bump, which is
// invisible from outside. The target has no normals, so both bumps have errors, and the inner bump has the worst error.
export function writeBump(path, angle, name) {
  const bumpOf = (at, height, width) => (a, y) => height * Math.exp(-((2 - 2 * Math.cos(a - at)) + y * y) / width ** 2);
  const tubeOf = (radius, bump) => {
    const place = (more) => (a, y) => [(radius + more(a, y)) * Math.cos(a), y, (radius + more(a, y)) * Math.sin(a)];
    return primitiveOf(grid, place(() => 0), [place(bump)], { targetNormals: false });
  };
  const primitives = [tubeOf(0.55, bumpOf(angle, 0.3, 0.5)), tubeOf(0.15, bumpOf(angle + 2, 0.16, 0.16))];
  return writeFile(path, { primitives, names: [name], tracks: [linear([0, 1])] });
}

// Returns the keyframes of a sequence, each as the text of an OBJ file.
export function sequenceFrames() {
  return [straight, twisted(1.6), waved].map((place) => {
    const positions = placed(grid, place);
    const lines = [];
    for (let v = 0; v < positions.length; v += 3) lines.push(`v ${[...positions.subarray(v, v + 3)].join(' ')}`);
    for (let f = 0; f < grid.indices.length; f += 3)
      lines.push(`f ${[...grid.indices.subarray(f, f + 3)].map((v) => v + 1).join(' ')}`);
    return `${lines.join('\n')}\n`;
  });
}

// Writes a vase that gets flutes and twists, for a picture in the documents. If targetNormals is false, the targets
// have no normals, as in the files of many exporters.
export function writeVase(path, { targetNormals }) {
  const profile = (y) => 0.45 + 0.13 * Math.sin(2.4 * y + 2);
  const fluted = (a, y) => {
    const depth = 0.35 * Math.min(1, 3 * (1 - y * y));
    const radius = profile(y) * (1 + depth * Math.sin(6 * a - 9 * y));
    const turned = a + 1.1 * (y + 1);
    return [radius * Math.cos(turned), y, radius * Math.sin(turned)];
  };
  const fine = tube(160, 140);
  const plain = (a, y) => [0.45 * Math.cos(a), y, 0.45 * Math.sin(a)];
  const primitive = primitiveOf(fine, plain, [fluted], { targetNormals });
  return writeFile(path, { primitives: [primitive], tracks: [linear([0, 1], 0, [0, 1])] });
}
