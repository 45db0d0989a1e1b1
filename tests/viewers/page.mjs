// The entry point of the test page, which gives all viewers the same functions. The page also compares pictures, so
// that pixels need not leave the page.
import * as babylon from './babylon_page.mjs';
import * as filament from './filament_page.mjs';
import { differenceOfPictures, drawPicture } from './picture.mjs';
import { compareNormals, lit, middleOf, normalAt } from './pixels.mjs';
import * as playcanvas from './playcanvas_page.mjs';
import * as three from './three_page.mjs';

const viewers = { three, babylon, playcanvas, filament };

const bytesOf = (base64) => Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
const loaded = (viewer, base64) => viewers[viewer].load(bytesOf(base64));

// Compares, in a viewer, the picture of each file with the picture of a still file, at several moments {time, truth,
// view}. `time` is a time of the animation, `truth` is the still file, and `view` is the camera. Files are GLB in
// base64. Returns the result of compareNormals() for each file at each moment.
window.compareInViewer = async (viewer, files, animation, moments, size) => {
  const { play, drawNormals, dispose } = viewers[viewer];
  const models = [];
  for (const file of files) models.push(await loaded(viewer, file));
  const results = [];
  for (const { time, truth, view } of moments) {
    const still = await loaded(viewer, truth);
    play(still, null, 0);
    const expected = await drawNormals(still, view, size);
    const row = [];
    for (const model of models) {
      play(model, animation, time);
      row.push(compareNormals(await drawNormals(model, view, size), expected, size));
    }
    dispose(still);
    results.push(row);
  }
  models.forEach(dispose);
  return results;
};

// Compares, in a viewer, the picture of each file at a time of an animation with the picture of the still file `truth`.
// Returns {compared, picture}. `compared` has the results of compareNormals(). `picture` shows the pictures of all
// files beside the picture of `truth`, lit in the same way, as a PNG in a data URL.
window.closeUpInViewer = async (viewer, files, animation, { time, truth, view }, size) => {
  const { play, drawNormals, dispose, normalsAreOfView = false } = viewers[viewer];
  const draw = async (file, animated) => {
    const model = await loaded(viewer, file);
    play(model, animated, time);
    const picture = await drawNormals(model, view, size);
    dispose(model);
    return picture;
  };
  const drawn = [];
  for (const file of files) drawn.push(await draw(file, animation));
  const expected = await draw(truth, null);
  const sheet = new OffscreenCanvas(3 * size.width, size.height), ink = sheet.getContext('2d');
  [...drawn, expected].forEach((picture, i) => ink.putImageData(lit(picture, normalsAreOfView ? null : view, size), i * size.width, 0));
  return { compared: drawn.map((picture) => compareNormals(picture, expected, size)), picture: await urlOf(sheet, 'image/png') };
};

const urlOf = async (canvas, type) => {
  const bytes = new Uint8Array(await (await canvas.convertToBlob({ type, quality: 0.88 })).arrayBuffer());
  return `data:${type};base64,${btoa(bytes.reduce((text, byte) => text + String.fromCharCode(byte), ''))}`;
};

// Returns one JPEG in a data URL with the pictures of closeUpInViewer() of several viewers. The pictures are one below
// the other, and each has a title above it.
window.sheetOfCloseUps = async (pictures, { width, height }) => {
  const HEAD = 30, sheet = new OffscreenCanvas(3 * width, pictures.length * (height + HEAD)), ink = sheet.getContext('2d');
  ink.fillStyle = '#f8fafc';
  ink.fillRect(0, 0, sheet.width, sheet.height);
  ink.font = '600 15px "DejaVu Sans", sans-serif';
  for (const [row, { viewer, picture }] of pictures.entries()) {
    const image = await createImageBitmap(await (await fetch(picture)).blob());
    ink.fillStyle = '#1e293b';
    ['as exported', 'baked', 'the truth, by Blender'].forEach((words, i) =>
      ink.fillText(`${viewer}: ${words}`, i * width + 10, row * (height + HEAD) + 20));
    ink.drawImage(image, 0, row * (height + HEAD) + HEAD);
  }
  return urlOf(sheet, 'image/jpeg');
};

// Draws a file in a viewer as pictures of normals, at some times of its first animation. Calls made(picture) for each
// picture, and returns the results.
async function ofPictures(viewer, file, times, view, size, made) {
  const { play, drawNormals, dispose } = viewers[viewer];
  const model = await loaded(viewer, file);
  const results = [];
  for (const time of times) {
    play(model, 0, time);
    results.push(made(await drawNormals(model, view, size)));
  }
  dispose(model);
  return results;
}

// Returns the normals at the pixels [x, y] of each picture. A normal is null if nothing is drawn there.
window.normalsInViewer = (viewer, file, times, view, size, pixels) =>
  ofPictures(viewer, file, times, view, size, (picture) => pixels.map(([x, y]) => normalAt(picture, size, x, y)));

// Returns the middle [x, y] of the drawn pixels of each picture, or null if nothing is drawn.
window.middlesInViewer = (viewer, file, times, view, size) =>
  ofPictures(viewer, file, times, view, size, (picture) => middleOf(picture, size));

// Compares pictures of a file in a viewer with the still file of the same moment, four times: after a program has set
// the weights of the author's targets, while chronormal's package drives the correction targets, after the package has
// stopped, and after the program has driven the correction targets itself.
window.compareDriven = async (viewer, file, weights, { truth, view }, size) => {
  const { play, drawNormals, setWeights, drive, attach, detach, dispose } = viewers[viewer];
  const [still, model] = [await loaded(viewer, truth), await loaded(viewer, file)];
  play(still, null, 0);
  play(model, null, 0);
  const expected = await drawNormals(still, view, size);
  const results = [];
  for (const step of [() => setWeights(model, weights), () => attach(model), () => detach(model), () => drive?.(model)]) {
    step();
    results.push(compareNormals(await drawNormals(model, view, size), expected, size));
  }
  [still, model].forEach(dispose);
  return results;
};

// Blends several clips of a file in a viewer, and compares two pictures with one of a still file of the true shape: a
// picture before chronormal's package drives the correction targets, and a picture while it does. `weights` has the
// weights of the targets in the blend. In three.js, the mixer of a clone of the model plays the clips.
window.compareBlended = async (viewer, file, weights, { truth, view }, size) => {
  const { play, drawNormals, blend, attach, dispose } = viewers[viewer];
  const [still, model] = [await loaded(viewer, truth), await loaded(viewer, file)];
  play(still, null, 0);
  const expected = await drawNormals(still, view, size);
  blend(model, weights);
  const results = [];
  for (const step of [() => {}, () => attach(model)]) {
    step();
    results.push(compareNormals(await drawNormals(model, view, size), expected, size));
  }
  [still, model].forEach(dispose);
  return results;
};

window.drawPicture = (viewer, items, ...others) =>
  drawPicture(viewer, items.map(({ base64, caption }) => ({ bytes: bytesOf(base64), caption })), ...others);

window.differenceOfPictures = (...pictures) => differenceOfPictures(...pictures.map(bytesOf));
