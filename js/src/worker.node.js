// Starts the worker for Node.js.
import * as node from './platform.node.js';
import { serveTasks } from './serve_tasks.js';

serveTasks(node);
