// Makes the panels beside the picture: the choices, and the tables of the report.
import { h, panel, table } from './dom.js';
import { degreesText } from './colors.js';
import { momentOf, nameOf, worstSample } from './motions.js';
import { SCHEMES } from './schemes.js';

/** The viewers that a bake can consider, with their names for people. */
export const VIEWERS = [
  ['three', 'three.js'], ['babylon', 'Babylon.js'], ['playcanvas', 'PlayCanvas'], ['godot', 'Godot 4'], ['filament', 'Filament'], ['bevy', 'Bevy'],
  ['gltfpack', 'after gltfpack'], ['quantize', 'after quantize'], ['meshopt', 'after meshopt'],
];

const count = (n) => n.toLocaleString('en');
export const plural = (n, one, many = `${one}s`) => `${count(n)} ${n === 1 ? one : many}`;
const select = (label, options, value, onChoose) => {
  const box = h('select', { 'aria-label': label, title: options.find(([key]) => String(key) === String(value))?.[1] ?? '', onchange: () => onChoose(box.value) },
    options.map(([key, text]) => h('option', { value: key, selected: String(key) === String(value) }, text)));
  return h('label', { className: 'field' }, h('span', {}, label), box);
};

const viewerTitle = (report, name) =>
  name === 'specification' ? 'the glTF specification' : report.audit?.viewers?.find((viewer) => viewer.name === name)?.title ?? name;

/** Returns the label above the picture, which says how the normals in the picture are rendered. */
export const shownBy = (report, player) => {
  if (report.kind !== 'gltf') return player.scheme === 'linear' ? 'As rendered, with normals interpolated between keyframes' : `As rendered by ${player.scheme}`;
  if (player.viewer === 'specification') return 'As rendered';
  const title = viewerTitle(report, player.viewer);
  return title.startsWith('after ') ? `As rendered ${title}` : `As rendered by ${title}`;
};

/** Makes the menus that choose the part, the motion, and for a glTF file the viewer. */
export function choosers(report, player) {
  const box = h('div', { className: 'choosers' });
  const fill = () => {
    const { part } = player, fields = [];
    if (report.parts.length > 1) {
      fields.push(select('mesh', report.parts.map(({ name, mesh }, i) => [i, name || `mesh ${mesh ?? i}`]), player.index, (i) => player.choosePart(Number(i))));
    }
    if (part.motions.length > 0) {
      const motions = part.motions.map((motion, i) => [i, `${degreesText(motion.worst[worstSample(motion)])} · ${nameOf(motion)}`]);
      const chosen = player.byHand ? 'hand' : player.motionNumber;
      fields.push(select('motion', player.byHand ? [['hand', 'weights set by hand'], ...motions] : motions, chosen,
        (i) => i !== 'hand' && player.chooseMotion(Number(i))));
    }
    if (player.viewers.length > 1) {
      fields.push(select('viewer', player.viewers.map((name) => [name, viewerTitle(report, name)]), player.viewer, player.chooseViewer));
    }
    if (player.schemes().length > 0) {
      fields.push(select('scheme', player.schemes().map((name) => [name, SCHEMES[name].title]), player.scheme, player.chooseScheme));
    }
    box.replaceChildren(...fields);
  };
  return { box, fill };
}

/** Returns the worst places of a report whose errors are not negligible, the worst first. */
export const shownPlaces = ({ worst }) => worst.filter(({ degrees }) => degrees >= 0.0005);

/** Makes the list of the worst places. A click on a place calls onVisit. */
export function worstPlaces(report, onVisit) {
  const places = shownPlaces(report);
  if (places.length === 0) return null;
  // Leaves out the words with which the labels of all places begin alike.
  const pieces = places.map(({ label }) => label.split(', '));
  const same = pieces[0].findIndex((piece, i) => i === pieces[0].length - 1 || pieces.some((other) => other[i] !== piece));
  const item = ({ part, motion, sample, degrees, label }, i) => {
    const moment = h('small', {}, momentOf(report.parts[part].motions[motion], sample));
    const place = h('span', { title: label }, pieces[i].slice(same).join(', '), moment);
    return h('li', {}, h('button', { type: 'button', onclick: () => onVisit(i) }, h('b', {}, degreesText(degrees)), place));
  };
  const list = h('ol', { className: 'places' }, places.map(item));
  return panel(`Worst places (${places.length})`, true, list);
}

