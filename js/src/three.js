// Baked files in three.js: before a mesh is drawn, its extra targets get the weights that belong to what the application,
// or a mixer, has set for the targets of the mesh itself.
import { drive, formulasOf, markOf } from './drive.js';

const attached = new WeakMap(); // of each mesh: what it did before it was drawn

/**
 * Drives all meshes of a baked file below an object, until detach(). A clone has to be attached itself: three.js does not
 * copy what is done before drawing. Costs a few operations for each extra target and drawing, and allocates nothing.
 * @param {import('three').Object3D} root
 * @returns {import('three').Mesh[]} the meshes that have extra targets with formulas
 */
export function attach(root) {
  const meshes = [];
  root.traverse((mesh) => {
    const w = mesh.morphTargetInfluences;
    if (!w) return;
    const formulas = formulasOf(markOf(mesh, ({ userData }) => userData)).filter(({ target }) => target < w.length);
    if (formulas.length === 0) return;
    meshes.push(mesh);
    if (attached.has(mesh)) return;
    const before = Object.hasOwn(mesh, 'onBeforeRender') ? mesh.onBeforeRender : undefined;
    attached.set(mesh, before);
    mesh.onBeforeRender = function (renderer, scene, camera, geometry, material, group) {
      before?.call(this, renderer, scene, camera, geometry, material, group);
      drive(formulas, this.morphTargetInfluences);
    };
  });
  return meshes;
}

/** Leaves the meshes below an object to the application again; extra targets get the weight 0. */
export function detach(root) {
  root.traverse((mesh) => {
    if (!attached.has(mesh)) return;
    const before = attached.get(mesh);
    if (before) mesh.onBeforeRender = before;
    else delete mesh.onBeforeRender;
    attached.delete(mesh);
    const mark = markOf(mesh, ({ userData }) => userData);
    for (const { target } of formulasOf(mark)) mesh.morphTargetInfluences[target] = 0;
  });
}
