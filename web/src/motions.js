// Finds places in a motion. A place `at` is the index of a sample, or a fraction for a place between two samples.

/** Returns the time in seconds, or the weight of the target or expression, at the place `at` of a motion. */
export function valueAt({ at: values }, at) {
  const from = Math.min(Math.floor(at), values.length - 1), to = Math.min(from + 1, values.length - 1);
  return values[from] + (at - from) * (values[to] - values[from]);
}

/** Returns the place in a motion at which the time in seconds, or the weight of the target or expression, is `value`.
 * If two samples have this value, the result is the later sample. */
export function placeOf({ at: values }, value) {
  let low = 0, high = values.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (values[middle] <= value) low = middle;
    else high = middle - 1;
  }
  if (low === values.length - 1 || !(values[low + 1] > values[low])) return low;
  return low + Math.min(Math.max((value - values[low]) / (values[low + 1] - values[low]), 0), 1);
}

/** Returns the nearest sample before a place (step -1) or after the place (step 1) that has another time or weight than
 * the place. */
export function neighbour({ at: values }, at, step) {
  const last = values.length - 1, start = valueAt({ at: values }, at);
  let next = step > 0 ? Math.floor(at) + 1 : Math.ceil(at) - 1;
  while (next > 0 && next < last && values[next] === start) next += step;
  return Math.min(Math.max(next, 0), last);
}

// The number in place of a segment for a sample whose keyframes were left out of the report.
const LEFT_OUT = 0xffffffff;

/** Returns the segment and t of a place in a motion of keyframes. If the keyframes of the place were left out, the
 * nearest place with keyframes is used. */
export function segmentAt({ segment, t }, at) {
  const last = segment.length - 1, from = Math.min(Math.floor(at), last), to = Math.min(from + 1, last);
  if (segment[from] !== LEFT_OUT) return [segment[from], t[from] + (segment[from] === segment[to] ? (at - from) * (t[to] - t[from]) : 0)];
  for (let step = 1; ; ++step) {
    for (const i of [from - step, from + step]) if (i >= 0 && i <= last && segment[i] !== LEFT_OUT) return [segment[i], t[i]];
    if (step > last) return [0, 0];
  }
}

/** Returns the index of the sample with the largest error in a motion. */
export const worstSample = ({ worst }) => worst.reduce((best, value, i) => (value > worst[best] || !(worst[best] >= 0) ? i : best), 0);

/** Returns the motion and the moment of a sample in words: "jawOpen at 0.55", "talk at 1.25 s". */
export function momentOf(motion, sample) {
  const name = motion.name || (motion.kind === 'target' ? `target ${motion.target}` : motion.kind === 'expression' ? `expression ${motion.expression}` : '');
  return `${name ? `${name} at ` : ''}${+motion.at[sample].toFixed(3)}${motion.seconds ? ' s' : ''}`;
}

/** Returns a name of a motion for people. */
export function nameOf(motion) {
  if (motion.kind === 'target') return motion.name || `target ${motion.target}`;
  if (motion.kind === 'track') return `animation ${motion.name || motion.animation}`;
  if (motion.kind === 'expression') return motion.name || `expression ${motion.expression}`;
  return motion.name || 'sequence';
}
