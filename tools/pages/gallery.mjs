// Draws the pictures of docs/viewers.md and README.md, which show a page of `chronormal report`, in headless Chromium.
// Prints the figures for their captions.
//
//   CHRONORMAL_PROGRAM=build/release/chronormal CHRONORMAL_DATA=FOLDER node tools/pages/gallery.mjs docs
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chronormal } from '../../tests/viewers/program.mjs';
import { openPages } from '../../tests/viewers/web_page.mjs';

const data = (name) => join(process.env.CHRONORMAL_DATA, name);

// The meshes and their cameras. `from` is the direction of the camera, and `near` its distance as a share of the
// distance at which the whole mesh is seen. `at` is the point at which the camera looks, in shares of the box of the
// mesh. The picture shows the moment with the largest average error.
const SUBJECTS = [
  { name: 'face', input: [data('rigs/ict_capture.glb')], from: [0.4, 0.02, 1], near: 0.46, at: [0.5, 0.53, 0.65], scale: 20 },
  { name: 'suzanne', input: [data('rigs/blender_suzanne_two_keys.glb')], from: [0.45, 0.2, 1], near: 0.72, at: [0.5, 0.5, 0.5], scale: 45 },
  { name: 'dance', input: [data('sequences/rumba_13')], from: [-0.5, 0.25, -1], near: 0.25, at: [0.5, 0.8, 0.5], scale: 10 },
  { name: 'twist', input: ['--sample', 'twist'], from: [0.6, 0.45, 1], near: 0.8, at: [0.5, 0.5, 0.5], scale: 45 },
];

// Draws three panes, with rendered normals, true normals and the error, and the text above them. This function runs in
// the page.
function drawPicture({ from, near, at, scale }) {
  const { player, view, setMode } = globalThis.chronormal, { motion } = player, WIDTH = 400, HEIGHT = 430, HEAD = 26;
  const best = motion.mean.reduce((found, value, i) => (value > motion.mean[found] && motion.segment?.[i] !== 0xffffffff ? i : found), 0);
  player.go(best);
  const worstOf = (motions) => motions.flatMap(({ worst }) => [...worst]).reduce((most, w) => Math.max(most, w || 0), 0);
  view.mark(-1);
  view.frame(true);
  view.look(at, from, near);
  view.setScale(scale);

  const sheet = Object.assign(document.createElement('canvas'), { width: 3 * WIDTH, height: HEIGHT + HEAD }), ink = sheet.getContext('2d');
  ink.fillStyle = '#f4f3f1';
  ink.fillRect(0, 0, sheet.width, sheet.height);
  const texts = ['as shown', 'as it should be', `the error, 0° to ${scale}°`];
  ['lit', 'lit', 'error'].forEach((mode, i) => {
    setMode(mode);
    view.draw();
    const { canvas } = view, half = canvas.width / 2, side = i === 0 ? 0 : half;
    const light = ink.createRadialGradient((i + 0.5) * WIDTH, HEAD + 0.35 * HEIGHT, 0, (i + 0.5) * WIDTH, HEAD + 0.35 * HEIGHT, 0.75 * HEIGHT);
    light.addColorStop(0, '#fbfaf8');
    light.addColorStop(1, '#d5d1ca');
    ink.fillStyle = light;
    ink.fillRect(i * WIDTH, HEAD, WIDTH, HEIGHT);
    ink.drawImage(canvas, side, 0, half, canvas.height, i * WIDTH, HEAD, WIDTH, HEIGHT);
    ink.fillStyle = '#1d1c1a';
    ink.font = '14px "DejaVu Sans", "Liberation Sans", sans-serif';
    ink.fillText(texts[i], i * WIDTH + 8, 18);
  });
  const alone = worstOf(player.part.motions.filter(({ kind }) => kind === 'target'));
  const numbers = { mean: motion.mean[best], worst: motion.worst[best], at: motion.at[best], most: worstOf([motion]), alone };
  return { picture: sheet.toDataURL('image/jpeg', 0.88), ...numbers };
}

const out = process.argv[2], folder = mkdtempSync(join(tmpdir(), 'chronormal-gallery-')), pages = await openPages(), { page } = pages;
mkdirSync(join(out, 'pictures'), { recursive: true });
const save = (name, address) => writeFileSync(join(out, 'pictures', `gallery_${name}.jpg`), Buffer.from(address.split(',')[1], 'base64'));
try {
  for (const { name, input, ...how } of SUBJECTS) {
    const report = join(folder, `${name}.html`);
    chronormal('report', ...input, '-o', report, '--no-plan', '-q');
    await page.setViewport({ width: 1180, height: 830, deviceScaleFactor: 2 });
    await pages.show(report);
    await page.addStyleTag({ content: '.stage { flex: none !important; width: 800px; height: 430px; }' });
    await new Promise((resolve) => setTimeout(resolve, 300));
    const { picture, ...numbers } = await page.evaluate(drawPicture, how);
    save(name, picture);
    console.log(name, numbers);
    if (name !== 'face') continue;
    await page.setViewport({ width: 1280, height: 800 });
    await pages.show(report);
    await page.evaluate(({ at, from }) => {
      const { player, view, setMode } = globalThis.chronormal, { mean } = player.motion;
      setMode('error');
      player.go(mean.indexOf(mean.reduce((a, b) => Math.max(a, b))));
      view.mark(-1);
      view.look(at, from, 0.5);
    }, how);
    await new Promise((resolve) => setTimeout(resolve, 800));
    save('report', `data:,${(await page.screenshot({ type: 'jpeg', quality: 85 })).toString('base64')}`);
  }
} finally {
  await pages.close();
  rmSync(folder, { recursive: true, force: true });
}

if (pages.faults.length > 0) throw new Error(pages.faults.join('\n'));
