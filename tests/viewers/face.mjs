// Extracts a face from a file in which nothing drives the targets of the face. The result has only the face, without
// skins, and a new animation that activates all targets.
import { writeFileSync } from 'node:fs';
import { moves } from './judge.mjs';
import { describe, newIO } from './reader.mjs';

export async function writeMovingFace(input, output) {
  const document = await newIO().read(input);
  const root = document.getRoot();
  for (const animation of root.listAnimations()) animation.dispose();
  for (const skin of root.listSkins()) skin.dispose();
  const described = describe(document).meshes;
  const moving = root.listMeshes().filter((_, m) => moves(described[m]));
  const faces = root.listNodes().filter((node) => moving.includes(node.getMesh()));
  for (const node of root.listNodes()) if (!faces.includes(node)) node.setMesh(null);
  for (const face of faces) addAnimation(document, face);
  writeFileSync(output, await newIO().writeBinary(document));
}

// Adds an animation that activates the targets one after the other. Targets that were activated before keep a weight of
// 1/2.
function addAnimation(document, node) {
  const count = node.getMesh().listPrimitives()[0].listTargets().length;
  const rows = Array.from({ length: count + 1 }, (_, key) =>
    Array.from({ length: count }, (_, target) => (target + 1 === key ? 1 : target < key ? 0.5 : 0)));
  const buffer = document.getRoot().listBuffers()[0];
  const scalars = (numbers) => document.createAccessor().setArray(Float32Array.from(numbers)).setBuffer(buffer);
  const sampler = document.createAnimationSampler().setInterpolation('LINEAR');
  sampler.setInput(scalars(rows.keys())).setOutput(scalars(rows.flat()));
  const channel = document.createAnimationChannel().setTargetNode(node).setTargetPath('weights').setSampler(sampler);
  document.createAnimation('all targets').addSampler(sampler).addChannel(channel);
}
