// Exports the functions of the package for browsers.
import { apiOf } from './api.js';
import * as browser from './platform.browser.js';

export { ChronormalError } from './error.js';
export const { audit, bake, compare, inspect, sample } = /* @__PURE__ */ apiOf(browser);