/** Makes a slider for each target of the file that is not a correction target. */
export function weightSliders(player) {
  const list = h('div', { className: 'weights' }), reset = h('button', { type: 'button', className: 'plain', onclick: player.rest }, 'All to 0');
  const note = h('p', { className: 'note' });
  const box = panel('Weights', false, h('p', {}, reset), list, note);
  let rows = [];
  return {
    box,
    fill() {
      const own = player.part.targets.flatMap(({ name, extra }, k) => (extra ? [] : [{ k, name: name || `target ${k}` }]));
      const extras = player.part.targets.length - own.length;
      rows = own.map(({ k, name }) => {
        const number = h('output', {}, '0'), oninput = () => player.setWeight(k, Number(slider.value));
        const slider = h('input', { type: 'range', min: 0, max: 1, step: 0.01, 'aria-label': name, oninput });
        return { k, slider, number, row: h('label', {}, h('span', { title: name }, name), slider, number) };
      });
      list.replaceChildren(...rows.map(({ row }) => row));
      note.textContent = extras === 0 ? '' : player.formulas.length === extras
        ? `${plural(extras, 'correction target follows', 'correction targets follow')} these weights, as the file says.`
        : `${plural(extras - player.formulas.length, 'correction target only follows the animations of the file, and stays',
          'correction targets only follow the animations of the file, and stay')} at 0 here.`;
      box.hidden = own.length === 0;
    },
    follow() {
      if (!box.open) return;
      for (const { k, slider, number } of rows) {
        const weight = player.weights[k], text = weight.toFixed(2);
        if (number.textContent === text) continue;
        if (document.activeElement !== slider || !player.byHand) slider.value = weight;
        number.textContent = text;
      }
    },
  };
}

const TORN = '99.9 % of all errors are below the value in the column 99.9 %. Across a torn edge the error jumps by more than 10 degrees, which looks like a fold that the surface does not have. The column torn has the average number of torn edges at a moment.';

// Returns the average number of torn edges at a moment, or an empty text if the number is not known.
const tornText = ({ torn_edges: torn }) => (torn?.[0] === undefined ? '' : torn[0] > 0 && torn[0] < 10 ? torn[0].toFixed(1) : count(Math.round(torn[0])));

/** Makes a table of the audit, with a row for each viewer. */
export function viewerTable({ audit }) {
  if (!audit?.viewers?.length) return null;
  const row = (title, error) => {
    const { worst_degrees: worst, percentile_99_9_degrees: most, mean_degrees: mean } = error;
    return { cells: [title, degreesText(mean), degreesText(most), degreesText(worst), tornText(error)] };
  };
  const rows = [row('the glTF specification', audit), ...audit.viewers.map((viewer) => row(viewer.title, viewer))];
  return panel('What viewers show', false, table('Errors in each viewer', ['viewer', 'average ', '99.9\u00a0% ', 'worst ', 'torn '], rows),
    h('p', { className: 'note' }, TORN));
}

// Returns the largest average error of a candidate in the viewers that the bake is not for, in degrees; undefined if
// there is no such viewer. The errors are those over the animations of the file, or else over the other poses.
function errorElsewhere({ viewers = [] }) {
  const means = viewers.filter(({ named }) => !named).flatMap(({ file, posed, alone }) => (file ? [file] : [posed, alone]).map((poses) => poses?.after.mean_degrees));
  const known = means.filter((mean) => mean >= 0);
  return known.length > 0 ? Math.max(...known) : undefined;
}

// Returns a name for each candidate of a mesh. Candidates of one kind have different deltas, and are numbered.
function namesOf(candidates) {
  const kinds = candidates.map(({ name, animations_only: only }) => (only ? `${name}, animations only` : name));
  return kinds.map((kind, i) => (kinds.indexOf(kind) === kinds.lastIndexOf(kind) ? kind : `${kind}\u00a0${kinds.slice(0, i + 1).filter((other) => other === kind).length}`));
}

