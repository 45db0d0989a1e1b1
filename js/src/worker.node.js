// The worker of Node.js.
import * as node from './platform.node.js';
import { usePlatform } from './platform.js';
import { serveTasks } from './serve_tasks.js';

usePlatform(node);
serveTasks(node);
