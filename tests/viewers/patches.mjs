// Makes files whose pictures can be read as numbers. One file is a board of squares, each with its own normal and
// deltas. The other file is a single square that a target moves.
import { linear, writeFile } from './fixtures.mjs';

export const BOARD = 12;      // number of squares in a row, and of rows
export const SIZE = { width: 192, height: 192 };
const DISTANCE = 20;

// Returns a camera in front of the origin, which sees a square of this width around the origin as the whole picture.
function viewOf(width) {
  const degrees = (2 * Math.atan(width / 2 / DISTANCE) * 180) / Math.PI;
  return { eye: [0, 0, DISTANCE], at: [0, 0, 0], degrees, near: DISTANCE / 2, far: 2 * DISTANCE };
}

export const BOARD_VIEW = viewOf(BOARD);

// The pixel [x, y] in the middle of each square.
export const BOARD_PIXELS = Array.from({ length: BOARD * BOARD }, (_, p) =>
  [p % BOARD, Math.floor(p / BOARD)].map((c) => Math.floor(((c + 0.5) * SIZE.width) / BOARD)));

// Writes a board as a file. `patches` has {normal, deltas} for each square. `normal` is a vector. `deltas` has a vector
// for each target. If a target has no normals, its entry is null in all squares. `rows` has the weights at the times 0,
// 1, 2, ...
export function writeBoard(path, patches, rows) {
  const corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
  const places = patches.flatMap((_, p) =>
    corners.flatMap(([x, y]) => [(p % BOARD) + x - BOARD / 2, Math.floor(p / BOARD) + y - BOARD / 2, 0]));
  const positions = Float32Array.from(places);
  const ofCorners = (vector) => Float32Array.from(patches.flatMap((patch) => corners.flatMap(() => vector(patch))));
  const targets = patches[0].deltas.map((first, k) => ({
    positions: new Float32Array(positions.length),
    normals: first && ofCorners(({ deltas }) => deltas[k]),
  }));
  const indices = Uint16Array.from(patches.flatMap((_, p) => [0, 1, 2, 0, 2, 3].map((corner) => 4 * p + corner)));
  const primitives = [{ positions, normals: ofCorners(({ normal }) => normal), indices, targets }];
  return writeFile(path, { primitives, tracks: [linear(rows, 0, rows.map((_, k) => k))] });
}

const REACH = 4;  // distance by which the last target moves the square to the right, at weight 1

export const MOVER_VIEW = viewOf(4 * REACH);

// Returns the weight of the moving target at which the middle of the square is at a pixel.
export const weightOfMiddle = ([x]) => 4 * (x / SIZE.width - 0.5) + 0.5;

// Writes a file with a square whose base position is REACH / 2 to the left of the middle of the picture. Target
// `moving`, by default the last target, moves the square to the right by REACH. `track` is a track for writeFile().
export function writeMover(path, { targets = 1, moving = targets - 1, names, ...track }) {
  const positions = Float32Array.from([-1, 0, 0, 0, -1, 0, 1, 0, 0, 0, 1, 0], (c, i) => (i % 3 === 0 ? c - REACH / 2 : c));
  const normals = Float32Array.from([0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1]);
  const still = () => ({ positions: new Float32Array(12), normals: new Float32Array(12) });
  const all = Array.from({ length: targets }, still);
  all[moving].positions = Float32Array.from([REACH, 0, 0, REACH, 0, 0, REACH, 0, 0, REACH, 0, 0]);
  const primitives = [{ positions, normals, indices: Uint16Array.from([0, 1, 2, 0, 2, 3]), targets: all }];
  return writeFile(path, { primitives, tracks: [{ node: 0, ...track }], names });
}
