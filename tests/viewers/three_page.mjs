// Makes three.js a viewer of the test page. Uses the loader and the animation mixer of three.js, and its material that
// shows normals as colours.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { driveThree } from '../../examples/drive.mjs';
import * as live from '../../js/src/three.js';

let renderer;

export function rendererOf(size) {
  if (!renderer) renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(size.width, size.height, false);
  return renderer;
}

export async function load(bytes) {
  const gltf = await new GLTFLoader().parseAsync(bytes.buffer, '');
  const mixer = new THREE.AnimationMixer(gltf.scene);
  const scene = new THREE.Scene();
  scene.add(gltf.scene);
  return { scene, mixer, clips: gltf.animations };
}

// Poses the model as it is at `time`, in seconds, in an animation. Uses the animation mixer of three.js.
export function play(model, animation, time) {
  model.mixer.stopAllAction();
  if (animation === null) return;
  const action = model.mixer.clipAction(model.clips[animation]);
  action.reset().setLoop(THREE.LoopOnce, 1);
  action.clampWhenFinished = true;
  action.play();
  model.mixer.setTime(time);
}

// Sets the weights of the author's targets, which are the first targets of every mesh. drive() sets the weights of
// correction targets.
export function setWeights({ scene }, weights) {
  scene.traverse(({ morphTargetInfluences: w }) => w && weights.forEach((weight, i) => (w[i] = weight)));
}

// Replaces the model by a clone. On the clone, an animation mixer plays one clip for each weight, and blends the clips.
export function blend({ scene }, weights) {
  const [original] = scene.children, copy = original.clone(), mixer = new THREE.AnimationMixer(copy);
  scene.remove(original);
  scene.add(copy);
  weights.forEach((weight, k) => {
    const tracks = [];
    copy.traverse(({ name, morphTargetInfluences: w }) => {
      if (!w) return;
      const values = w.map((_, i) => (i === k ? weight * weights.length : 0));
      tracks.push(new THREE.NumberKeyframeTrack(`${name}.morphTargetInfluences`, [0], values));
    });
    mixer.clipAction(new THREE.AnimationClip(`clip ${k}`, 1, tracks)).setEffectiveWeight(1 / weights.length).play();
  });
  mixer.update(0.1);
}

export const drive = ({ scene }) => driveThree(scene);
export const attach = ({ scene }) => live.attach(scene);
export const detach = ({ scene }) => live.detach(scene);

export function dispose({ scene }) {
  scene.traverse(({ geometry }) => geometry?.dispose());
}

export function cameraOf({ eye, at, degrees, near, far }, size) {
  const camera = new THREE.PerspectiveCamera(degrees, size.width / size.height, near, far);
  camera.position.fromArray(eye);
  camera.lookAt(...at);
  return camera;
}

export const normalsAreOfView = true;

// Draws the normals in view space and returns the pixels as RGBA in float32: (n + 1) / 2 in RGB, and alpha 0 where
// nothing is drawn.
export async function drawNormals(model, view, size) {
  model.scene.traverse((object) => {
    if (!object.isMesh || object.material.isMeshNormalMaterial) return;
    const { flatShading, side } = object.material;
    object.material = new THREE.MeshNormalMaterial({ flatShading, side });
  });
  const target = new THREE.WebGLRenderTarget(size.width, size.height, { type: THREE.FloatType });
  const pixels = new Float32Array(4 * size.width * size.height);
  const drawing = rendererOf(size);
  drawing.setClearColor(0, 0);
  drawing.setRenderTarget(target);
  drawing.clear();
  drawing.render(model.scene, cameraOf(view, size));
  drawing.readRenderTargetPixels(target, 0, 0, size.width, size.height, pixels);
  drawing.setRenderTarget(null);
  target.dispose();
  return pixels;
}
