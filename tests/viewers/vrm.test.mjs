// Tests the avatars of docs/viewers.md with the code on that page. A bake corrects an avatar, and three-vrm loads the
// result. Expressions of the avatar set the weights of targets, and a face tracker sets weights by name. This test runs
// in Node.js; viewers.test.mjs tests the pixels that are drawn with such weights.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { VRMLoaderPlugin, VRMUtils } from '@pixiv/three-vrm';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { attach, detach } from '../../js/src/three.js';
import { ExactNormals, angle } from './exact.mjs';
import { writeStill } from './fixtures.mjs';
import { chronormal } from './program.mjs';
import { read, shownNormals } from './reader.mjs';

const folder = mkdtempSync(join(tmpdir(), 'chronormal-vrm-'));
after(() => rmSync(folder, { recursive: true, force: true }));

const BONES = ['hips', 'spine', 'head', ...['left', 'right'].flatMap((side) =>
  ['UpperLeg', 'LowerLeg', 'Foot', 'UpperArm', 'LowerArm', 'Hand'].map((bone) => side + bone))];
const EXPRESSIONS = { happy: [[0, 1]], aa: [[1, 0.75]] }; // [target, weight]

// Returns a GLB file with JSON that change() has changed.
function withJson(glb, change) {
  const size = glb.readUInt32LE(12), json = JSON.parse(glb.subarray(20, 20 + size).toString());
  change(json);
  const text = Buffer.from(JSON.stringify(json)), padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, ' ')]);
  const head = Buffer.from(glb.subarray(0, 20));
  head.writeUInt32LE(padded.length, 12);
  head.writeUInt32LE(glb.length - size + padded.length, 8);
  return Buffer.concat([head, padded, glb.subarray(20 + size)]);
}

// Writes the smallest avatar that three-vrm accepts: the required bones, and two expressions.
async function writeAvatar(path) {
  await writeStill(join(folder, 'still.glb'), { parts: 1 });
  const glb = withJson(readFileSync(join(folder, 'still.glb')), (json) => {
    const face = json.nodes.findIndex(({ mesh }) => mesh === 0), first = json.nodes.length;
    BONES.forEach((name) => json.nodes.push({ name }));
    json.scenes[0].nodes.push(...BONES.map((_, b) => first + b));
    json.meshes[0].extras = { ...json.meshes[0].extras, targetNames: ['smile', 'jawOpen'] };
    const preset = Object.fromEntries(Object.entries(EXPRESSIONS).map(([name, binds]) => [
      name, { morphTargetBinds: binds.map(([index, weight]) => ({ node: face, index, weight })) }]));
    json.extensionsUsed = ['VRMC_vrm'];
    json.extensions = {
      VRMC_vrm: {
        specVersion: '1.0',
        meta: { name: 'avatar', authors: ['nobody'], licenseUrl: 'https://vrm.dev/licenses/1.0/' },
        humanoid: { humanBones: Object.fromEntries(BONES.map((name, b) => [name, { node: first + b }])) },
        expressions: { preset },
      },
    };
  });
  writeFileSync(path, glb);
}

const avatar = join(folder, 'avatar.vrm'), baked = join(folder, 'avatar.right.vrm');
await writeAvatar(avatar);
chronormal('bake', avatar, baked, '--poses', 'random', '--weighting', 'area', '--for', 'three');

async function load(path) {
  globalThis.self ??= globalThis; // the loader of three-vrm needs this variable
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser));
  const { buffer, byteOffset, byteLength } = readFileSync(path);
  const { scene, userData } = await loader.parseAsync(buffer.slice(byteOffset, byteOffset + byteLength), '');
  let face;
  scene.traverse((object) => object.morphTargetInfluences && (face = object));
  return { vrm: userData.vrm, scene, face };
}

const draw = (face) => face.onBeforeRender(null, null, null, face.geometry, face.material, null);

// Returns the average angle, in degrees, between the normals rendered with the weights of `face` and the normals of the
// surface.
async function errorOf(face) {
  const [mesh] = (await read(baked)).meshes, [primitive] = mesh.primitives, w = face.morphTargetInfluences;
  const own = new ExactNormals((await read(avatar)).meshes[0]).at(Float32Array.from(w.slice(0, 2)))[0];
  const shown = shownNormals(primitive, w), count = shown.length / 3;
  const of = (array, v) => array.subarray(3 * v, 3 * v + 3);
  let sum = 0;
  for (let v = 0; v < count; ++v) sum += angle(of(shown, v), of(own.directions, v));
  return sum / count;
}

test('expressions of three-vrm drive the extra targets of an avatar', async (context) => {
  const { vrm, scene, face } = await load(baked);
  assert.equal(vrm.meta.metaVersion, '1');
  vrm.expressionManager.setValue('happy', 0.8);
  vrm.expressionManager.setValue('aa', 0.8);
  vrm.update(1 / 60);
  draw(face);
  assert.ok(Math.abs(face.morphTargetInfluences[1] - 0.6) < 1e-6);
  const before = await errorOf(face);
  assert.deepEqual(attach(scene), [face]);
  vrm.update(1 / 60);
  draw(face);
  const during = await errorOf(face);
  context.diagnostic(`${before} -> ${during} degrees in the mean`);
  assert.ok(face.morphTargetInfluences.slice(2).some((weight) => weight !== 0));
  assert.ok(during < 0.25 * before && before > 3, `${before} -> ${during}`);
  detach(scene);
  assert.equal(await errorOf(face), before);
});

test('weights that a tracker sets by name drive them too', async () => {
  const { scene, face } = await load(baked);
  attach(scene);
  const found = { smile: 0.5, jawOpen: 0.7, browInnerUp: 0.2 };
  for (const [name, weight] of Object.entries(found)) {
    const target = face.morphTargetDictionary[name];
    if (target !== undefined) face.morphTargetInfluences[target] = weight;
  }
  draw(face);
  assert.deepEqual(face.morphTargetInfluences.slice(0, 2), [0.5, 0.7]);
  assert.ok((await errorOf(face)) < 2, `${await errorOf(face)}`);
});

test('an avatar whose morphs three-vrm has combined is left alone', async () => {
  const { vrm, scene } = await load(baked);
  VRMUtils.combineMorphs(vrm);
  assert.deepEqual(attach(scene), []);
});
