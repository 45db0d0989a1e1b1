// Implements for browsers the functions that depend on the platform.
export const require = undefined;

export async function read(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}; copy this file from the package to the folder of your script, as the README of the package describes`);
  return new Uint8Array(await response.arrayBuffer());
}

/**
 * Starts worker.js. The messages of this worker are passed to onMessage, and an error that ends the worker to onError.
 */
export function startWorker(onMessage, onError) {
  const worker = new Worker(new URL('./worker.js', import.meta.url), { type: 'module' });
  worker.onmessage = ({ data }) => onMessage(data);
  worker.onerror = ({ message }) => onError(new Error(message ?? 'worker.js could not be started; copy this file from the package to the folder of your script, as the README of the package describes'));
  return worker;
}

/** Serves messages in a worker. Calls answer(message, say) for each message; say(reply) sends a reply to the caller. */
export async function serve(answer) {
  self.onmessage = ({ data }) => answer(data, (reply, transfer = []) => self.postMessage(reply, transfer));
}
