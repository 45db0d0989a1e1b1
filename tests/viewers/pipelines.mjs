// Runs tools of other projects that rewrite glTF files, by the commands that people use, and audits the results.
import { spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, symlinkSync } from 'node:fs';
import { delimiter, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { ExactNormals, length } from './exact.mjs';
import { chronormal } from './program.mjs';
import { describe, newIO } from './reader.mjs';

const TOOLS = fileURLToPath(new URL('node_modules/.bin', import.meta.url));

// Makes a folder for runLine(). The command `chronormal` in this folder is the program under test.
export function makeWorkshop(folder) {
  mkdirSync(join(folder, 'bin'), { recursive: true });
  symlinkSync(resolve(process.env.CHRONORMAL_PROGRAM), join(folder, 'bin', 'chronormal'));
  return folder;
}

// Runs a line of shell commands in a folder of makeWorkshop(). gltf-transform and gltfpack have the versions in
// package-lock.json.
export function runLine(line, folder) {
  const path = [TOOLS, join(folder, 'bin'), process.env.PATH].join(delimiter);
  const options = { cwd: folder, encoding: 'utf8', env: { ...process.env, PATH: path }, maxBuffer: 1 << 28 };
  const { status, stdout, stderr, error } = spawnSync('sh', ['-ec', line], options);
  if (error) throw error;
  if (status !== 0) throw new Error(`${line}: exit code ${status}\n${stderr}${stdout}`);
}

// Runs a line of shell commands that makes web.glb from head.glb. Copies web.glb to the path `result`, and returns this
// path.
export function webOf(line, head, result, folder) {
  copyFileSync(head, join(folder, 'head.glb'));
  runLine(line, folder);
  copyFileSync(join(folder, 'web.glb'), result);
  return result;
}

// Returns the errors of a file in degrees, compared with the true normals of its own positions: {mean, worst}. `how`
// has more options for audit.
export function audited(path, ...how) {
  const report = JSON.parse(chronormal('audit', path, ...how, '--json', '--quiet'));
  return { mean: report.mean_degrees, worst: report.worst_degrees };
}

// Returns the largest absolute value of a component of a normal delta in a file.
export function largestDelta(file) {
  let largest = 0;
  for (const { primitives } of file.meshes)
    for (const { targets } of primitives)
      for (const { normals } of targets) normals?.forEach((c) => (largest = Math.max(largest, Math.abs(c))));
  return largest;
}

// Writes a file as a careful exporter does: every target has the unit normals of its shape, and the file has no
// correction targets.
export async function writePlainEndPoints(input, output) {
  const io = newIO();
  const document = await io.read(input);
  const file = describe(document);
  const buffer = document.getRoot().listBuffers()[0];
  document.getRoot().listMeshes().forEach((mesh, m) => {
    const { primitives, weights } = file.meshes[m];
    if (weights.length === 0 || primitives.some(({ triangles }) => !triangles)) return;
    const exact = new ExactNormals(file.meshes[m]);
    weights.forEach((_, k) => {
      const ends = exact.at(weights.map((_, i) => (i === k ? 1 : 0)));
      mesh.listPrimitives().forEach((primitive, p) => {
        if (!ends[p]) return;
        const { normals } = primitives[p];
        const deltas = new Float32Array(normals.length);
        for (let v = 0; 3 * v < normals.length; ++v) {
          const end = ends[p].directions.subarray(3 * v, 3 * v + 3);
          const size = length(end);
          for (let c = 0; c < 3 && size > 0; ++c) deltas[3 * v + c] = end[c] / size - normals[3 * v + c];
        }
        const accessor = document.createAccessor().setType('VEC3').setArray(deltas).setBuffer(buffer);
        primitive.listTargets()[k].setAttribute('NORMAL', accessor);
      });
    });
  });
  await io.write(output, document);
}
