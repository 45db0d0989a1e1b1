// Functions for pictures of normals. A picture has RGBA in float32: the colour is (n + 1) / 2, and alpha is 0 where
// nothing was drawn. The lowest row is first.
import { angle } from './exact.mjs';

// Returns the normal of a pixel, or null if nothing is drawn there.
export function normalAt(picture, { width }, x, y) {
  const i = 4 * (y * width + x);
  return picture[i + 3] > 0 ? normalIn(picture, i) : null;
}

const normalIn = (picture, i) => [2 * picture[i] - 1, 2 * picture[i + 1] - 1, 2 * picture[i + 2] - 1];

// Returns the average position of all drawn pixels, or null if nothing was drawn.
export function middleOf(picture, { width, height }) {
  const sum = [0, 0];
  let count = 0;
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      if (picture[4 * (y * width + x) + 3] === 0) continue;
      sum[0] += x + 0.5;
      sum[1] += y + 0.5;
      ++count;
    }
  }
  return count > 0 ? sum.map((c) => c / count) : null;
}

// Draws a picture of normals as a glossy surface under one lamp, and returns the pixels for a canvas. Torn edges,
// across which errors jump, are then visible as in a viewer, but with the same light for all viewers. Normals are in
// world space if `view` is given, and otherwise in the space of the camera.
export function lit(picture, view, { width, height }) {
  const LAMP = unit([-0.45, 0.6, 0.66]), HALF = unit([LAMP[0], LAMP[1], LAMP[2] + 1]), BASE = [47, 127, 181], BACK = [248, 250, 252];
  const axes = view ? cameraAxes(view) : null, image = new ImageData(width, height);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const from = 4 * (y * width + x), to = 4 * ((height - 1 - y) * width + x), colour = [...BACK];
      if (picture[from + 3] > 0) {
        const n = unit(normalIn(picture, from)), seen = axes ? axes.map((axis) => dot(axis, n)) : n;
        const light = 0.25 + 0.8 * Math.max(0, dot(seen, LAMP)), gloss = 190 * Math.max(0, dot(seen, HALF)) ** 60;
        for (let c = 0; c < 3; ++c) colour[c] = Math.min(255, BASE[c] * light + gloss);
      }
      image.data.set([...colour, 255], to);
    }
  return image;
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// Returns the directions to the right, up and backwards of a camera.
function cameraAxes({ eye, at }) {
  const back = unit(eye.map((x, c) => x - at[c])), right = unit(cross([0, 1, 0], back));
  return [right, cross(back, right), back];
}

// Compares two pictures of normals pixel by pixel. A pixel counts only if the pixel and its eight neighbours are drawn
// in both pictures, so silhouettes do not count. Returns {pixels, mean, p99, max}, with angles in degrees.
export function compareNormals(shown, truth, { width, height }) {
  const covered = (x, y) => {
    const alpha = 4 * (y * width + x) + 3;
    return shown[alpha] > 0 && truth[alpha] > 0;
  };
  const degrees = [];
  for (let y = 1; y + 1 < height; ++y) {
    for (let x = 1; x + 1 < width; ++x) {
      let inside = true;
      for (let dy = -1; dy <= 1; ++dy) for (let dx = -1; dx <= 1; ++dx) inside &&= covered(x + dx, y + dy);
      const i = 4 * (y * width + x);
      if (inside) degrees.push(angle(normalIn(shown, i), normalIn(truth, i)));
    }
  }
  degrees.sort((a, b) => a - b);
  const pixels = degrees.length;
  const mean = degrees.reduce((sum, angle) => sum + angle, 0) / pixels;
  return { pixels, mean, p99: degrees[Math.floor(0.99 * pixels)] ?? NaN, max: degrees[pixels - 1] ?? NaN };
}
