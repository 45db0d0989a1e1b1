// Makes Filament a viewer of the test page. Uses the loader and the animator of Filament, and a light under which its
// glTF material shows normals as colours. browser.mjs loads `Filament` itself into the page.
//
// The light comes from all sides, with the irradiance (n + 1) / 2 in three colours for a surface with the normal n.
// Under this light, a white and rough surface shows k (n + 1) / 2, where k depends on the material and the view. Under
// a light of 1 from all sides, the same surface shows k, so the quotient of the two pictures gives n.

// The light that shows normals as colours, as coefficients of spherical harmonics in RGB, in the order 1, y, z, x.
const NORMALS = [0.5, 0.5, 0.5, 0, 0.5, 0, 0, 0, 0.5, 0.5, 0, 0];
const WHITE_MATERIAL = { metallicFactor: 0, roughnessFactor: 1 };
const WHITE = [1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
const EXPOSURE = [16, 1 / 125, 100];  // aperture, shutter and sensitivity
const INTENSITY = 38_400;  // at this intensity and exposure, a white light makes a white surface white (1)
const JSON_AT = 20;

let viewer;

function createViewer() {
  const { Filament } = window;
  const gl = framebuffersNoted(document.createElement('canvas').getContext('webgl2'));
  const engine = Filament.Engine.create(gl.canvas);
  const light = (sh) => Filament.IndirectLight.Builder().irradianceSh(2, sh).intensity(INTENSITY).build(engine);
  const camera = engine.createCamera(Filament.EntityManager.get().create());
  camera.setExposure(...EXPOSURE);
  const scene = engine.createScene();
  const view = engine.createView();
  view.setCamera(camera);
  view.setScene(scene);
  const renderer = engine.createRenderer();
  renderer.setClearOptions({ clearColor: [0, 0, 0, 0], clear: true });
  const lights = [NORMALS, WHITE].map(light);
  const [swapChain, loader] = [engine.createSwapChain(), engine.createAssetLoader()];
  return { gl, camera, engine, lights, loader, renderer, scene, swapChain, view };
}

// Remembers the framebuffer of the last drawing, since Filament has no JavaScript function that reads pixels.
function framebuffersNoted(gl) {
  const bind = gl.bindFramebuffer.bind(gl);
  gl.bindFramebuffer = (target, framebuffer) => {
    if (framebuffer) gl.lastFramebuffer = framebuffer;
    bind(target, framebuffer);
  };
  return gl;
}

export const load = (bytes) => loadAs(bytes, WHITE_MATERIAL);

async function loadAs(bytes, material) {
  if (!window.Filament.isReady) await new Promise((resolve) => window.Filament.init([], resolve));
  viewer ??= createViewer();
  const asset = viewer.loader.createAsset(withMaterial(bytes, material));
  await new Promise((resolve) => asset.loadResources(resolve, null, null, 1));
  return { asset, animator: asset.getInstance().getAnimator() };
}

// Returns a GLB file in which all meshes have the same material without textures.
function withMaterial(bytes, pbrMetallicRoughness) {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(JSON_AT, JSON_AT + length)));
  const old = json.materials ?? [];
  json.materials = [false, true].map((doubleSided) => ({ pbrMetallicRoughness, doubleSided }));
  for (const { primitives } of json.meshes)
    for (const primitive of primitives) primitive.material = old[primitive.material]?.doubleSided ? 1 : 0;
  const text = new TextEncoder().encode(JSON.stringify(json));
  const rest = bytes.subarray(JSON_AT + length);
  const result = new Uint8Array(JSON_AT + 4 * Math.ceil(text.length / 4) + rest.length).fill(0x20);
  result.set(bytes.subarray(0, JSON_AT));
  result.set(text, JSON_AT);
  result.set(rest, result.length - rest.length);
  const header = new DataView(result.buffer);
  header.setUint32(8, result.length, true);
  header.setUint32(12, result.length - rest.length - JSON_AT, true);
  return result;
}

// Poses the model as it is at `time`, in seconds, in an animation. At the end of the animation, Filament's animator
// starts again from the beginning.
export function play({ animator }, animation, time) {
  if (animation !== null) animator.applyAnimation(animation, time);
}

