// Bakes by the formula in a few lines of JavaScript, as an oracle for bakes with one target, whose weight is w. The
// normal of a surface is n(w) = c0 + w c1 + w^2 c2, with three vectors c0, c1 and c2. A viewer that renders N + w D + w
// (1 - w) E shows the direction of n(w) if N = c0 / |c0|, D = (c1 + c2) / |c0| and E = -c2 / |c0|, where E is the delta
// of a correction target.
import { Accessor } from '@gltf-transform/core';
import { ExactNormals } from './exact.mjs';
import { describe, newIO } from './reader.mjs';

const withExtra = (w) => [w, w * (1 - w)];

// Bakes a file in which LINEAR animations drive the only target of each mesh.
export async function bakeByFormula(inputPath, outputPath) {
  const io = newIO();
  const document = await io.read(inputPath);
  const file = describe(document);
  const buffer = document.getRoot().listBuffers()[0];
  const accessor = (type, numbers) =>
    document.createAccessor().setType(type).setArray(Float32Array.from(numbers)).setBuffer(buffer);

  document.getRoot().listMeshes().forEach((mesh, m) => {
    const exact = new ExactNormals(file.meshes[m]);
    const [base, up, down] = [[0], [1], [-1]].map((weights) => exact.at(weights));
    mesh.listPrimitives().forEach((primitive, p) => {
      const target = primitive.listTargets()[0];
      const extra = document.createPrimitiveTarget();
      const count = primitive.getAttribute('POSITION').getCount();
      extra.setAttribute('POSITION', accessor(Accessor.Type.VEC3, new Float32Array(3 * count)));
      if (base[p]) {
        const { directions, lengths } = base[p];
        const over = (f) => directions.map((_, i) => f(i) / (lengths[Math.floor(i / 3)] || 1));
        const end = over((i) => up[p].directions[i] - directions[i]);
        const less = over((i) => directions[i] - (up[p].directions[i] + down[p].directions[i]) / 2);
        target.setAttribute('NORMAL', accessor(Accessor.Type.VEC3, end));
        extra.setAttribute('NORMAL', accessor(Accessor.Type.VEC3, less));
      }
      primitive.addTarget(extra);
    });
    mesh.setWeights(withExtra(mesh.getWeights()[0] ?? 0));
  });
  for (const node of document.getRoot().listNodes())
    if (node.getWeights().length === 1) node.setWeights(withExtra(node.getWeights()[0]));

  for (const animation of document.getRoot().listAnimations()) {
    for (const sampler of animation.listSamplers()) {
      const times = sampler.getInput().getArray();
      const w = sampler.getOutput().getArray();
      const values = [];
      w.forEach((weight, k) => {
        const before = k > 0 ? (weight - w[k - 1]) / (times[k] - times[k - 1]) : 0;
        const after = k + 1 < w.length ? (w[k + 1] - weight) / (times[k + 1] - times[k]) : 0;
        const slope = 1 - 2 * weight;  // the derivative of w (1 - w)
        values.push(before, slope * before, ...withExtra(weight), after, slope * after);
      });
      sampler.setInterpolation('CUBICSPLINE').setOutput(accessor(Accessor.Type.SCALAR, values));
    }
  }
  await io.write(outputPath, document);
}
