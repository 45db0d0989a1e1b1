// Compares two pictures of normals, pixel by pixel.
import { angle } from './exact.mjs';

// Pictures are RGBA in float32, (n + 1) / 2, alpha 0 where nothing was drawn. A pixel counts where it and its eight
// neighbours are covered in both, so that silhouettes are left out. Degrees: {pixels, mean, p99, max}.
export function compareNormals(shown, truth, { width, height }) {
  const covered = (x, y) => {
    const alpha = 4 * (y * width + x) + 3;
    return shown[alpha] > 0 && truth[alpha] > 0;
  };
  const normal = (picture, i) => [2 * picture[i] - 1, 2 * picture[i + 1] - 1, 2 * picture[i + 2] - 1];
  const degrees = [];
  for (let y = 1; y + 1 < height; ++y) {
    for (let x = 1; x + 1 < width; ++x) {
      let inside = true;
      for (let dy = -1; dy <= 1; ++dy) for (let dx = -1; dx <= 1; ++dx) inside &&= covered(x + dx, y + dy);
      const i = 4 * (y * width + x);
      if (inside) degrees.push(angle(normal(shown, i), normal(truth, i)));
    }
  }
  degrees.sort((a, b) => a - b);
  const pixels = degrees.length;
  const mean = degrees.reduce((sum, angle) => sum + angle, 0) / pixels;
  return { pixels, mean, p99: degrees[Math.floor(0.99 * pixels)] ?? NaN, max: degrees[pixels - 1] ?? NaN };
}
