// Drives baked files in Babylon.js. Before a scene is drawn, the weights of correction targets are computed from the
// weights that the application or an animation has set for the mesh's own targets. Babylon.js gives access to the
// extras of nodes, but not of meshes, so the formulas of the weights are read from the nodes.
import { formulasOf, markOf, weightOf } from './drive.js';

// The scenes that are driven. The key of an entry is a scene, and its value is {observer, driven}.
const attached = new WeakMap();

// Throws an error if a value is not a scene of Babylon.js. A caller may have passed a container of assets instead.
function demandScene(scene) {
  if (Array.isArray(scene?.meshes) && typeof scene.onBeforeRenderObservable?.add === 'function') return;
  throw new TypeError('attach() needs the scene of Babylon.js that shows the meshes, not a mesh or the result of a loader');
}

// Returns an entry for each MorphTargetManager to drive, with the meshes that use the manager. The weights belong to
// the manager, which a mesh and its clones share.
function drivenOf(scene) {
  const driven = new Map();
  for (const mesh of scene.meshes) {
    const manager = mesh.morphTargetManager;
    if (!manager) continue;
    if (!driven.has(manager)) {
      const count = manager.numTargets;
      const formulas = formulasOf(markOf(mesh, ({ metadata }) => metadata?.gltf?.extras), count);
      if (formulas.length > 0) driven.set(manager, { manager, formulas, w: new Float64Array(count), meshes: [] });
    }
    driven.get(manager)?.meshes.push(mesh);
  }
  return [...driven.values()];
}

/**
 * Drives all meshes of baked files that are in a scene, until detach(). For meshes that are added later, call attach()
 * again. Costs a few operations for each target and frame, and allocates nothing.
 * @param {import('@babylonjs/core').Scene} scene
 * @returns {import('@babylonjs/core').AbstractMesh[]} the meshes that have correction targets with formulas
 */
export function attach(scene) {
  demandScene(scene);
  if (attached.has(scene)) scene.onBeforeRenderObservable.remove(attached.get(scene).observer);
  const driven = drivenOf(scene);
  const observer = scene.onBeforeRenderObservable.add(() => {
    for (let d = 0; d < driven.length; ++d) {
      const { manager, formulas, w } = driven[d];
      for (let i = 0; i < w.length; ++i) w[i] = manager.getTarget(i).influence;
      for (let k = 0; k < formulas.length; ++k) {
        // Babylon.js does no work if the weight is the same as before.
        manager.getTarget(formulas[k].target).influence = weightOf(formulas[k], w);
      }
    }
  });
  attached.set(scene, { observer, driven });
  return driven.flatMap(({ meshes }) => meshes);
}

/** Stops driving the meshes of a scene, and sets the weights of correction targets to 0. */
export function detach(scene) {
  if (!attached.has(scene)) return;
  const { observer, driven } = attached.get(scene);
  attached.delete(scene);
  scene.onBeforeRenderObservable.remove(observer);
  for (const { manager, formulas } of driven) {
    for (const { target } of formulas) manager.getTarget(target).influence = 0;
  }
}
