// Exports the functions of the package for Node.js.
import { apiOf } from './api.js';
import * as node from './platform.node.js';

export { ChronormalError } from './error.js';
export const { audit, bake, compare, inspect, sample } = /* @__PURE__ */ apiOf(node);
