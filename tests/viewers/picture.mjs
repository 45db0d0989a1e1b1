// Runs in the test page. Draws the same moment with wrong and with true normals, side by side, as a viewer renders it.
import * as THREE from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
import * as filament from './filament_page.mjs';
import { cameraOf, load, play, rendererOf } from './three_page.mjs';

const BACKGROUND = '#f8fafc';
const INK = ['#1e293b', '#64748b'];
const FAMILY = '"DejaVu Sans", "Liberation Sans", sans-serif';
const FONTS = [`600 17px ${FAMILY}`, `14px ${FAMILY}`];
const SAMPLES = 2;  // pictures are drawn larger by this factor in each direction, and then reduced

// Draws `items` side by side. Each item is {bytes, caption}, and its caption has two lines. Returns a PNG as a data
// URL.
export async function drawPicture(viewer, items, animation, time, view, size) {
  const drawLit = { three: drawLitByThree, filament: filament.drawLit }[viewer];
  const canvas = document.createElement('canvas');
  Object.assign(canvas, size);
  const sheet = canvas.getContext('2d');
  sheet.fillStyle = BACKGROUND;
  sheet.fillRect(0, 0, size.width, size.height);
  sheet.imageSmoothingQuality = 'high';
  const width = Math.floor(size.width / items.length);
  const part = { width: SAMPLES * width, height: SAMPLES * size.height };
  for (const [i, { bytes, caption }] of items.entries()) {
    sheet.drawImage(await drawLit(bytes, animation, time, view, part), i * width, 0, width, size.height);
    sheet.textAlign = 'center';
    caption.forEach((line, l) => {
      sheet.fillStyle = INK[l];
      sheet.font = FONTS[l];
      sheet.fillText(line, (i + 0.5) * width, size.height - 36 + 22 * l);
    });
  }
  return canvas.toDataURL('image/png');
}

// Returns a canvas that shows a file as three.js draws it, with its standard material under the lights of a room.
async function drawLitByThree(bytes, animation, time, view, size) {
  const renderer = rendererOf(size);
  renderer.toneMapping = THREE.ACESFilmicToneMapping;
  const model = await load(bytes);
  play(model, animation, time);
  model.scene.environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment(), 0.02).texture;
  model.scene.background = null;
  const sun = new THREE.DirectionalLight('#fff1dc', 2.2);
  sun.position.set(2, 3, 2.5);
  model.scene.add(sun);
  model.scene.traverse((object) => {
    if (!object.isMesh) return;
    const side = THREE.DoubleSide;
    object.material = new THREE.MeshStandardMaterial({ color: '#2f7fb5', roughness: 0.22, metalness: 0.35, side });
  });
  renderer.setRenderTarget(null);
  renderer.setClearColor(BACKGROUND, 1);
  renderer.clear();
  renderer.render(model.scene, cameraOf(view, size));
  return renderer.domElement;
}

// Returns the difference between two PNGs: the average of |a - b| over all channels, which are 0 to 255. Returns
// Infinity if the sizes differ.
export async function differenceOfPictures(bytes, others) {
  const [a, b] = await Promise.all([bytes, others].map((png) => createImageBitmap(new Blob([png]))));
  if (a.width !== b.width || a.height !== b.height) return Infinity;
  const [left, right] = [a, b].map((image) => {
    const sheet = new OffscreenCanvas(image.width, image.height).getContext('2d');
    sheet.drawImage(image, 0, 0);
    return sheet.getImageData(0, 0, image.width, image.height).data;
  });
  return left.reduce((sum, value, i) => sum + Math.abs(value - right[i]), 0) / left.length;
}
