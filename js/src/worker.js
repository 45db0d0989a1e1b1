// The worker of browsers.
import * as browser from './platform.browser.js';
import { usePlatform } from './platform.js';
import { serveTasks } from './serve_tasks.js';

usePlatform(browser);
serveTasks(browser);
