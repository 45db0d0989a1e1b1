// Tests the tangents that `chronormal bake` computes anew for a morph. Normal maps need tangents, and Babylon.js adds
// up the tangents of targets. The picture of the baked morph in Babylon.js is compared with the picture of a still
// mesh, whose tangents follow from the formula of its surface. ctest runs this file as `in_viewers`.
//
//   CHRONORMAL_PROGRAM   the program
//   CHRONORMAL_CHROMIUM  the browser, if it is not in its usual place
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { Accessor, Document } from '@gltf-transform/core';
import { openPage } from './browser.mjs';
import { chronormal } from './program.mjs';
import { newIO } from './reader.mjs';
import { stillMoments } from './still.mjs';

const SIZE = { width: 256, height: 256 };
const CELLS = 24, BEND = 2, SHEAR = 0.6;

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a) => a.map((c) => c / Math.hypot(...a));

// A square sheet that bends around an axis and shears. The next three functions return the position at (x, y), the
// direction in which x grows there, and the direction in which y grows.
const bent = (x, y) => [Math.sin(BEND * x) / BEND + SHEAR * y, y, (1 - Math.cos(BEND * x)) / BEND];
const alongX = (x) => [Math.cos(BEND * x), 0, Math.sin(BEND * x)];
const alongY = () => [SHEAR, 1, 0];

// The coordinates [x, y] of all vertices, which are between -1/2 and 1/2.
const places = Array.from({ length: (CELLS + 1) ** 2 }, (_, i) =>
  [i % (CELLS + 1), Math.floor(i / (CELLS + 1))].map((c) => c / CELLS - 0.5));

// Makes a PNG of one pixel as a normal map: its normal leans along both axes of the texture.
function normalMap() {
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]), word = Buffer.alloc(8);
    word.writeUInt32BE(data.length, 0);
    word.writeUInt32BE(checksum(body), 4);
    return Buffer.concat([word.subarray(0, 4), body, word.subarray(4)]);
  };
  const header = Buffer.from([0, 0, 0, 1, 0, 0, 0, 1, 8, 2, 0, 0, 0]);
  const pixel = unit([0.6, 0.3, 0.8]).map((c) => Math.round(127.5 * (c + 1)));
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk('IHDR', header),
    chunk('IDAT', deflateSync(Buffer.from([0, ...pixel]))), chunk('IEND', Buffer.alloc(0))]);
}

// Returns the CRC-32 of a chunk of a PNG. Node.js 18 has no function for this checksum.
function checksum(bytes) {
  let rest = 0xffffffff;
  for (const byte of bytes) {
    rest ^= byte;
    for (let bit = 0; bit < 8; ++bit) rest = (rest >>> 1) ^ (rest & 1 ? 0xedb88320 : 0);
  }
  return (rest ^ 0xffffffff) >>> 0;
}

// Writes the sheet with a target that bends it. The normals of the target are true at weight 1, and the target has no
// tangents.
async function writeSheet(path) {
  const document = new Document(), buffer = document.createBuffer();
  const accessor = (type, numbers, Numbers = Float32Array) =>
    document.createAccessor().setType(type).setArray(Numbers.from(numbers)).setBuffer(buffer);
  const { VEC2, VEC3, VEC4, SCALAR } = Accessor.Type;
  const indices = [];
  for (let y = 0; y < CELLS; ++y) {
    for (let x = 0; x < CELLS; ++x) {
      const a = y * (CELLS + 1) + x, up = a + CELLS + 1;
      indices.push(a, a + 1, up + 1, a, up + 1, up);
    }
  }
  const map = document.createTexture().setImage(normalMap()).setMimeType('image/png');
  const material = document.createMaterial().setNormalTexture(map).setDoubleSided(true);
  const normals = places.map(([x]) => unit(cross(alongX(x), alongY())));
  const target = document.createPrimitiveTarget()
    .setAttribute('POSITION', accessor(VEC3, places.flatMap(([x, y]) => bent(x, y).map((c, k) => c - [x, y, 0][k]))))
    .setAttribute('NORMAL', accessor(VEC3, normals.flatMap((n) => n.map((c, k) => c - [0, 0, 1][k]))));
  const primitive = document.createPrimitive().setMaterial(material).addTarget(target)
    .setIndices(accessor(SCALAR, indices, Uint16Array))
    .setAttribute('POSITION', accessor(VEC3, places.flatMap(([x, y]) => [x, y, 0])))
    .setAttribute('NORMAL', accessor(VEC3, places.flatMap(() => [0, 0, 1])))
    .setAttribute('TANGENT', accessor(VEC4, places.flatMap(() => [1, 0, 0, 1])))
    .setAttribute('TEXCOORD_0', accessor(VEC2, places.flatMap(([x, y]) => [x + 0.5, 0.5 - y])));
  const mesh = document.createMesh('sheet').addPrimitive(primitive).setWeights([0]);
  const node = document.createNode().setMesh(mesh);
  document.getRoot().setDefaultScene(document.createScene().addChild(node));
  const sampler = document.createAnimationSampler()
    .setInput(accessor(SCALAR, [0, 1])).setOutput(accessor(SCALAR, [0, 1]));
  const channel = document.createAnimationChannel().setTargetPath('weights').setTargetNode(node).setSampler(sampler);
  document.createAnimation('bend').addSampler(sampler).addChannel(channel);
  await newIO().write(path, document);
}

// Gives the still mesh tangents along x that are perpendicular to its normals. The normals come from the moving mesh.
async function withRightTangents(glb) {
  const document = await newIO().readBinary(Buffer.from(glb, 'base64'));
  const primitive = document.getRoot().listMeshes()[0].listPrimitives()[0];
  const normals = primitive.getAttribute('NORMAL'), tangents = primitive.getAttribute('TANGENT');
  places.forEach(([x], v) => {
    const n = normals.getElement(v, []), along = alongX(x);
    tangents.setElement(v, [...unit(along.map((c, k) => c - dot(along, n) * n[k])), 1]);
  });
  return Buffer.from(await newIO().writeBinary(document)).toString('base64');
}

describe('a morph that is lit through a normal map', () => {
  let browser, folder;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'chronormal_tangents_'));
    browser = await openPage();
  });
  after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
    assert.deepEqual(browser?.faults, []);
  });

  test('has right pixels in Babylon.js where its target has the weight 1', async () => {
    const input = join(folder, 'sheet.glb'), output = join(folder, 'baked.glb');
    await writeSheet(input);
    chronormal('bake', input, '-o', output, '--for', 'babylon', '--weighting', 'area');
    const [moment] = await stillMoments(input, 0, [1]);
    moment.truth = await withRightTangents(moment.truth);
    const files = [input, output].map((path) => readFileSync(path).toString('base64'));
    const compare = (...all) => window.compareInViewer(...all);
    const [[was, is]] = await browser.page.evaluate(compare, 'babylon', files, 0, [moment], SIZE);
    assert.ok(was.p99 > 5, JSON.stringify(was));
    assert.ok(is.pixels > 2000 && is.p99 < 1, JSON.stringify(is));
  });
});
