// Where a motion is: `at` counts its samples, and a fraction lies between two of them.

/** The time or weight at a place. */
export function valueAt({ at: values }, at) {
  const from = Math.min(Math.floor(at), values.length - 1), to = Math.min(from + 1, values.length - 1);
  return values[from] + (at - from) * (values[to] - values[from]);
}

/** The place of a time or weight; where two samples have it, that of the later one. */
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

/** The sample before or after, which is at another time. */
export function neighbour({ at: values }, at, step) {
  const last = values.length - 1, start = valueAt({ at: values }, at);
  let next = step > 0 ? Math.floor(at) + 1 : Math.ceil(at) - 1;
  while (next > 0 && next < last && values[next] === start) next += step;
  return Math.min(Math.max(next, 0), last);
}

// A sample whose keyframes were left out of the report.
const LEFT_OUT = 0xffffffff;

/** Segment and t of a motion of keyframes at a place; where its keyframes were left out, those of the nearest place that has some. */
export function segmentAt({ segment, t }, at) {
  const last = segment.length - 1, from = Math.min(Math.floor(at), last), to = Math.min(from + 1, last);
  if (segment[from] !== LEFT_OUT) return [segment[from], t[from] + (segment[from] === segment[to] ? (at - from) * (t[to] - t[from]) : 0)];
  for (let step = 1; ; ++step) {
    for (const i of [from - step, from + step]) if (i >= 0 && i <= last && segment[i] !== LEFT_OUT) return [segment[i], t[i]];
    if (step > last) return [0, 0];
  }
}

/** The sample at which the numbers of a motion are the worst. */
export const worstSample = ({ worst }) => worst.reduce((best, value, i) => (value > worst[best] || !(worst[best] >= 0) ? i : best), 0);

/** A sample for people: "jawOpen at 0.55", "talk at 1.25 s". */
export function momentOf(motion, sample) {
  const name = motion.name || (motion.kind === 'target' ? `target ${motion.target}` : motion.kind === 'expression' ? `expression ${motion.expression}` : '');
  return `${name ? `${name} at ` : ''}${+motion.at[sample].toFixed(3)}${motion.seconds ? ' s' : ''}`;
}

/** What a motion is called, for people. */
export function nameOf(motion) {
  if (motion.kind === 'target') return motion.name || `target ${motion.target}`;
  if (motion.kind === 'track') return `animation ${motion.name || motion.animation}`;
  if (motion.kind === 'expression') return motion.name || `expression ${motion.expression}`;
  return motion.name || 'sequence';
}
