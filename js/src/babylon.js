// Baked files in Babylon.js: before a scene is drawn, extra targets get the weights that belong to what the application, or
// an animation, has set for the targets of the mesh itself. Babylon.js hands on the extras of nodes, not those of meshes.
import { formulasOf, markOf, weightOf } from './drive.js';

const observers = new WeakMap(); // of each scene

function drivenMeshes(scene) {
  const driven = [];
  for (const mesh of scene.meshes) {
    const manager = mesh.morphTargetManager;
    if (!manager || driven.some((other) => other.manager === manager)) continue; // an instance shares that of its mesh
    const formulas = formulasOf(markOf(mesh, ({ metadata }) => metadata?.gltf?.extras));
    const known = formulas.filter(({ target }) => target < manager.numTargets);
    if (known.length > 0) driven.push({ mesh, manager, formulas: known, w: new Float64Array(manager.numTargets) });
  }
  return driven;
}

/**
 * Drives all meshes of baked files that are in a scene, until detach(). Meshes that come later need another attach().
 * Costs a few operations for each target and frame, and allocates nothing.
 * @param {import('@babylonjs/core').Scene} scene
 * @returns {import('@babylonjs/core').AbstractMesh[]} the meshes that have extra targets with formulas
 */
export function attach(scene) {
  detach(scene);
  const driven = drivenMeshes(scene);
  const observer = scene.onBeforeRenderObservable.add(() => {
    for (let d = 0; d < driven.length; ++d) {
      const { mesh, manager, formulas, w } = driven[d];
      if (mesh.isDisposed()) continue;
      for (let i = 0; i < w.length; ++i) w[i] = manager.getTarget(i).influence;
      for (let k = 0; k < formulas.length; ++k) {
        const weight = weightOf(formulas[k], w), target = manager.getTarget(formulas[k].target);
        if (target.influence !== weight) target.influence = weight;
      }
    }
  });
  observers.set(scene, { observer, driven });
  return driven.map(({ mesh }) => mesh);
}

/** Leaves the meshes of a scene to the application again; extra targets get the weight 0. */
export function detach(scene) {
  const attached = observers.get(scene);
  if (!attached) return;
  scene.onBeforeRenderObservable.remove(attached.observer);
  observers.delete(scene);
  for (const { mesh, manager, formulas } of attached.driven) {
    if (mesh.isDisposed()) continue;
    for (const { target } of formulas) manager.getTarget(target).influence = 0;
  }
}
