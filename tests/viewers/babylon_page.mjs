// Makes Babylon.js a viewer of the test page. Uses the loader, the animation groups and the glTF material of
// Babylon.js. The material can show normals as colours.
import { Animation } from '@babylonjs/core/Animations/animation.js';
import { AnimationGroup } from '@babylonjs/core/Animations/animationGroup.js';
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import { ImportMeshAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { PBRMaterial } from '@babylonjs/core/Materials/PBR/pbrMaterial.js';
import { RenderTargetTexture } from '@babylonjs/core/Materials/Textures/renderTargetTexture.js';
import { Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { Scene } from '@babylonjs/core/scene.js';
import '@babylonjs/loaders/glTF/2.0/index.js';
import { driveBabylon } from '../../examples/drive.mjs';
import * as live from '../../js/src/babylon.js';

const FRAMES_PER_SECOND = 60;  // the loader multiplies times in seconds by this number
const SHADED_NORMALS = 5;      // the value of PBRMaterial.debugMode that shows normals as colours

let engine;

export async function load(bytes) {
  engine ??= new Engine(document.createElement('canvas'), false);
  const scene = new Scene(engine);
  scene.useRightHandedSystem = true;
  const url = `data:model/gltf-binary;base64,${toBase64(bytes)}`;
  await ImportMeshAsync(url, scene, { pluginExtension: '.glb' });
  scene.animationGroups.forEach((group) => group.stop());
  return { scene };
}

function toBase64(bytes) {
  let text = '';
  for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
  return btoa(text);
}

// Poses the model as it is at `time`, in seconds, in an animation. Uses the animation group that the loader made of the
// animation.
export function play(model, animation, time) {
  model.scene.animationGroups.forEach((group) => group.stop());
  if (animation === null) return;
  const group = model.scene.animationGroups[animation];
  group.start(false);
  group.pause();
  group.goToFrame(time * FRAMES_PER_SECOND);
}

// Sets the weights of the author's targets, which are the first targets of every mesh. drive() sets the weights of
// correction targets.
export function setWeights({ scene }, weights) {
  for (const { morphTargetManager } of scene.meshes)
    if (morphTargetManager)
      weights.forEach((weight, i) => (morphTargetManager.getTarget(i).influence = weight));
}

// Makes Babylon.js blend animations so that the targets get these weights. Plays one animation group for each weight,
// and every group has the same share in the blend.
export function blend({ scene }, weights) {
  weights.forEach((weight, k) => {
    const group = new AnimationGroup(`group ${k}`, scene);
    for (const { morphTargetManager: targets } of scene.meshes) {
      for (let i = 0; targets && i < targets.numTargets; ++i) {
        const value = i === k ? weight * weights.length : 0;
        const animation = new Animation(`${k} of ${i}`, 'influence', FRAMES_PER_SECOND, Animation.ANIMATIONTYPE_FLOAT);
        animation.setKeys([0, FRAMES_PER_SECOND].map((frame) => ({ frame, value })));
        group.addTargetedAnimation(animation, targets.getTarget(i));
      }
    }
    group.start(true);
    group.setWeightForAllAnimatables(1 / weights.length);
  });
}

export const drive = ({ scene }) => driveBabylon(scene);
export const attach = ({ scene }) => live.attach(scene);
export const detach = ({ scene }) => live.detach(scene);

export const dispose = ({ scene }) => scene.dispose();

// Draws the normals in world space and returns the pixels as RGBA in float32: (n + 1) / 2 in RGB, and alpha 0 where
// nothing is drawn.
export async function drawNormals({ scene }, { eye, at, degrees, near, far }, size) {
  engine.setSize(size.width, size.height);
  const camera = new FreeCamera('camera', Vector3.FromArray(eye), scene);
  camera.setTarget(Vector3.FromArray(at));
  camera.fov = (degrees * Math.PI) / 180;
  camera.minZ = near;
  camera.maxZ = far;
  scene.activeCamera = camera;
  const meshes = scene.meshes.filter((mesh) => mesh.getTotalVertices() > 0);
  for (const mesh of meshes) {
    mesh.material ??= new PBRMaterial('default', scene);
    mesh.material.debugMode = SHADED_NORMALS;
  }
  const target = new RenderTargetTexture('normals', size, scene, {
    type: Constants.TEXTURETYPE_FLOAT,
    generateMipMaps: false,
    gammaSpace: false,
  });
  target.renderList = meshes;
  target.activeCamera = camera;
  target.clearColor = new Color4(0, 0, 0, 0);
  scene.customRenderTargets = [target];
  while (!target.isReadyForRendering()) await new Promise((resolve) => setTimeout(resolve, 5));
  scene.render();
  const pixels = await target.readPixels();
  scene.customRenderTargets = [];
  target.dispose();
  camera.dispose();
  return pixels;
}
