// Reads the data of a report, a container that `chronormal report` writes (docs/formats.md), as JSON with typed arrays
// in it.

const MAGIC = 'CHRONRPT', VERSION = 1, HEADER = 16;
const TYPES = { f32: Float32Array, f64: Float64Array, u32: Uint32Array, i16: Int16Array, u8: Uint8Array };

const damaged = () => new Error('The data of this page are damaged. Download or make the page again.');

const isArray = (value) => typeof value?.type === 'string' && Number.isInteger(value.offset) && Number.isInteger(value.count);

/**
 * Reads a container.
 * @param {Uint8Array} bytes a container
 * @returns {object} its JSON, in which each {offset, type, count} below "parts" is replaced by a typed array
 */
export function readContainer(bytes) {
  if (bytes.length < HEADER || new TextDecoder().decode(bytes.subarray(0, 8)) !== MAGIC) throw new Error('The data of this page are not the data of a report. Make the page again with chronormal report.');
  const buffer = bytes.byteOffset % 8 === 0 ? bytes.buffer : bytes.slice().buffer;
  const start = buffer === bytes.buffer ? bytes.byteOffset : 0;
  const view = new DataView(buffer, start, bytes.length);
  const version = view.getUint32(8, true), size = view.getUint32(12, true);
  if (version !== VERSION) throw new Error(`The data of this page have version ${version}, but the page reads version ${VERSION}. Make the page again.`);
  const first = Math.ceil((HEADER + size) / 8) * 8;
  if (first > bytes.length) throw new Error('The data of this page are cut off. Download or make the page again.');

  const arrayOf = ({ offset, type, count }) => {
    const Type = TYPES[type];
    if (!Type || offset < 0 || offset % 8 !== 0 || count < 0) throw damaged();
    if (first + offset + count * Type.BYTES_PER_ELEMENT > bytes.length) throw new Error('The data of this page are cut off. Download or make the page again.');
    const array = new Type(buffer, start + first + offset, count);
    for (let i = 0; i < count; ++i) if (!Number.isFinite(array[i])) throw damaged();
    return array;
  };
  const withArrays = (value) => {
    if (value === null || typeof value !== 'object') return value;
    if (isArray(value)) return arrayOf(value);
    if (Array.isArray(value)) return value.map(withArrays);
    return Object.fromEntries(Object.entries(value).map(([name, member]) => [name, withArrays(member)]));
  };
  let report;
  try {
    report = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes.subarray(HEADER, HEADER + size)));
  } catch {
    throw damaged();
  }
  if (!Array.isArray(report?.parts)) throw damaged();
  return { ...report, parts: withArrays(report.parts) };
}

/** Decodes base64, whose length must be a multiple of four. */
export function fromBase64(text) {
  let binary;
  try {
    binary = atob(text.trim());
  } catch {
    throw damaged();
  }
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Unpacks a gzip file. */
export async function unzipped(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer().catch(() => Promise.reject(damaged())));
}
