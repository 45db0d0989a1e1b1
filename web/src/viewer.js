// Shows a report: the picture, the slider and the plot below the picture, and the panels beside it.
import { h, panel, segmented } from './dom.js';
import { degreesText, gradient, scaleEnd } from './colors.js';
import { makeFacePanel } from './face_panel.js';
import { choiceTable, choosers, viewerTable, notes, plural, schemeTable, shownBy, shownPlaces, verdict, weightSliders, worstPlaces } from './panels.js';
import { worstSample } from './motions.js';
import { makePlayer } from './player.js';
import { makePlot } from './plot.js';
import { makeView } from './view.js';

const KEYS = [
  ['Space', 'play or pause the motion'], ['← →', 'go one moment back or on, or ten with Shift'], ['1 2 3', 'show the lit mesh, normals as colours, or the error'],
  ['W', 'show two pictures side by side, or as a wipe'], ['N P', 'go to the next or previous of the worst places'], ['F', 'show the whole mesh'], ['D', 'change between dark and light'], ['?', 'show these keys'],
];

// A report opens at one of its first MOST_TRIED places whose error is at least LEAST_SHARE of the worst error.
const MOST_TRIED = 12, LEAST_SHARE = 0.5;

const SCALES = [0.1, 0.5, 1, 2, 5, 10, 20, 45, 90, 180];

/** Returns a label for a vertex, with the numbers of its mesh, its primitive and the vertex in the file. */
function labelOf(part, vertex) {
  const found = part.primitives.findIndex(({ first, count }) => vertex >= first && vertex < first + count);
  const primitive = part.primitives[found], number = part.labels ? part.labels[vertex] : vertex - (primitive?.first ?? 0);
  const names = [part.mesh === null || part.mesh === undefined ? '' : `mesh ${part.mesh}`,
    part.mesh !== null && part.primitives.length > 1 ? `primitive ${primitive?.primitive ?? found}` : '', `vertex ${number}`];
  return names.filter(Boolean).join(', ');
}

/**
 * Fills an element with a report.
 * @param {HTMLElement} root the element
 * @param report from readContainer()
 * @param compute asks the program for the figures of a face (face_panel.js); undefined without a program
 * @returns {{player, view, visit, key, restyle}} the parts that tests and the pages around this one use
 */
