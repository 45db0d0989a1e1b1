// Makes PlayCanvas a viewer of the test page. Uses the loader, the animation component and the glTF material of
// PlayCanvas. The material can show normals as colours.
import {
  ADDRESS_CLAMP_TO_EDGE, AnimClipHandler, AnimComponentSystem, AppBase, AppOptions, Asset, CameraComponentSystem, Color,
  ContainerHandler, Entity, FILTER_NEAREST, MaterialHandler, PIXELFORMAT_RGBA32F, RenderComponentSystem, RenderHandler,
  RenderTarget, SHADERPASS_WORLDNORMAL, Texture, TextureHandler, Vec3, createGraphicsDevice,
} from 'playcanvas';

import * as live from '../../js/src/playcanvas.js';

let app;
let loaded = 0;  // makes names unique, since PlayCanvas loads files of the same name only once

async function createApp() {
  const canvas = document.createElement('canvas');
  const options = new AppOptions();
  options.graphicsDevice = await createGraphicsDevice(canvas, { deviceTypes: ['webgl2'], antialias: false });
  options.componentSystems = [AnimComponentSystem, CameraComponentSystem, RenderComponentSystem];
  options.resourceHandlers = [AnimClipHandler, ContainerHandler, MaterialHandler, RenderHandler, TextureHandler];
  const created = new AppBase(canvas);
  created.init(options);
  created.autoRender = false;
  created.start();
  return created;
}

export async function load(bytes) {
  app ??= await createApp();
  const asset = new Asset('model', 'container', { url: `${++loaded}.glb`, contents: bytes.slice().buffer });
  app.assets.add(asset);
  await new Promise((resolve, reject) => {
    asset.once('load', resolve);
    asset.once('error', reject);
    app.assets.load(asset);
  });
  const entity = asset.resource.instantiateRenderEntity();
  entity.enabled = false;  // only enabled entities are drawn
  app.root.addChild(entity);
  return { asset, entity };
}

// Poses the model as it is at `time`, in seconds, in an animation. Uses the animation component of PlayCanvas.
export function play({ asset, entity }, animation, time) {
  if (animation === null) return;
  entity.removeComponent('anim');
  entity.addComponent('anim', { activate: true });
  entity.anim.assignAnimation('move', asset.resource.animations[animation].resource);
  entity.anim.baseLayer.play('move');
  entity.anim.baseLayer.activeStateCurrentTime = time;
  entity.anim.update(0);
  entity.anim.playing = false;
}

// Sets the weights of the author's targets, which are the first targets of every mesh.
export function setWeights({ entity }, weights) {
  for (const { meshInstances } of entity.findComponents('render'))
    for (const { morphInstance } of meshInstances)
      if (morphInstance) weights.forEach((weight, i) => morphInstance.setWeight(i, weight));
}

export const attach = ({ asset }) => live.attach(app, asset);
export const detach = () => live.detach(app);

export function dispose({ asset, entity }) {
  entity.destroy();
  app.assets.remove(asset);
  asset.unload();
}

// Draws the normals in world space and returns the pixels as RGBA in float32: (n + 1) / 2 in RGB, and alpha 0 where
// nothing is drawn.
export async function drawNormals({ entity }, { eye, at, degrees, near, far }, size) {
  const device = app.graphicsDevice;
  const colorBuffer = new Texture(device, {
    ...size,
    format: PIXELFORMAT_RGBA32F,
    mipmaps: false,
    minFilter: FILTER_NEAREST,
    magFilter: FILTER_NEAREST,
    addressU: ADDRESS_CLAMP_TO_EDGE,
    addressV: ADDRESS_CLAMP_TO_EDGE,
  });
  const renderTarget = new RenderTarget({ colorBuffer, depth: true, flipY: false });
  const camera = new Entity('camera');
  camera.addComponent('camera', {
    renderTarget,
    clearColor: new Color(0, 0, 0, 0),
    fov: degrees,
    nearClip: near,
    farClip: far,
  });
  camera.camera.setShaderPass(SHADERPASS_WORLDNORMAL);
  camera.setPosition(...eye);
  camera.lookAt(new Vec3(at));
  app.root.addChild(camera);
  entity.enabled = true;
  app.render();
  const pixels = await colorBuffer.read(0, 0, size.width, size.height, { renderTarget, immediate: true });
  camera.destroy();
  renderTarget.destroy();
  colorBuffer.destroy();
  entity.enabled = false;
  return pixels;
}
