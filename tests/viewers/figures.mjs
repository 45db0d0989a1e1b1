// Tests the panel of a page that shows one face of a mesh. Compares the values in the panel with the output of `compare
// --face`, and the pictures in the panel with values that are computed from this output.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { angle } from './exact.mjs';
import { chronormal } from './program.mjs';

/** Returns the figure that `chronormal compare --face` computes for a face: the paths of its normals by each scheme.
 * The corners of the face move from `from` to `to`. */
export function figureByProgram({ from, to }, schemes, samples) {
  const folder = mkdtempSync(join(tmpdir(), 'chronormal-figure-')), names = ['from.obj', 'to.obj'].map((name) => join(folder, name));
  [from, to].forEach((corners, end) => writeFileSync(names[end], `${corners.map((p) => `v ${p.join(' ')}`).join('\n')}\nf ${corners.map((_, i) => i + 1).join(' ')}\n`));
  try {
    return JSON.parse(chronormal('compare', ...names, '--face', '0', '--schemes', schemes.join(','), '--samples', String(samples), '--json', '-q')).figure;
  } finally {
    rmSync(folder, { recursive: true });
  }
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const vector = (flat, i) => flat.slice(3 * i, 3 * i + 3);

/** Fails unless two figures have the same numbers. Small differences are allowed, since the paths of one figure may
 * have been rounded to float32. */
export function assertSameFigure(found, expected) {
  assert.deepEqual(found.t, expected.t);
  found.schemes.forEach((one, k) => {
    const other = expected.schemes[k];
    assert.equal(one.scheme, other.scheme);
    assert.ok(Math.abs(one.sum_degrees - other.sum_degrees) < 1e-3, `${one.scheme}: q is ${one.sum_degrees}, not ${other.sum_degrees}`);
    for (const member of ['normals', 'points', 'nodes', 'tangents']) {
      assert.equal(one[member]?.length, other[member]?.length, `${one.scheme}: ${member}`);
      for (let i = 0; 3 * i < (one[member]?.length ?? 0); ++i) {
        assert.ok(angle(vector(one[member], i), vector(other[member], i)) < 1e-3, `${one.scheme}: ${member} ${i}`);
      }
    }
    one.lengths?.forEach((length, i) => assert.ok(Math.abs(length - other.lengths[i]) < 1e-5 * Math.max(1, length), `${one.scheme}: length ${i}`));
  });
}

/**
 * Compares the panel of a page with a figure. Checks the sum q of the errors of each scheme, in degrees, in the table
 * of the panel, and the places at which normals are marked. In the saved file, checks the colour of the mark of the
 * exact normal.
 * @param page a page of puppeteer whose viewer has a figure
 */
export async function assertShown(page, expected) {
  const shown = await page.evaluate(async () => {
    const { faces } = globalThis.chronormal, { view, sample, near } = faces.look(), sheet = document.querySelector('.figures > svg:nth-of-type(2)');
    const marks = [...sheet.querySelectorAll('[data-mark]')].map((one) => ({ name: one.dataset.mark, x: Number(one.getAttribute('cx')), y: Number(one.getAttribute('cy')), fill: one.getAttribute('fill') }));
    const image = new Image(), text = faces.svg();
    await new Promise((resolve, reject) => {
      image.onload = resolve;
      image.onerror = reject;
      image.src = URL.createObjectURL(new Blob([text], { type: 'image/svg+xml' }));
    });
    const canvas = new OffscreenCanvas(2 * image.width, 2 * image.height).getContext('2d', { willReadFrequently: true });
    canvas.drawImage(image, 0, 0, 2 * image.width, 2 * image.height);
    const nested = new DOMParser().parseFromString(text, 'image/svg+xml').documentElement.querySelectorAll('svg')[1];
    const at = ({ x, y }) => [...canvas.getImageData(Math.round(2 * (x + Number(nested.getAttribute('x')))), Math.round(2 * (y + Number(nested.getAttribute('y')))), 1, 1).data.slice(0, 3)];
    return {
      view, sample, near, marks: marks.map((one) => ({ ...one, pixel: at(one) })),
      sums: [...document.querySelectorAll('.face tr[data-scheme]')].map((row) => ({ scheme: row.dataset.scheme, sum: Number(row.dataset.sum), text: row.cells[1].textContent })),
    };
  });
  assert.deepEqual(shown.sums.map(({ scheme }) => scheme), expected.schemes.map(({ scheme }) => scheme));
  shown.sums.forEach(({ sum, text, scheme }, k) => {
    assert.ok(Math.abs(sum - expected.schemes[k].sum_degrees) < 1e-3, `${scheme}: q is ${sum}, not ${expected.schemes[k].sum_degrees}`);
    assert.ok(Math.abs(parseFloat(text) - sum) < 0.06, `${scheme}: ${text}`);
  });
  assert.ok(shown.marks.length >= 3, `${shown.marks.length} marks`);
  const { zoom, middle = [0, 0, 0] } = shown.near, { right, up, towards } = shown.view;
  for (const [a, b] of [[right, up], [up, towards], [towards, right]]) assert.ok(Math.abs(dot(a, b)) < 1e-9, 'the view is square');
  for (const { name, x, y } of shown.marks) {
    const normal = vector(name === 'exact' ? expected.normals : expected.schemes.find(({ scheme }) => scheme === name).normals, shown.sample);
    const along = (axis) => 135 * zoom * (dot(normal, axis) - dot(middle, axis));
    assert.ok(Math.hypot(x - (170 + along(right)), y - (160 - along(up))) < 0.05 * zoom, `${name} is drawn elsewhere`);
  }
  // The mark of the exact normal is drawn last, so no other mark covers it.
  const last = shown.marks.at(-1), wanted = [1, 3, 5].map((i) => parseInt(last.fill.slice(i, i + 2), 16));
  assert.equal(last.name, 'exact');
  last.pixel.forEach((value, c) => assert.ok(Math.abs(value - wanted[c]) < 12, `the pixel of the exact normal is ${last.pixel}, not ${wanted}`));
}
