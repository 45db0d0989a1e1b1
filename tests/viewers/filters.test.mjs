// Compares how two programs decode the filters of EXT_meshopt_compression: chronormal, and the npm package
// meshoptimizer, which runs in browsers. Decoded normals must agree bit for bit. The test stores all data as positions,
// since `chronormal convert` can write positions.
//
//   CHRONORMAL_PROGRAM        the program
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { MeshoptDecoder } from 'meshoptimizer/decoder';
import { MeshoptEncoder } from 'meshoptimizer/encoder';
import { chronormal } from './program.mjs';

const BYTE = 5120;
const SHORT = 5122;
const FLOAT = 5126;

// Returns encoded vectors for each number of bits from leastBits to mostBits. The vectors have all (x, y) of a square
// grid with at most mostSteps steps along each axis. If there are few bits, the grid has all possible values.
// tests/io/gltf/gltf_octahedral_test.cpp has the same loop.
function lattice(T, leastBits, mostBits, mostSteps) {
  const elements = [];
  for (let bits = leastBits; bits <= mostBits; ++bits) {
    const one = (1 << (bits - 1)) - 1;
    const steps = Math.min(2 * one, mostSteps);
    const at = (i) => -one + Math.floor((i * 2 * one) / steps);
    for (let i = 0; i <= steps; ++i)
      for (let j = 0; j <= steps; ++j) elements.push(at(i), at(j), one, (i + j) % 128);
  }
  return T.from(elements);
}

// Returns a function that draws numbers 0 <= x < 1. The numbers are the same in every run.
function randomNumbers(seed) {
  let state = seed;
  return () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
}

// Makes quaternions without their largest component, which a decoder computes from the other three. The two lowest bits
// of the last number tell which component is missing.
function quaternions(count) {
  const random = randomNumbers(1);
  const elements = new Int16Array(4 * count);
  for (let i = 0; i < count; ++i) {
    const one = (1 << (3 + (i % 13))) - 1;
    const rest = [2 * random() - 1, 2 * random() - 1, 2 * random() - 1];
    const most = Math.max(1, Math.hypot(...rest) / 1.2);
    elements.set(rest.map((c) => Math.round((c / most) * one)), 4 * i);
    elements[4 * i + 3] = (one & ~3) | ((i >> 2) & 3);
  }
  return elements;
}

function exponents(count) {
  const random = randomNumbers(2);
  return Int32Array.from({ length: 3 * count }, () => {
    const exponent = Math.round(200 * random()) - 100;
    return (exponent << 24) | Math.floor(random() * 2 ** 24);
  });
}

const encoded = (elements, count) => {
  const bytes = new Uint8Array(elements.buffer);
  return MeshoptEncoder.encodeGltfBuffer(bytes, count, bytes.length / count, 'ATTRIBUTES', 0);
};

// Encodes elements and decodes them as a browser does.
function decoded(elements, count, filter) {
  const target = new Uint8Array(elements.byteLength);
  MeshoptDecoder.decodeGltfBuffer(target, count, target.length / count, encoded(elements, count), 'ATTRIBUTES', filter);
  return new elements.constructor(target.buffer);
}

const padded = (bytes, filler) => Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3, filler)]);

function chunk(type, bytes) {
  const head = Buffer.alloc(8, type, 'latin1');
  head.writeUInt32LE(bytes.length, 0);
  head.write(type, 4, 'latin1');
  return Buffer.concat([head, bytes]);
}

