// Runs tasks of the program in a worker. The tasks are the same as in the npm package (js/src). The page sends the
// compiled module with each task.
import { serveTasks } from '../../js/src/serve_tasks.js';

serveTasks({
  require: undefined,
  serve(answer) {
    self.onmessage = ({ data }) => answer(data, (reply, transfer = []) => self.postMessage(reply, transfer));
  },
});

// Errors that no code awaits, such as too little memory for the module, are reported to the page.
self.addEventListener('unhandledrejection', ({ reason }) => self.postMessage({ failed: String(reason?.message ?? reason) }));
