// Does long work in a separate thread, which takes tasks one by one, and reports the progress and the result of each
// task.
import { useCompiled } from './run.js';
import { perform } from './task.js';

/**
 * Serves tasks on a platform. A message is {task, wantsProgress}, with the compiled module if the caller has already
 * compiled the program.
 */
export const serveTasks = (platform) => platform.serve(async ({ task, wantsProgress, module }, say) => {
  try {
    if (module) useCompiled(module);
    const done = await perform(platform, task, wantsProgress ? (progress) => say({ progress }) : undefined);
    say({ done }, Object.values(done.files).map((bytes) => bytes.buffer));
  } catch (error) {
    say({ failed: String(error?.message ?? error) });
  }
});
