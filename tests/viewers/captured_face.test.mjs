// Bakes a captured face with 57 targets in a worker, under Node.js and in a page. Tests that there is enough memory,
// that the page stays responsive, and that a call ends properly if it is stopped or gets too little memory. Takes
// minutes.
//
//   CHRONORMAL_DATA   the folder of the real data
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, describe, test } from 'node:test';
import { install } from './installed.mjs';

const DATA = process.env.CHRONORMAL_DATA;
const NO_DATA = DATA ? false : 'set CHRONORMAL_DATA to the folder of the real data to run this test';
const OPTIONS = { for: ['three'], maxTargets: 112 };

const { folder, installed, remove, load, native } = install();
after(remove);
const { audit, bake, ChronormalError } = await load('index.node.js');

describe('a captured face', { skip: NO_DATA }, () => {
  const face = DATA && new Uint8Array(readFileSync(join(DATA, 'rigs/ict_capture.glb')));
  if (DATA) writeFileSync(join(folder, 'face.glb'), face);
  // Returns the file that the native program bakes from the face. Bakes the file only at the first call.
  let made;
  const expected = () => {
    if (!made) {
      const { status, stderr } = native(['bake', 'face.glb', '--for', 'three', '--max-targets', '112', '-o', 'made.glb']);
      assert.ok(status === 0 || status === 4, stderr); // with so few targets, the errors may exceed the tolerance
      made = readFileSync(join(folder, 'made.glb'));
    }
    return made;
  };

  test('is audited in a worker as by the program', async () => {
    const { report } = await audit(face, { name: 'face.glb' });
    assert.deepEqual(report, JSON.parse(native(['audit', 'face.glb', '--json']).stdout));
  });

  test('is baked in a worker to the bytes of the program, and the caller goes on meanwhile', async () => {
    let ticks = 0;
    const clock = setInterval(() => ++ticks, 100), start = performance.now();
    const { bytes } = await bake(face, OPTIONS);
    clearInterval(clock);
    const tenths = (performance.now() - start) / 100;
    assert.ok(ticks > 0.7 * tenths, `${ticks} of ${tenths}`);
    assert.ok(Buffer.from(bytes).equals(expected()), 'other bytes');
  });

  test('is given up in the middle, at once', async () => {
    const control = new AbortController(), call = bake(face, { ...OPTIONS, signal: control.signal });
    let stopped;
    setTimeout(() => control.abort(new Error((stopped = performance.now()) && 'enough')), 3000);
    await assert.rejects(call, /enough/);
    assert.ok(performance.now() - stopped < 500);
  });

  test('is too much for 96 MB, which is said', async () => {
    await assert.rejects(bake(face, { ...OPTIONS, memoryLimit: 96 << 20 }), (error) => {
      assert.ok(error instanceof ChronormalError, String(error));
      assert.equal(error.code, 1);
      assert.match(error.message, /^out of memory; close other programs, or choose a smaller part of the input$/);
      return true;
    });
  });

  test('is baked in a page that goes on meanwhile', async () => {
    const { openFolder } = await import('./browser.mjs');
    const { page, close } = await openFolder({ chronormal: installed, 'face.glb': face, 'page.html': '<!doctype html><title>page</title>' });
    try {
      // The test starts the bake in the page and then asks for the state of the bake again and again, since no single
      // call to the browser may take minutes.
      await page.evaluate((options) => {
        window.state = { ticks: 0, heard: 0 };
        const start = performance.now(), clock = setInterval(() => ++state.ticks, 100);
        const work = async () => {
          const { bake } = await import('/chronormal/src/index.js');
          const input = new Uint8Array(await (await fetch('/face.glb')).arrayBuffer());
          const { bytes } = await bake(input, { ...options, onProgress: () => ++state.heard });
          clearInterval(clock);
          state.tenths = (performance.now() - start) / 100;
          state.hash = Array.from(new Uint8Array(await crypto.subtle.digest('SHA-256', bytes)));
        };
        work().catch((error) => (state.failed = String(error)));
      }, OPTIONS);
      let state;
      do {
        await new Promise((resolve) => setTimeout(resolve, 1000));
        state = await page.evaluate(() => window.state);
      } while (!state.hash && !state.failed);
      const { hash, ticks, tenths, heard, failed } = state;
      assert.equal(failed, undefined);
      const { createHash } = await import('node:crypto');
      assert.deepEqual(hash, [...createHash('sha256').update(expected()).digest()]);
      assert.ok(ticks > 0.5 * tenths, `${ticks} of ${tenths}`);
      assert.ok(heard > 10, `${heard}`);
    } finally {
      await close();
    }
  });
});
