// Plots the error over the motion. The plot marks the place of the slider, and a click moves the slider there.
import uPlot from 'uplot';
import { degreesText } from './colors.js';

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// uPlot allows no two points at the same x. A motion, however, has two samples at a keyframe or at a key of a track,
// one for each side. The second sample is therefore moved slightly.
const spread = (at) => {
  const x = Float64Array.from(at), gap = (x[x.length - 1] - x[0] || 1) * 1e-9;
  for (let i = 1; i < x.length; ++i) if (x[i] <= x[i - 1]) x[i] = x[i - 1] + gap;
  return x;
};

/** Makes a plot. @param {(x: number) => void} onGo is called with the time or weight that was clicked */
export function makePlot(parent, onGo) {
  let plot, shown, now = 0;
  const line = {
    hooks: {
      draw: ({ ctx, bbox, valToPos }) => {
        const x = Math.round(valToPos.call(plot ?? ctx, now, 'x', true));
        ctx.save();
        ctx.strokeStyle = colour('--accent');
        ctx.lineWidth = 2 * devicePixelRatio;
        ctx.beginPath();
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + bbox.height);
        ctx.stroke();
        ctx.restore();
      },
    },
  };

  function make() {
    plot?.destroy();
    if (!shown) return;
    const { motion, worst, mean } = shown;
    const axis = { stroke: () => colour('--quiet'), grid: { stroke: () => colour('--line'), width: 1 }, ticks: { show: false }, font: '11px system-ui, sans-serif' };
    const unit = motion.seconds ? ' s' : '';
    const series = (label, name, width) => ({
      label, stroke: () => colour(name), width, points: { show: false }, value: (_, v) => degreesText(v ?? NaN),
    });
    const options = {
      width: parent.clientWidth, height: parent.clientHeight, padding: [8, 12, 0, 0],
      legend: { show: false },
      cursor: { drag: { x: false, y: false }, points: { show: false }, y: false },
      scales: { x: { time: false }, y: { range: (_, least, most) => [0, most > 0 ? most * 1.08 : 1] } },
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((x) => `${+x.toFixed(3)}${unit}`) },
             { ...axis, size: 46, space: 22, values: (_, ticks) => ticks.map((y) => `${+y.toFixed(3)}°`) }],
      series: [{}, series('worst', '--worst', 2), series('average', '--mean', 2)],
      plugins: [line],
    };
    const finite = (values) => Array.from(values, (v) => (Number.isFinite(v) ? v : null));
    plot = new uPlot(options, [spread(motion.at), finite(worst), finite(mean)], parent);
    plot.over.addEventListener('click', (event) => onGo(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, 'x')));
  }

  new ResizeObserver(() => make()).observe(parent);
  return {
    show(motion, { worst, mean }) {
      shown = { motion, worst, mean };
      make();
    },
    go(x) {
      now = x;
      plot?.redraw(false);
    },
    restyle: make,
  };
}
