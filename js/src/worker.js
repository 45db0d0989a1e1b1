// A thread of its own for long work: it takes tasks one by one, and says how far each is and what came of it.
import { serve } from '#platform';
import { perform } from './task.js';

serve(async ({ task, wantsProgress }, say) => {
  try {
    const done = await perform(task, wantsProgress ? (progress) => say({ progress }) : undefined);
    say({ done }, Object.values(done.files).map((bytes) => bytes.buffer));
  } catch (error) {
    say({ failed: String(error?.message ?? error) });
  }
});
