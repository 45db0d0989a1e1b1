// What Node.js has of its own (package.json, "imports").
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { Worker } from 'node:worker_threads';

export const require = createRequire(import.meta.url);

export async function compile(url) {
  return WebAssembly.compile(await readFile(url));
}

/** Starts the worker of worker.js; onMessage gets what it says, onError what ends it. */
export function startWorker(onMessage, onError) {
  const worker = new Worker(new URL('./worker.js', import.meta.url));
  worker.on('message', onMessage);
  worker.on('error', onError);
  return worker;
}

/** In a worker: answers each message by what answer(message, say) says. */
export async function serve(answer) {
  const { parentPort } = await import('node:worker_threads');
  parentPort.on('message', (message) => answer(message, (reply, transfer) => parentPort.postMessage(reply, transfer)));
}
