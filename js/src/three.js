// Drives baked files in three.js. Before a mesh is drawn, the weights of its correction targets are computed from the
// weights that the application or a mixer has set for the mesh's own targets.
import { drive as driveBy, formulasOf, markOf } from './drive.js';

// The meshes that are driven. The key of an entry is a mesh, and its value is {formulas, before, now}: `before` is the
// own onBeforeRender() of the mesh before attach(), and `now` is the function that attach() has put in its place.
const attached = new WeakMap();

// Throws an error if a value is not an object of three.js. A caller may have passed the result of a loader instead.
function demandObject(name, root) {
  if (typeof root?.traverse === 'function') return;
  const hint = typeof root?.scene?.traverse === 'function' ? '; the result of a loader is no object: pass its member scene, as gltf.scene' : '';
  throw new TypeError(`${name}() needs an Object3D of three.js${hint}`);
}

function formulasOfMesh(mesh) {
  const w = mesh.morphTargetInfluences;
  return w ? formulasOf(markOf(mesh, ({ userData }) => userData), w.length) : [];
}

/**
 * Drives all meshes of a baked file below an object, until detach(). Call attach() for a clone as well, because
 * three.js does not copy functions that run before drawing. Costs a few operations for each correction target and
 * drawing, and allocates nothing.
 * @param {import('three').Object3D} root
 * @returns {import('three').Mesh[]} the meshes that have correction targets with formulas
 */
export function attach(root) {
  demandObject('attach', root);
  const meshes = [];
  root.traverse((mesh) => {
    const formulas = attached.get(mesh)?.formulas ?? formulasOfMesh(mesh);
    if (formulas.length === 0) return;
    meshes.push(mesh);
    if (attached.has(mesh)) return;
    const before = Object.hasOwn(mesh, 'onBeforeRender') ? mesh.onBeforeRender : undefined;
    const now = function (renderer, scene, camera, geometry, material, group) {
      before?.call(this, renderer, scene, camera, geometry, material, group);
      if (attached.get(this)?.now === now) driveBy(formulas, this.morphTargetInfluences);
    };
    attached.set(mesh, { formulas, before, now });
    mesh.onBeforeRender = now;
  });
  return meshes;
}

/** Stops driving the meshes below an object, and sets the weights of their correction targets to 0. */
export function detach(root) {
  demandObject('detach', root);
  root.traverse((mesh) => {
    if (!attached.has(mesh)) return;
    const { formulas, before, now } = attached.get(mesh);
    attached.delete(mesh);
    // If other code has wrapped the function `now` since attach(), the wrapper stays, and the wrapped function does
    // nothing any more.
    if (mesh.onBeforeRender === now) {
      if (before) mesh.onBeforeRender = before;
      else delete mesh.onBeforeRender;
    }
    for (const { target } of formulas) mesh.morphTargetInfluences[target] = 0;
  });
}

/**
 * Sets the weights of correction targets below an object once. Use this function for meshes that are not drawn
 * themselves but whose weights InstancedMesh.setMorphAt() takes.
 * @param {import('three').Object3D} root
 */
export function drive(root) {
  demandObject('drive', root);
  root.traverse((mesh) => driveBy(attached.get(mesh)?.formulas ?? formulasOfMesh(mesh), mesh.morphTargetInfluences));
}
