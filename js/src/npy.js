// Reads the arrays that the program writes: .npy files of version 1 with float32 in C order.
const HEADER_SIZE_AT = 8, HEADER_AT = 10;

/**
 * Returns the numbers of an array, and the shape of the array. The numbers share the memory of the file if the numbers
 * are aligned in the file, and are copied otherwise.
 */
export function readNpy(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength), end = HEADER_AT + view.getUint16(HEADER_SIZE_AT, true);
  const header = new TextDecoder().decode(bytes.subarray(HEADER_AT, end));
  const [, type, sizes] = /'descr': '(.*?)'.*'shape': \((.*?)\)/.exec(header) ?? [];
  if (type !== '<f4') throw new Error(`normals.npy: the type of the array is ${type}, but must be <f4 (float32)`);
  const shape = sizes.split(',').filter((size) => size.trim() !== '').map(Number), at = bytes.byteOffset + end;
  const buffer = at % Float32Array.BYTES_PER_ELEMENT === 0 ? [bytes.buffer, at] : [bytes.slice(end).buffer, 0];
  return { numbers: new Float32Array(...buffer, shape.reduce((product, size) => product * size, 1)), shape };
}
