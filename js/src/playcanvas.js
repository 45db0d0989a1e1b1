// Drives baked files in PlayCanvas. Before a frame is drawn, the weights of correction targets are computed from the
// weights that the application or an animation has set for the mesh's own targets. PlayCanvas gives no access to
// extras, but the resource of a container keeps the JSON of its file.
import { formulasOf, markOf, weightOf } from './drive.js';

// The applications that are driven. The key of an entry is an application, and its value is {update, driven}.
const attached = new WeakMap();

// Throws an error if a value is not an application of PlayCanvas.
function demandApplication(app) {
  if (typeof app?.root?.findComponents === 'function' && typeof app.on === 'function') return;
  throw new TypeError('attach() needs the application of PlayCanvas as its first argument');
}

// Throws an error if a value is not a loaded container of PlayCanvas.
function demandContainer(asset) {
  if (asset?.resource?.data?.gltf && Array.isArray(asset.resource.data.renders)) return;
  throw new TypeError('attach() needs loaded assets of PlayCanvas of the type container after the application; call it after the assets are ready');
}

// Returns the mark (extras.chronormal) of each PlayCanvas mesh of a container. A PlayCanvas mesh is a primitive of the
// file.
function marksOf({ gltf, renders }) {
  const nodes = (gltf.nodes ?? []).map((node) => ({ extras: node.extras, mesh: node.mesh }));
  gltf.nodes?.forEach(({ children = [] }, i) => children.forEach((child) => (nodes[child].parent = nodes[i])));
  const marks = new Map();
  renders.forEach(({ meshes }, i) => {
    const mesh = { extras: gltf.meshes[i].extras, parent: nodes.find((node) => node.mesh === i) };
    const mark = markOf(mesh, ({ extras }) => extras);
    for (const primitive of meshes ?? []) marks.set(primitive, mark);
  });
  return marks;
}

/**
 * Drives all meshes of a baked file that an application shows, until detach(). For entities that are added later, call
 * attach() again. Costs a few operations for each target and frame, and allocates nothing.
 * @param {import('playcanvas').AppBase} app
 * @param {...import('playcanvas').Asset} assets containers, loaded
 * @returns {import('playcanvas').MeshInstance[]} the meshes that have correction targets with formulas
 */
export function attach(app, ...assets) {
  demandApplication(app);
  assets.forEach(demandContainer);
  if (attached.has(app)) app.off('prerender', attached.get(app).update);
  const marks = new Map(assets.flatMap(({ resource }) => [...marksOf(resource.data)]));
  const driven = [...(attached.get(app)?.driven ?? [])].filter(({ meshInstance }) => !marks.has(meshInstance.mesh));
  for (const { meshInstances } of app.root.findComponents('render')) {
    for (const meshInstance of meshInstances) {
      const { mesh, morphInstance } = meshInstance;
      const count = morphInstance?.morph.targets.length ?? 0;
      const formulas = formulasOf(marks.get(mesh), count);
      if (formulas.length > 0) driven.push({ meshInstance, formulas, w: new Float64Array(count) });
    }
  }
  const update = () => {
    for (let d = 0; d < driven.length; ++d) {
      const { meshInstance: { morphInstance }, formulas, w } = driven[d];
      if (!morphInstance) continue; // the instance was destroyed after attach()
      for (let i = 0; i < w.length; ++i) w[i] = morphInstance.getWeight(i);
      for (let k = 0; k < formulas.length; ++k) {
        const { target } = formulas[k], weight = weightOf(formulas[k], w);
        if (w[target] !== weight) morphInstance.setWeight(target, weight);
      }
    }
  };
  app.on('prerender', update);
  attached.set(app, { update, driven });
  return driven.map(({ meshInstance }) => meshInstance);
}

/** Stops driving the meshes of an application, and sets the weights of correction targets to 0. */
export function detach(app) {
  if (!attached.has(app)) return;
  const { update, driven } = attached.get(app);
  attached.delete(app);
  app.off('prerender', update);
  for (const { meshInstance: { morphInstance }, formulas } of driven) {
    for (const { target } of formulas) morphInstance?.setWeight(target, 0);
  }
}
