// Gives the extra targets of a baked file their weights: what a program does that sets weights by itself, instead of
// playing the animations of the file. `chronormal` is extras.chronormal of the mesh, or of a node that carries it.

// The weight of one extra target, from the weights w of the mesh's own targets.
function weightOf({ linear, quadratic }, w) {
  let sum = 0;
  for (const [i, a] of linear) sum += a * w[i];
  for (const [i, j, q] of quadratic) sum += q * w[i] * w[j];
  return sum;
}

// Writes the weights of all extra targets into w.
export function drive(chronormal, w) {
  for (const extra of chronormal.extras) w[extra.target] = weightOf(extra, w);
}

// three.js hands on the extras of meshes and of nodes.
export function driveThree(scene) {
  scene.traverse(({ userData: { chronormal }, morphTargetInfluences }) => {
    if (chronormal && morphTargetInfluences) drive(chronormal, morphTargetInfluences);
  });
}

// Babylon.js hands on those of nodes; a mesh of several primitives is a node with a child for each.
export function driveBabylon(scene) {
  for (const mesh of scene.meshes) {
    const node = mesh.metadata?.gltf?.extras ? mesh : mesh.parent;
    const chronormal = node?.metadata?.gltf?.extras?.chronormal;
    const targets = mesh.morphTargetManager;
    if (!chronormal || !targets) continue;
    const w = Array.from({ length: targets.numTargets }, (_, i) => targets.getTarget(i).influence);
    drive(chronormal, w);
    w.forEach((weight, i) => (targets.getTarget(i).influence = weight));
  }
}