/** Makes a table of the size and errors of each candidate of a bake, like `bake --plan`. */
export function choiceTable({ plan, plan_message: message }) {
  if (!plan) return message ? panel('What a bake would write', false, h('p', { className: 'note' }, message)) : null;
  const meshes = plan.meshes.filter(({ candidates }) => candidates?.length), all = meshes.flatMap(({ candidates }) => candidates);
  if (all.length === 0) return null;
  const hasElsewhere = all.some((candidate) => errorElsewhere(candidate) !== undefined);
  const titles = ['candidate', 'targets ', 'bytes added ', 'average ', 'worst ', ...(hasElsewhere ? ['else\u00adwhere '] : [])];
  const tables = meshes.map(({ mesh, name, candidates }) => {
    const names = namesOf(candidates);
    const rows = candidates.map(({ targets, bytes, played, chosen, ...candidate }, i) => ({
      className: chosen ? 'chosen' : '',
      cells: [chosen ? `✓\u00a0${names[i]}` : names[i], count(targets), count(bytes), degreesText(played?.mean_degrees), degreesText(played?.worst_degrees),
        ...(hasElsewhere ? [degreesText(errorElsewhere(candidate))] : [])],
    }));
    return [plan.meshes.length > 1 && h('h3', {}, name || `mesh ${mesh}`), table('Candidates of a bake', titles, rows)];
  });
  const { viewers = [] } = all[0], titlesOf = (named) => viewers.filter((viewer) => viewer.named === named).map(({ viewer }) => new Map(VIEWERS).get(viewer) ?? viewer).join(', ');
  const poses = viewers.some(({ file }) => file) ? 'over the animations of the file' : 'over each target alone and the poses that were given';
  const sentences = [
    `Errors are in degrees, ${poses}${viewers.length > 0 ? `, in the worst of these viewers: ${titlesOf(true)}` : ''}. Bake writes the marked candidate.`,
    hasElsewhere && `The column elsewhere has the average error in the worst of the other viewers: ${titlesOf(false)}.`,
    meshes.some(({ candidates }) => namesOf(candidates).some((name, i) => /\u00a0\d+$/.test(name) && name !== candidates[i].name)) &&
      'Candidates of one kind are numbered in the order in which bake made them; their deltas differ.',
  ];
  return panel('What a bake would write', false, tables, sentences.filter(Boolean).map((sentence) => h('p', { className: 'note' }, sentence)));
}

/** Makes a table of the errors of each scheme on this motion. A click on a scheme shows its normals. */
export function schemeTable(report, player) {
  const found = report.compare?.schemes;
  if (!found?.length) return null;
  const rows = found.map(({ scheme, mean_degrees: mean, max_degrees: worst }) => {
    const name = scheme in SCHEMES ? h('button', { type: 'button', className: 'link', onclick: () => player.chooseScheme(scheme) }, scheme) : scheme;
    return { cells: [name, degreesText(mean), degreesText(worst)] };
  });
  return panel('Ways to interpolate', true, table('Schemes', ['scheme', 'average ', 'worst '], rows));
}

/** Makes a panel that lists the parts of the input that are not in the report. */
export const notes = ({ thinned }) =>
  thinned?.length ? panel('What was left out here', true, h('ul', {}, thinned.map((sentence) => h('li', {}, sentence)))) : null;

/** Returns a sentence about the size of the errors of the file's normals. */
export function verdict({ audit }) {
  if (!audit) return '';
  const { worst_degrees: worst, mean_degrees: mean, judged } = audit;
  if (judged === 0 && !audit.cancelled) return 'Nothing in this file moves by morph targets, so there is nothing to judge.';
  if (audit.cancelled > 0 && worst < 0.5) {
    return `At some moment, the normals of the faces around ${plural(audit.cancelled, 'drawn vertex', 'drawn vertices')} cancel each other, so no normal is right there. All others are right within ${degreesText(worst)}.`;
  }
  if (worst < 0.5) return `Normals are right within ${degreesText(worst)} wherever this file moves.`;
  const torn = audit.torn_edges?.[0] >= 0.05 ? `, and ${tornText(audit)} edges are torn on average` : '';
  return `Normals have errors of ${degreesText(mean)} on average and of up to ${degreesText(worst)} while this moves${torn}.`;
}
