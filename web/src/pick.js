// Finds the first triangle that a ray meets. The page uses this to find the vertex under the pointer, and directions
// from which a vertex is visible.

/**
 * Finds the nearest triangle that a ray meets. Positions are (V x 3).
 * @returns {{distance: number, vertex: number, triangle: number}} the distance, in lengths of the direction; the
 *   triangle; and the corner of the triangle that is nearest to the point of intersection. If the ray meets nothing, they
 *   are Infinity, -1 and -1
 */
export function meet(positions, triangles, origin, direction) {
  const [ox, oy, oz] = origin, [dx, dy, dz] = direction;
  let nearest = Infinity, vertex = -1, triangle = -1;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ex = positions[b] - positions[a], ey = positions[b + 1] - positions[a + 1], ez = positions[b + 2] - positions[a + 2];
    const fx = positions[c] - positions[a], fy = positions[c + 1] - positions[a + 1], fz = positions[c + 2] - positions[a + 2];
    const px = dy * fz - dz * fy, py = dz * fx - dx * fz, pz = dx * fy - dy * fx, determinant = ex * px + ey * py + ez * pz;
    if (determinant === 0) continue;
    const sx = ox - positions[a], sy = oy - positions[a + 1], sz = oz - positions[a + 2];
    const u = (sx * px + sy * py + sz * pz) / determinant;
    if (u < 0 || u > 1) continue;
    const qx = sy * ez - sz * ey, qy = sz * ex - sx * ez, qz = sx * ey - sy * ex;
    const v = (dx * qx + dy * qy + dz * qz) / determinant, w = 1 - u - v;
    if (v < 0 || w < 0) continue;
    const distance = (fx * qx + fy * qy + fz * qz) / determinant;
    if (!(distance > 0 && distance < nearest)) continue;
    nearest = distance;
    triangle = t / 3;
    vertex = triangles[w >= u && w >= v ? t : u >= v ? t + 1 : t + 2];
  }
  return { distance: nearest, vertex, triangle };
}
