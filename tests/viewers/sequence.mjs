// Describes a sequence of OBJ files in the form of reader.mjs, so that the sequence can be compared with its bake.
import { ExactNormals, length } from './exact.mjs';

function parse(text) {
  const positions = [];
  const indices = [];
  for (const line of text.split('\n')) {
    const words = line.trim().split(/\s+/);
    if (words[0] === 'v') positions.push(...words.slice(1, 4).map(Number));
    if (words[0] !== 'f') continue;
    const corners = words.slice(1).map((word) => Number(word.split('/')[0]) - 1);
    for (let c = 2; c < corners.length; ++c) indices.push(corners[0], corners[c - 1], corners[c]);
  }
  return { positions: Float32Array.from(positions), indices: Uint32Array.from(indices) };
}

// Describes a sequence as one mesh whose targets are the differences of frames 1, 2, ... from frame 0. The weight of a
// target is 1 at its own frame, 0 at all other frames, and linear in between.
export function describeSequence(texts, framesPerSecond) {
  const frames = texts.map(parse);
  const [{ positions, indices }] = frames;
  const targets = frames.slice(1).map((frame) => ({
    positions: Float64Array.from(frame.positions, (place, i) => place - positions[i]),
    normals: null,
  }));
  const first = new Float32Array(positions.length).fill(1);
  const exact = new ExactNormals({ primitives: [{ positions, normals: first, indices, triangles: true, targets }] });
  const normals = new Float32Array(positions.length);
  const base = exact.sums([]);
  exact.elementOf[0].forEach((element, v) => {
    const sum = base.subarray(3 * element, 3 * element + 3);
    for (let c = 0; c < 3; ++c) normals[3 * v + c] = sum[c] / (length(sum) || 1);
  });
  const primitive = { positions, normals, indices, triangles: true, targets };
  const track = {
    node: 0,
    interpolation: 'LINEAR',
    times: Float32Array.from(frames, (_, k) => k / framesPerSecond),
    values: Float32Array.from(frames.flatMap((_, k) => targets.map((__, i) => (k === i + 1 ? 1 : 0)))),
  };
  return {
    meshes: [{ name: '', primitives: [primitive], weights: new Float32Array(targets.length) }],
    nodes: [{ mesh: 0, weights: null }],
    animations: [{ name: '', start: 0, end: track.times.at(-1), tracks: [track] }],
  };
}

// Returns `baked` with its vertices in the order of the sequence. Vertices are matched by their positions in the first
// frame.
export function inOrderOf(sequence, baked) {
  const [wanted] = sequence.meshes[0].primitives;
  const [primitive] = baked.meshes[0].primitives;
  const place = (array, v) => array.subarray(3 * v, 3 * v + 3).join();
  const count = primitive.positions.length / 3;
  const known = new Map(Array.from({ length: count }, (_, v) => [place(primitive.positions, v), v]));
  const order = Array.from({ length: wanted.positions.length / 3 }, (_, v) =>
    v < count && place(primitive.positions, v) === place(wanted.positions, v)
      ? v
      : known.get(place(wanted.positions, v)),
  );
  const picked = (array) => array && Float32Array.from(order.flatMap((v) => [...array.subarray(3 * v, 3 * v + 3)]));
  const result = structuredClone(baked);
  result.meshes[0].primitives[0] = {
    ...primitive,
    positions: picked(primitive.positions),
    normals: picked(primitive.normals),
    targets: primitive.targets.map(({ positions, normals }) => ({
      positions: picked(positions),
      normals: picked(normals),
    })),
  };
  return result;
}
