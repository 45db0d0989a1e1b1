// The thread of the program: the tasks of the npm package (js/src), on a module that the page hands over with each of them.
import { usePlatform } from '../../js/src/platform.js';
import { serveTasks } from '../../js/src/serve_tasks.js';

let compiled;
const page = {
  require: undefined,
  compile: () => compiled,
  async serve(answer) {
    self.onmessage = ({ data }) => {
      compiled = Promise.resolve(data.module);
      answer(data, (reply, transfer = []) => self.postMessage(reply, transfer));
    };
  },
};
usePlatform(page);
serveTasks(page);

// What nobody waits for, such as a module for which there is no memory.
self.addEventListener('unhandledrejection', ({ reason }) => self.postMessage({ failed: String(reason?.message ?? reason) }));
