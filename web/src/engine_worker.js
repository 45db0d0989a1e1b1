// The thread of the program: the tasks of the npm package (js/src), on a module that the page hands over with each of them.
import { serveTasks } from '../../js/src/serve_tasks.js';

serveTasks({
  require: undefined,
  serve(answer) {
    self.onmessage = ({ data }) => answer(data, (reply, transfer = []) => self.postMessage(reply, transfer));
  },
});

// Reports errors that nobody waits for, such as a module for which there is no memory.
self.addEventListener('unhandledrejection', ({ reason }) => self.postMessage({ failed: String(reason?.message ?? reason) }));
