// Returns the errors and warnings that the Khronos validator reports about a file.
import { readFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import validator from 'gltf-validator';

const WARNING = 1;

// Returns what the validator reports about a file. Each entry is "CODE at POINTER: message".
export async function complaints(path) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(path)), {
    uri: path,
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(join(dirname(path), decodeURIComponent(uri)))),
  });
  return report.issues.messages
    .filter((issue) => issue.severity <= WARNING)
    .map((issue) => `${issue.code} at ${issue.pointer ?? issue.offset}: ${issue.message}`);
}

// Returns what the validator reports about a file, but not about the source file from which the file was baked. A bake
// does not repair its input.
export async function newComplaints(path, sourcePath) {
  const before = new Set(await complaints(sourcePath));
  return (await complaints(path)).filter((complaint) => !before.has(complaint));
}