export function dispose({ asset }) {
  viewer.loader.destroyAsset(asset);
}

// Draws the normals in world space and returns the pixels as RGBA in float32: (n + 1) / 2 in RGB, and alpha 0 where
// nothing is drawn.
export async function drawNormals({ asset }, viewed, size) {
  const { engine, lights, scene, view } = viewer;
  const { Filament } = window;
  const texture = (format, usage) => {
    const builder = Filament.Texture.Builder().width(size.width).height(size.height).levels(1);
    return builder.format(Filament.Texture$InternalFormat[format]).usage(usage).build(engine);
  };
  const [colors, depths] = [texture('RGBA32F', 1), texture('DEPTH24', 2)];
  const { COLOR, DEPTH } = Filament.RenderTarget$AttachmentPoint;
  const target = Filament.RenderTarget.Builder().texture(COLOR, colors).texture(DEPTH, depths).build(engine);
  view.setRenderTarget(target);
  view.setPostProcessingEnabled(false);
  lookFrom(viewed, size);
  const entities = asset.getRenderableEntities();
  entities.forEach((entity) => scene.addEntity(entity));
  const normals = await drawn(lights[0], size);
  const white = await drawn(lights[1], size);
  entities.forEach((entity) => scene.remove(entity));
  engine.destroyRenderTarget(target);
  [colors, depths].forEach((made) => engine.destroyTexture(made));
  return normals.map((value, i) => (i % 4 === 3 ? value : value / white[i]));
}

function lookFrom({ eye, at, degrees, near, far }, size) {
  const { Camera$Fov } = window.Filament;
  viewer.view.setViewport([0, 0, size.width, size.height]);
  viewer.camera.lookAt(eye, at, [0, 1, 0]);
  viewer.camera.setProjectionFov(degrees, size.width / size.height, near, far, Camera$Fov.VERTICAL);
}

async function render(light) {
  const { engine, renderer, scene, swapChain, view } = viewer;
  scene.setIndirectLight(light);
  // Filament refuses to draw a frame until the browser, in a separate task, has reported that an earlier frame is
  // finished.
  while (!renderer.beginFrame(swapChain)) {
    engine.execute();
    await new Promise((resolve) => setTimeout(resolve));
  }
  renderer.renderView(view);
  renderer.endFrame();
  engine.execute();
}

async function drawn(light, { width, height }) {
  await render(light);
  const { gl } = viewer;
  const pixels = new Float32Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.lastFramebuffer);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
  return pixels;
}

const BLUE_MATERIAL = { baseColorFactor: [0.03, 0.22, 0.47, 1], metallicFactor: 0.1, roughnessFactor: 0.35 };
const SKY = [0.5, 0.55, 0.6, 0.25, 0.27, 0.3, 0.1, 0.1, 0.1, -0.1, -0.1, -0.1];

// Returns a canvas that shows a file at a time of an animation, lit by a sun and a sky, on a transparent background.
// The next call overwrites the canvas.
export async function drawLit(bytes, animation, time, viewed, size) {
  const model = await loadAs(bytes, BLUE_MATERIAL);
  const { Filament } = window;
  play(model, animation, time);
  const { engine, gl, scene, view } = viewer;
  Object.assign(gl.canvas, size);
  view.setRenderTarget(null);
  view.setPostProcessingEnabled(true);
  view.setBlendMode(Filament.View$BlendMode.TRANSLUCENT);
  lookFrom(viewed, size);
  const sun = Filament.EntityManager.get().create();
  Filament.LightManager.Builder(Filament.LightManager$Type.DIRECTIONAL)
    .color([1, 0.95, 0.85]).intensity(90_000).direction([-0.5, -0.8, -0.55]).build(engine, sun);
  const shown = [sun, ...model.asset.getRenderableEntities()];
  shown.forEach((entity) => scene.addEntity(entity));
  await render(Filament.IndirectLight.Builder().irradianceSh(2, SKY).intensity(INTENSITY).build(engine));
  shown.forEach((entity) => scene.remove(entity));
  dispose(model);
  return gl.canvas;
}
