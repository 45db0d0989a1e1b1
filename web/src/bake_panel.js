// Shows the panel of a bake: the viewers to bake for, the tolerance, the limits of size, the plan, and the bake itself.
import { degreesText } from './colors.js';
import { h, panel, table } from './dom.js';
import { VIEWERS, choiceTable } from './panels.js';

/** The viewers that add up deltas. If the user chooses no viewers, the file is baked for these viewers. */
const ADDING_UP = ['three', 'babylon', 'playcanvas', 'bevy'];

/**
 * Makes the panel of a bake.
 * @param input an entry of `inputs` in page.js; its member `options` has the user's choices: {viewers, tolerance,
 *   maxTargets, maxBytes}. An empty list of viewers stands for the default viewers
 * @param {{plan: () => void, bake: () => void}} acts the functions that run when the user asks for a plan or a bake
 */
export function makeBakePanel(input, { plan, bake }) {
  const chosen = (input.options ??= { viewers: [], tolerance: '', maxTargets: '', maxBytes: '' });
  const USUAL = VIEWERS.map(([name]) => name).filter((name) => ADDING_UP.includes(name));
  const boxes = VIEWERS.map(([name, title]) => {
    const box = h('input', { type: 'checkbox', value: name, checked: (chosen.viewers.length === 0 ? USUAL : chosen.viewers).includes(name), onchange: () => {
      const named = boxes.map((label) => label.firstChild).filter(({ checked }) => checked).map(({ value }) => value);
      chosen.viewers = String(named) === String(USUAL) ? [] : named;
    } });
    return h('label', { className: 'tick' }, box, title);
  });
  const number = (title, name, placeholder, unit) =>
    h('label', { className: 'field wide' }, h('span', {}, title),
      h('input', { type: 'number', min: 0, step: 'any', inputMode: 'decimal', name, placeholder, value: chosen[name], oninput: ({ target }) => (chosen[name] = target.value) }),
      h('span', {}, unit));
  const isGltf = input.came.kind === 'gltf';
  const planned = input.plan && choiceTable({ plan: input.plan.plan });
  if (planned) planned.open = true;
  return panel('Bake', true,
    h('fieldset', {}, h('legend', {}, 'normals become right in these viewers and, where possible, no worse in others'), boxes),
    number('within', 'tolerance', '0.5', 'degrees'),
    isGltf && number('at most', 'maxTargets', 'any', 'targets'),
    number('at most', 'maxBytes', 'any', 'bytes more'),
    h('p', { className: 'acts' }, h('button', { type: 'button', className: 'primary bake', onclick: bake }, 'Bake'),
      isGltf && h('button', { type: 'button', className: 'plain plan', onclick: plan }, 'See the plan')),
    comparison(input), planned);
}

// Returns a table with the errors of the baked file beside the errors of the input, and a note on the size of the file.
function comparison({ came, baked }) {
  if (!baked) return null;
  const row = (title, { audit }) => ({ cells: [title, degreesText(audit.mean_degrees), degreesText(audit.worst_degrees)] });
  const bytes = Object.values(baked.files).reduce((sum, file) => sum + file.length, 0);
  return [table('Before and after', ['', 'average ', 'worst '], [row('as it came', came), row('baked', baked.report)]),
    h('p', { className: 'note' }, `${baked.name} has ${bytes.toLocaleString('en')} bytes.`)];
}
