// What browsers import.
import * as browser from './platform.browser.js';
import { usePlatform } from './platform.js';

usePlatform(browser);

export * from './api.js';
