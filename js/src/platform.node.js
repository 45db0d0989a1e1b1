// Implements for Node.js the functions that depend on the platform.
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { Worker } from 'node:worker_threads';

export const require = createRequire(import.meta.url);

export const read = (url) => readFile(url);

/**
 * Starts worker.node.js. The messages of this worker are passed to onMessage, and an error that ends the worker to
 * onError.
 */
export function startWorker(onMessage, onError) {
  const worker = new Worker(new URL('./worker.node.js', import.meta.url));
  worker.on('message', onMessage);
  worker.on('error', onError);
  return worker;
}

/** Serves messages in a worker. Calls answer(message, say) for each message; say(reply) sends a reply to the caller. */
export async function serve(answer) {
  const { parentPort } = await import('node:worker_threads');
  parentPort.on('message', (message) => answer(message, (reply, transfer) => parentPort.postMessage(reply, transfer)));
}
