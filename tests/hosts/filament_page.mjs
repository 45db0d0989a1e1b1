// Filament as a host, in the page: its loader, its animator, and the light of its glTF material, which shows normals as
// colours. browser.mjs puts `Filament` itself into the page.
//
// A light from all sides, whose irradiance is (n + 1) / 2 in three colours, makes a white and rough surface show
// k (n + 1) / 2, where k depends on material and view; under a light of 1 the same surface shows k.

const NORMALS = [0.5, 0.5, 0.5, 0, 0.5, 0, 0, 0, 0.5, 0.5, 0, 0];  // spherical harmonics in RGB: 1, y, z, x
const WHITE = [1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
const EXPOSURE = [16, 1 / 125, 100];  // aperture, shutter and sensitivity
const JSON_AT = 20;

let host;

function createHost() {
  const { Filament } = window;
  const gl = framebuffersNoted(document.createElement('canvas').getContext('webgl2'));
  const engine = Filament.Engine.create(gl.canvas);
  const light = (sh) => Filament.IndirectLight.Builder().irradianceSh(2, sh).intensity(38400).build(engine);
  const camera = engine.createCamera(Filament.EntityManager.get().create());
  camera.setExposure(...EXPOSURE);
  const scene = engine.createScene();
  const view = engine.createView();
  view.setCamera(camera);
  view.setScene(scene);
  view.setPostProcessingEnabled(false);
  const renderer = engine.createRenderer();
  renderer.setClearOptions({ clearColor: [0, 0, 0, 0], clear: true });
  const lights = [NORMALS, WHITE].map(light);
  const [swapChain, loader] = [engine.createSwapChain(), engine.createAssetLoader()];
  return { gl, camera, engine, lights, loader, renderer, scene, swapChain, view };
}

// Notes the framebuffer that was drawn into last: Filament has no function in JavaScript that reads one.
function framebuffersNoted(gl) {
  const bind = gl.bindFramebuffer.bind(gl);
  gl.bindFramebuffer = (target, framebuffer) => {
    if (framebuffer) gl.lastFramebuffer = framebuffer;
    bind(target, framebuffer);
  };
  return gl;
}

export async function load(bytes) {
  if (!window.Filament.isReady) await new Promise((resolve) => window.Filament.init([], resolve));
  host ??= createHost();
  const asset = host.loader.createAsset(whitened(bytes));
  await new Promise((resolve) => asset.loadResources(resolve, null, null, 1));
  return { asset, animator: asset.getInstance().getAnimator() };
}

// A GLB in which all is white, rough and no metal, and has no textures.
function whitened(bytes) {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(JSON_AT, JSON_AT + length)));
  const white = (doubleSided) => ({ pbrMetallicRoughness: { metallicFactor: 0, roughnessFactor: 1 }, doubleSided });
  const old = json.materials ?? [];
  json.materials = [white(false), white(true)];
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

// Sets every object to a time, by the animator, which starts again at the end.
export function play({ animator }, animation, time) {
  if (animation !== null) animator.applyAnimation(animation, time);
}

export function dispose({ asset }) {
  host.loader.destroyAsset(asset);
}

// World-space normals of all pixels, RGBA in float32: (n + 1) / 2, and alpha 0 where nothing is.
export async function drawNormals({ asset }, { eye, at, degrees, near, far }, size) {
  const { camera, engine, lights, scene, view } = host;
  const { Filament } = window;
  const texture = (format, usage) => {
    const builder = Filament.Texture.Builder().width(size.width).height(size.height).levels(1);
    return builder.format(Filament.Texture$InternalFormat[format]).usage(usage).build(engine);
  };
  const [colors, depths] = [texture('RGBA32F', 1), texture('DEPTH24', 2)];
  const { COLOR, DEPTH } = Filament.RenderTarget$AttachmentPoint;
  const target = Filament.RenderTarget.Builder().texture(COLOR, colors).texture(DEPTH, depths).build(engine);
  view.setRenderTarget(target);
  view.setViewport([0, 0, size.width, size.height]);
  camera.lookAt(eye, at, [0, 1, 0]);
  camera.setProjectionFov(degrees, size.width / size.height, near, far, Filament.Camera$Fov.VERTICAL);
  const entities = asset.getRenderableEntities();
  entities.forEach((entity) => scene.addEntity(entity));
  const normals = await drawn(lights[0], size);
  const white = await drawn(lights[1], size);
  entities.forEach((entity) => scene.remove(entity));
  engine.destroyRenderTarget(target);
  [colors, depths].forEach((made) => engine.destroyTexture(made));
  return normals.map((value, i) => (i % 4 === 3 ? value : value / white[i]));
}

async function drawn(light, { width, height }) {
  const { engine, gl, renderer, scene, swapChain, view } = host;
  scene.setIndirectLight(light);
  // A frame is refused until the browser has said, in a task of its own, that an earlier one is done.
  while (!renderer.beginFrame(swapChain)) {
    engine.execute();
    await new Promise((resolve) => setTimeout(resolve));
  }
  renderer.renderView(view);
  renderer.endFrame();
  engine.execute();
  const pixels = new Float32Array(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.lastFramebuffer);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
  return pixels;
}
