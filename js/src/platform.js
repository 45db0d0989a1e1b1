// Where this runs: Node.js or a browser. The entries of the package (index.js, index.node.js) and of workers say so, before
// anything else is asked for, so that neither ever loads what only the other has.

/** @type {typeof import('./platform.browser.js')} */
export let platform;

export function usePlatform(used) {
  platform = used;
}
