// Computes the weights of correction targets from the weights of a mesh's own targets (docs/formats.md), for three.js,
// babylon.js and playcanvas.js.

// The version of the formulas that this file knows. Files with another version are left as they are.
const VERSION = 2;

/**
 * Returns the formulas of a mark (extras.chronormal of a mesh with `count` targets) in arrays that can be evaluated
 * without allocating. A correction target without a formula is driven only by the animations of the file, and is left
 * out. Correction targets are the last targets of a mesh. If the number of targets has changed since the bake, the
 * result is empty.
 */
export function formulasOf(mark, count) {
  if (mark?.version !== VERSION || !Array.isArray(mark.extras) || mark.extras.at(-1)?.target !== count - 1) return [];
  return mark.extras
    .filter(({ linear, quadratic }) => linear.length + quadratic.length > 0)
    .map(({ target, linear, quadratic }) => ({
      target,
      first: Int32Array.from([...linear.map(([i]) => i), ...quadratic.map(([i]) => i)]),
      second: Int32Array.from([...linear.map(() => -1), ...quadratic.map(([, j]) => j)]), // -1 for a linear term
      factor: Float64Array.from([...linear.map(([, a]) => a), ...quadratic.map(([, , q]) => q)]),
    }));
}

/** Returns the weight of a correction target. `w` has the weights of all targets. */
export function weightOf({ first, second, factor }, w) {
  let sum = 0;
  for (let n = 0; n < factor.length; ++n) {
    sum += factor[n] * w[first[n]] * (second[n] < 0 ? 1 : w[second[n]]);
  }
  return sum;
}

/** Computes the weights of correction targets, and writes them into `w`, which has the weights of all targets. */
export function drive(formulas, w) {
  for (let k = 0; k < formulas.length; ++k) w[formulas[k].target] = weightOf(formulas[k], w);
}

/**
 * Returns the mark (extras.chronormal) of a mesh, or else the mark of the nearest object above the mesh.
 * extrasOf(object) returns the extras of an object. A viewer makes a mesh of several primitives into an object with a
 * child for each primitive, and gltfpack puts a mesh into a new node below the node with the extras.
 */
export function markOf(object, extrasOf) {
  for (; object; object = object.parent) {
    const mark = extrasOf(object)?.chronormal;
    if (mark) return mark;
  }
  return undefined;
}
