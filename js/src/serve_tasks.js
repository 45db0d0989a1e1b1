// A thread of its own for long work: it takes tasks one by one, and says how far each is and what came of it.
import { perform } from './task.js';

/** Serves tasks on a platform. */
export const serveTasks = ({ serve }) => serve(async ({ task, wantsProgress }, say) => {
  try {
    const done = await perform(task, wantsProgress ? (progress) => say({ progress }) : undefined);
    say({ done }, Object.values(done.files).map((bytes) => bytes.buffer));
  } catch (error) {
    say({ failed: String(error?.message ?? error) });
  }
});