export function makeViewer(root, report, compute) {
  const stage = h('div', { className: 'stage' }), tip = h('div', { className: 'tip', hidden: true });
  const view = makeView(stage, point, (triangle) => faces.pick(triangle));
  const slider = h('input', { type: 'range', className: 'time', 'aria-label': 'moment of the motion', min: 0, max: 1, step: 'any' });
  const button = (className, title, onclick, text = '') => h('button', { type: 'button', className, title, 'aria-label': title, onclick }, text);
  const play = button('round', 'play, pause', () => player.toggle()), moment = h('output', { className: 'moment' });
  const now = h('button', { type: 'button', className: 'plain now', title: 'Go to this vertex', onclick: () => view.visit(player.worst) });
  const plotBox = h('div', { className: 'plot', role: 'img', 'aria-label': 'the error over the motion' });
  const low = h('span', {}, '0°'), high = h('span', {}), bar = h('i', {});
  bar.style.background = gradient();
  const scale = h('select', { 'aria-label': 'largest error on the scale, in degrees', onchange: () => setScale() },
    h('option', { value: 'auto' }, 'scale: auto'), SCALES.map((end) => h('option', { value: end }, `0 to ${end}°`)));
  const legend = h('div', { className: 'legend' }, low, bar, high, scale);
  const drawings = [['lit', 'Lit', 'Lit (1)'], ['normals', 'Normals', 'Normals as colours (2)'], ['error', 'Error', 'The angle between the rendered and the true normals (3)']];
  const modes = segmented('what is drawn', drawings, setMode), layouts = segmented('how the two pictures are arranged', [['side', 'Side by side'], ['wipe', 'Wipe']], setLayout);
  const plot = makePlot(plotBox, (x) => (player.pause(), player.goTo(x)));
  let visited = -1;

  const player = makePlayer(report, changed);
  const chooser = choosers(report, player);
  const weights = report.kind === 'gltf' ? weightSliders(player) : null;
  const faces = makeFacePanel(report, player, view, compute);
  const places = worstPlaces(report, visit);
  const stops = shownPlaces(report).length, next = () => visit((visited + 1) % stops), previous = () => visit((visited <= 0 ? stops : visited) - 1);
  const help = h('dialog', { className: 'help' }, h('h2', {}, 'Keys'),
    h('dl', {}, KEYS.map(([key, what]) => [h('dt', {}, key), h('dd', {}, what)])),
    h('p', {}, 'Drag to turn the mesh, pinch or scroll to come nearer, and drag with two fingers or the right button to move the mesh. The vertex under the pointer is named with its error.'),
    h('form', { method: 'dialog' }, h('button', { className: 'plain' }, 'Close')));
  stage.append(tip);
  root.classList.add('viewer');
  root.replaceChildren(
    h('section', { className: 'scene' },
      h('div', { className: 'toolbar' }, modes, layouts, button('plain', 'Show the whole mesh (F)', () => view.frame(), 'Whole mesh'),
        button('plain keys', 'Keys (?)', () => help.showModal(), '?')),
      stage, legend, h('div', { className: 'timeline' }, play, slider, moment),
      h('div', { className: 'here' }, now, h('span', { className: 'key', 'aria-hidden': true })), plotBox),
    h('aside', { className: 'panels' }, h('p', { className: 'verdict' }, verdict(report)), chooser.box, places, faces.box, weights?.box,
      schemeTable(report, player), viewerTable(report), choiceTable(report), notes(report), aboutOf(report)),
    help);

  function point(found) {
    tip.hidden = !found;
    if (!found) return;
    tip.textContent = `${degreesText(player.surface.degrees[found.vertex])} · ${labelOf(player.part, found.vertex)}`;
    const left = Math.min(found.x + 14, stage.clientWidth - 180);
    tip.style.transform = `translate(${Math.max(left, 4)}px, ${Math.max(found.y - 34, 4)}px)`;
  }

  function setMode(mode) {
    view.mode = mode;
    modes.choose(mode);
    legend.classList.toggle('off', mode !== 'error');
    label();
    view.request();
  }
  function setLayout(layout) {
    view.setLayout(layout);
    layouts.choose(layout);
  }
  // Sets the end of the colour scale: the choice of the user, or else the 99th percentile of the errors, or else the
  // worst error.
  function setScale() {
    const { motion } = player, subject = motion && report.audit?.subjects?.[motion.subject ?? -1];
    const typical = subject?.percentile_99_degrees ?? (motion ? motion.worst[worstSample(motion)] : 1);
    const end = scale.value === 'auto' ? scaleEnd(typical || 1) : Number(scale.value);
    view.setScale(end);
    high.textContent = end < 180 ? `${end}° and more` : '180°';
  }
  const label = () => view.setLabels([shownBy(report, player), view.mode === 'error' ? 'The error, in degrees' : 'As it should be']);

  function changed(what) {
    const { motion, part, surface } = player;
    if (what === 'part') {
      view.show(part, surface);
      faces.leave();
      weights?.fill();
    }
    if (what === 'motion') {
      Object.assign(slider, motion ? { min: motion.at[0], max: motion.at[motion.at.length - 1], disabled: false } : { disabled: true });
      play.disabled = !motion;
      chooser.fill();
      setScale();
      showPlot();
    }
    if (what === 'viewer') {
      label();
      chooser.fill();
      showPlot();
    }
    if (what === 'play') {
      play.textContent = player.isPlaying ? '❚❚' : '▶';
      play.setAttribute('aria-label', player.isPlaying ? 'pause' : 'play');
    }
    if (what === 'step') {
      const value = player.value();
      if (player.byHand !== changed.byHand) chooser.fill();
      changed.byHand = player.byHand;
      if (motion && !player.byHand) {
        slider.value = value;
        plot.go(value);
      }
      moment.textContent = player.byHand || !motion ? 'by hand' : motion.seconds ? `${value.toFixed(2)} s` : `weight ${value.toFixed(2)}`;
      const { worst } = player, degrees = worst < 0 ? NaN : surface.degrees[worst];
      now.textContent = worst < 0 ? 'Nothing can be judged here' : `Worst at this moment: ${degreesText(degrees)} at ${labelOf(part, worst)}`;
      now.disabled = worst < 0;
      now.dataset.degrees = degrees;
      now.dataset.vertex = worst;
      weights?.follow();
      view.update();
    }
  }
  // Plots the errors that the audit computed for the viewer, or the errors of the scheme that is shown.
  function showPlot() {
    const { motion } = player;
    plotBox.hidden = !motion || motion.at.length < 2;
    if (!plotBox.hidden) plot.show(motion, motion.schemes?.find(({ name }) => name === player.scheme) ?? motion);
  }
  function visit(i) {
    if (stops === 0) return;
    visited = i;
    const vertex = player.visit(report.worst[i]);
    places?.querySelectorAll('button').forEach((button, n) => button.setAttribute('aria-current', String(n === i)));
    view.visit(vertex);
  }

  // Opens the report at the worst place that is visible from slightly beside the front or, if there is no such place,
  // at the worst place that is visible along its true normal. The worst place of all can be invisible, for example
  // where a target pushes a face into the mesh, and the reader would see nothing wrong. If none of the first places is
  // visible, opens the report at the worst place.
  function open() {
    const [first] = report.worst;
    if (!first) {
      player.choosePart(0);
      return view.frame(true);
    }
    const tried = shownPlaces(report).filter(({ degrees }) => degrees >= LEAST_SHARE * first.degrees).slice(0, MOST_TRIED);
    if ([false, true].some((turns) => tried.some((place) => view.frameWith(player.visit(place), turns)))) return;
    const vertex = player.visit(first);
    view.frame(true);
    view.mark(vertex);
  }

  slider.addEventListener('input', () => {
    player.pause();
    player.goTo(Number(slider.value));
  });
  if (weights) weights.box.addEventListener('toggle', weights.follow);

  const keys = {
    ' ': () => player.toggle(), ArrowLeft: (shift) => player.step(shift ? -10 : -1), ArrowRight: (shift) => player.step(shift ? 10 : 1),
    1: () => setMode('lit'), 2: () => setMode('normals'), 3: () => setMode('error'), w: () => setLayout(view.layout === 'side' ? 'wipe' : 'side'),
    n: next, p: previous, f: () => view.frame(), '?': () => help.showModal(),
  };
  /** Handles a key. Returns true if the key has a function here. */
  function key({ key: name, shiftKey, target, ctrlKey, metaKey, altKey }) {
    const act = keys[name.length === 1 ? name.toLowerCase() : name];
    const isOwn = target.closest('select, dialog, input:not(.time), summary') || (name === ' ' && target.closest('button'));
    if (!act || isOwn || ctrlKey || metaKey || altKey || !player.surface) return false;
    if (name.startsWith('Arrow')) player.pause();
    act(shiftKey);
    return true;
  }

  changed('play');
  setMode('lit');
  layouts.choose('side');
  if (report.parts.length > 0) {
    open();
    changed('viewer');
  }
  return {
    player, view, faces, visit, key, setMode, setLayout, close: () => (player.pause(), view.close()),
    restyle: () => (plot.restyle(), faces.restyle(), view.request()),
  };
}

function aboutOf(report) {
  const lines = [];
  const vertices = report.parts.reduce((sum, part) => sum + part.vertices, 0), triangles = report.parts.reduce((sum, part) => sum + part.triangles.length / 3, 0);
  lines.push(`This page draws ${plural(vertices, 'vertex', 'vertices')} and ${plural(triangles, 'triangle')}.`);
  const names = { area: 'the area of faces', angle: 'the angle of corners', 'area-angle': 'area times angle' };
  const weightings = [...new Set(report.parts.map(({ weighting }) => names[weighting] ?? weighting))].join(', or ');
  const kept = report.parts.some(({ truth }) => truth) ? 'Polygons and edited normals of the author are kept' : 'Normals that the author edited at rest are kept';
  if (weightings) lines.push(`True normals are the exact ones, weighted by ${weightings}. ${kept}.`);
  lines.push(`All numbers were computed by ${report.program}. This page loads and sends nothing.`);
  return panel('About', false, lines.map((line) => h('p', { className: 'note' }, line)));
}
