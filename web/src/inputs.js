// Groups the files that a person drops into inputs, and explains which files the program cannot read.

// The largest file, in bytes, that the page accepts. The browser holds several copies of a file in 4 GB of memory.
const MOST = 256 * 1024 * 1024;

const OWN = /\.(glb|vrm|npz|md2)$/i, GLTF = /\.gltf$/i;

/** Groups files into inputs: [{name, args, files}]. `args` are the names that the command gets, and `files` also has
 * the files that they refer to. Does not read the files. */
export function inputsOf(list) {
  const files = [...list].sort((a, b) => a.name.localeCompare(b.name, 'en', { numeric: true }));
  const rest = files.filter(({ name }) => !OWN.test(name) && !GLTF.test(name));
  const inputs = files.filter(({ name }) => OWN.test(name)).map((file) => ({ name: file.name, args: [file.name], files: [file] }));
  const documents = files.filter(({ name }) => GLTF.test(name));
  for (const file of documents) inputs.push({ name: file.name, args: [file.name], files: [file, ...rest] });
  // The remaining files together are one motion: keyframes, or a mesh with a cache.
  if (documents.length === 0 && rest.length > 0) {
    const kept = rest.filter(({ name }) => !/\.(mtl|xml|txt|md)$/i.test(name)), named = kept.length > 0 ? kept : rest;
    const name = named.length > 1 ? `${named[0].name} … ${named.at(-1).name}` : named[0].name;
    inputs.push({ name, args: named.map((file) => file.name), files: rest });
  }
  return inputs;
}

const starts = (bytes, text) => [...text].every((letter, i) => bytes[i] === letter.charCodeAt(0));

const KINDS = [
  ['\x89PNG', 'a picture (PNG)'], ['\xff\xd8\xff', 'a picture (JPEG)'], ['GIF8', 'a picture (GIF)'], ['RIFF', 'a picture or a sound'], ['%PDF', 'a document (PDF)'],
  ['BLENDER', 'a Blender file'], ['Kaydara FBX', 'an FBX file'], ['\x1f\x8b', 'a compressed file'],
];

const EXPORT = 'Export the model from your 3D program as glTF 2.0 (.glb), with its shape keys, and drop that file here.';

/** Returns a sentence for people about a problem that the name, the size or the first bytes of a file show before the
 * program reads the file. Returns undefined if there is no problem. */
export function faultOf(name, size, bytes) {
  const megabytes = Math.round(size / 1e6).toLocaleString('en');
  if (size > MOST) {
    return `“${name}” has ${megabytes} MB, but this page can only take files of up to ${Math.round(MOST / 1e6)} MB, since the browser has to hold ` +
      'several copies in memory. Export the moving mesh alone, without its textures, or use the chronormal program on your computer, which has ' +
      'no such limit.';
  }
  if (size === 0) return `“${name}” is empty. ${EXPORT}`;
  if (!bytes) return undefined;
  const kind = KINDS.find(([magic]) => starts(bytes, magic));
  if (kind) return `“${name}” is ${kind[1]}, not a 3D model that can be read here. ${EXPORT}`;
  if (starts(bytes, 'PK') && !/\.npz$/i.test(name)) return `“${name}” is an archive (zip). Unpack the archive, and drop the model that is inside.`;
  if (starts(bytes, 'glTF') && bytes.length >= 12) {
    const said = new DataView(bytes.buffer, bytes.byteOffset).getUint32(8, true);
    if (said > size) {
      return `“${name}” is cut off: it should have ${said.toLocaleString('en')} bytes, and only ${size.toLocaleString('en')} are there. ` +
        'Copy or download the file again; if that does not help, export the model again.';
    }
  }
  return undefined;
}

export const NOTHING_MOVES =
  'This file needs no correction, since it has no shape keys (morph targets) that move a mesh with normals. Motion by bones alone needs no new ' +
  'normals. If the model should have shape keys, make sure that the mesh has shape keys in Blender, and tick “Shape Keys” below “Data” when you export glTF.';