// Makes a GLB file whose positions are the first three numbers of compressed elements, with a target that moves
// nothing.
function glbOf(elements, count, componentType, filter) {
  const stream = encoded(elements, count);
  const compression = { buffer: 0, byteLength: stream.length, byteStride: elements.byteLength / count, count, filter };
  const json = {
    asset: { version: '2.0' },
    extensionsUsed: ['EXT_meshopt_compression', 'KHR_mesh_quantization'],
    extensionsRequired: ['EXT_meshopt_compression', 'KHR_mesh_quantization'],
    buffers: [
      { byteLength: stream.length },
      { byteLength: elements.byteLength, extensions: { EXT_meshopt_compression: { fallback: true } } },
    ],
    bufferViews: [
      {
        buffer: 1,
        byteLength: elements.byteLength,
        byteStride: compression.byteStride,
        extensions: { EXT_meshopt_compression: { ...compression, mode: 'ATTRIBUTES' } },
      },
    ],
    accessors: [
      { bufferView: 0, componentType, normalized: componentType !== FLOAT, count, type: 'VEC3' },
      { componentType: FLOAT, count, type: 'VEC3' },
    ],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, targets: [{ POSITION: 1 }] }] }],
  };
  const body = Buffer.concat([
    chunk('JSON', padded(Buffer.from(JSON.stringify(json)), ' ')),
    chunk('BIN\0', padded(Buffer.from(stream), 0)),
  ]);
  const head = Buffer.from('glTF\x02\0\0\0\0\0\0\0', 'latin1');
  head.writeUInt32LE(head.length + body.length, 8);
  return Buffer.concat([head, body]);
}

function hash(elements) {
  let value = 0x811c9dc5;
  for (const byte of new Uint8Array(elements.buffer)) value = Math.imul(value ^ byte, 0x01000193) >>> 0;
  return value;
}

describe('the program decodes as browsers do', () => {
  let folder;
  before(async () => {
    folder = mkdtempSync(join(tmpdir(), 'chronormal_filters_'));
    await Promise.all([MeshoptDecoder.ready, MeshoptEncoder.ready]);
  });
  after(() => rmSync(folder, { recursive: true, force: true }));

  // Returns the positions that the program reads from a file of glbOf(). The program writes them as float32 after the
  // header of a PLY file.
  function positionsOf(elements, count, componentType, filter) {
    const input = join(folder, `${filter}.glb`);
    writeFileSync(input, glbOf(elements, count, componentType, filter));
    chronormal('convert', input, '-o', join(folder, '%d.ply'), '--force');
    const ply = readFileSync(join(folder, '0.ply'));
    const begin = ply.indexOf('end_header\n') + 'end_header\n'.length;
    return new Float32Array(new Uint8Array(ply.subarray(begin, begin + 12 * count)).buffer);
  }

  for (const [name, elements, width, componentType, filter, allowed] of [
    ['every octahedral normal of 8 bits', lattice(Int8Array, 4, 8, 254), 4, BYTE, 'OCTAHEDRAL', 0],
    ['many octahedral normals of 16 bits', lattice(Int16Array, 4, 16, 255), 4, SHORT, 'OCTAHEDRAL', 0],
    ['many quaternions but for the last digit, which is free', quaternions(300_000), 4, SHORT, 'QUATERNION', 1],
    ['many floats with exponents', exponents(100_000), 3, FLOAT, 'EXPONENTIAL', 0],
  ]) {
    test(name, () => {
      const count = Math.floor(elements.length / width / 3) * 3; // only complete triangles
      const some = elements.slice(0, count * width);
      const numbers = decoded(some, count, filter);
      const expected = filter === 'EXPONENTIAL' ? new Float32Array(numbers.buffer) : numbers;
      const largest = { [BYTE]: 127, [SHORT]: 32767, [FLOAT]: 1 }[componentType];
      const differs = (number, i) => {
        const whole = filter === 'EXPONENTIAL' ? number : Math.round(number * largest);
        return !(Math.abs(whole - expected[Math.floor(i / 3) * width + (i % 3)]) <= allowed);
      };
      const actual = positionsOf(some, count, componentType, filter);
      const wrong = actual.findIndex(differs);
      assert.equal(wrong, -1, `number ${wrong} is ${actual[wrong] * largest}`);
    });
  }

  test('as the constants say that the tests in C++ hold it to', () => {
    const every = lattice(Int8Array, 4, 8, 254);
    const many = lattice(Int16Array, 4, 16, 255);
    const hashes = [every, many].map((elements) => hash(decoded(elements, elements.length / 4, 'OCTAHEDRAL')));
    assert.deepEqual(hashes, [4083453700, 995496109]);
  });
});
