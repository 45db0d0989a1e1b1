// Gives the correction targets of a baked file their weights, for a program that sets weights by itself instead of
// playing the animations of the file. `chronormal` is extras.chronormal of the mesh, or of a node that carries the
// mesh.

// Returns the weight of one correction target, from the weights w of the mesh's own targets.
function weightOf({ linear, quadratic }, w) {
  let sum = 0;
  for (const [i, a] of linear) sum += a * w[i];
  for (const [i, j, q] of quadratic) sum += q * w[i] * w[j];
  return sum;
}

// Writes the weights of all correction targets into w, which has the weights of all targets.
export function drive(chronormal, w) {
  for (const extra of chronormal.extras) w[extra.target] = weightOf(extra, w);
}

// Returns extras.chronormal of a mesh, or else of the nearest object above it that has one. A mesh of several
// primitives becomes an object with a child for each primitive, and gltfpack puts a mesh into a new node below the node
// with the extras.
function markAbove(mesh, extrasOf) {
  for (let object = mesh; object; object = object.parent) {
    const mark = extrasOf(object)?.chronormal;
    if (mark) return mark;
  }
}

// Drives a scene of three.js, which gives access to the extras of meshes and of nodes.
export function driveThree(scene) {
  scene.traverse((object) => {
    if (!object.morphTargetInfluences) return;
    const chronormal = markAbove(object, ({ userData }) => userData);
    if (chronormal) drive(chronormal, object.morphTargetInfluences);
  });
}

// Drives a scene of Babylon.js, which gives access to the extras of nodes.
export function driveBabylon(scene) {
  for (const mesh of scene.meshes) {
    const chronormal = markAbove(mesh, ({ metadata }) => metadata?.gltf?.extras);
    const targets = mesh.morphTargetManager;
    if (!chronormal || !targets) continue;
    const w = Array.from({ length: targets.numTargets }, (_, i) => targets.getTarget(i).influence);
    drive(chronormal, w);
    w.forEach((weight, i) => (targets.getTarget(i).influence = weight));
  }
}
