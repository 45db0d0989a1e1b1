// Starts the worker for browsers.
import * as browser from './platform.browser.js';
import { serveTasks } from './serve_tasks.js';

serveTasks(browser);
