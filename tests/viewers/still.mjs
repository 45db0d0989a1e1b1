// Makes a still file from a moving file at one time, with the positions and the exact normals that the mesh has at this
// time. A viewer should draw the moving file at this time exactly as it draws the still file.
import { Accessor, getBounds } from '@gltf-transform/core';
import { cloneDocument } from '@gltf-transform/functions';
import { ExactNormals, exactPositions, length } from './exact.mjs';
import { describe, newIO, nodeWeights } from './reader.mjs';

// The field of view in degrees, and the direction of the camera, from which three sides of a box are visible.
const VIEW_DEGREES = 35;
const VIEW_FROM = [0.5, 0.45, 1];

// Returns {time, truth, view} for each time. `truth` is the still file as GLB in base64, and `view` is a camera that
// sees the whole mesh.
export async function stillMoments(path, animation, times) {
  const io = newIO();
  const source = await io.read(path);
  const file = describe(source);
  const exact = file.meshes.map((mesh) => (mesh.weights.length > 0 ? new ExactNormals(mesh) : null));
  const moments = [];
  for (const time of times) {
    const document = cloneDocument(source);
    const root = document.getRoot();
    const meshes = root.listMeshes();
    root.listNodes().filter((node) => node.getMesh()).forEach((node, n) => {
      const { mesh: m } = file.nodes[n];
      if (!exact[m]) return;
      const weights = nodeWeights(file, n, file.animations[animation], time);
      node.setMesh(frozen(document, meshes[m], file.meshes[m], exact[m], weights)).setWeights([]);
    });
    root.listAnimations().forEach((moving) => moving.dispose());
    // Filament aborts if a file has a mesh with targets that no node uses.
    const shown = new Set(root.listNodes().map((node) => node.getMesh()));
    for (const mesh of meshes) if (!shown.has(mesh)) mesh.dispose();
    moments.push({
      time,
      truth: Buffer.from(await io.writeBinary(document)).toString('base64'),
      view: viewOf(root.getDefaultScene() ?? root.listScenes()[0]),
    });
  }
  return moments;
}

function frozen(document, mesh, described, exact, weights) {
  const result = document.createMesh(mesh.getName());
  const truth = exact.at(weights);
  mesh.listPrimitives().forEach((primitive, p) => {
    const still = primitive.clone();
    still.listTargets().forEach((target) => still.removeTarget(target));
    const replace = (name, numbers) => {
      const accessor = document.createAccessor().setType(Accessor.Type.VEC3).setArray(Float32Array.from(numbers));
      still.setAttribute(name, accessor.setBuffer(document.getRoot().listBuffers()[0]));
    };
    replace('POSITION', exactPositions(described.primitives[p], weights));
    if (truth[p]) replace('NORMAL', unit(truth[p].directions));
    result.addPrimitive(still);
  });
  return result;
}

function unit(directions) {
  const result = Float64Array.from(directions);
  for (let i = 0; i < result.length; i += 3) {
    const size = length(result.subarray(i, i + 3)) || 1;
    for (let c = 0; c < 3; ++c) result[i + c] /= size;
  }
  return result;
}

function viewOf(scene) {
  const { min, max } = getBounds(scene);
  const at = min.map((low, c) => (low + max[c]) / 2);
  const radius = length(min.map((low, c) => max[c] - low)) / 2;
  const distance = radius / Math.sin((VIEW_DEGREES * Math.PI) / 360);
  const from = VIEW_FROM.map((c) => (c * distance) / length(VIEW_FROM));
  return {
    eye: at.map((c, i) => c + from[i]),
    at,
    degrees: VIEW_DEGREES,
    near: distance - 1.1 * radius,
    far: distance + 1.1 * radius,
  };
}
