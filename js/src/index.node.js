// What Node.js imports.
import * as node from './platform.node.js';
import { usePlatform } from './platform.js';

usePlatform(node);

export * from './api.js';
