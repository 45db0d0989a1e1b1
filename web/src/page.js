// Runs the page in which a person drops files, looks at them, bakes them and saves the results. Everything happens
// inside the browser.
import { readContainer } from './data.js';
import { h, segmented } from './dom.js';
import { EngineError, makeEngine } from './engine.js';
import { NOTHING_MOVES, faultOf, inputsOf } from './inputs.js';
import { FIGURE_SCHEMES } from './face_panel.js';
import { commandOf } from './faces.js';
import { makeBakePanel } from './bake_panel.js';
import { logo, makeTheme } from './theme.js';
import { makeViewer } from './viewer.js';

const run = makeEngine(document.getElementById('engine'), ENGINE_WORKER);
const root = document.getElementById('report'), top = document.querySelector('.top'), work = document.getElementById('work');
// The open inputs. Each is {name, args, bytes: {name: Uint8Array}, came, options, plan, baked: {report, name, files,
// warnings, within}}. `came` is the report of the unchanged input, and `baked` is the result of a bake.
const inputs = [];
const DOCUMENT = /\.(glb|gltf|vrm)$/i;
let viewer, current, abort;

const theme = makeTheme(() => viewer?.restyle());
const picker = h('input', { type: 'file', multiple: true, hidden: true, onchange: () => (add(picker.files), (picker.value = '')) });
const chooser = h('select', { 'aria-label': 'file', className: 'file-choice', hidden: true, onchange: () => show(inputs[chooser.value], 'came') });
const sides = segmented('which file is shown', [['came', 'As it came'], ['baked', 'Baked']], (side) => show(current, side));
const download = h('button', { type: 'button', className: 'primary', hidden: true, onclick: save }, 'Download');
const more = h('button', { type: 'button', className: 'plain', hidden: true, onclick: () => picker.click() }, 'Open…');
sides.hidden = true;
top.append(logo(), h('h1', {}, 'chronormal'), chooser, h('span', { className: 'file' }), sides, download, more, theme.button, picker);

const message = h('div', { className: 'message', role: 'alert', hidden: true });
const busy = h('div', { className: 'busy', role: 'status', hidden: true });
work.append(message, busy);

/** Shows an error until the next action begins. `details` are the messages of the program. Without a text, hides the
 * last error. */
function say(text, details) {
  message.hidden = !text;
  message.classList.remove('mild');
  message.replaceChildren(...(text ? [h('div', {}, h('p', {}, text), details && h('pre', {}, details)),
    h('button', { type: 'button', className: 'plain', onclick: () => say() }, 'Close')] : []));
}

/** Shows a remark beside a result; `details` are hidden until a person opens them. */
function remark(text, details) {
  say(text);
  message.classList.add('mild');
  message.firstChild.append(h('details', {}, h('summary', {}, 'Message of the program'), h('pre', {}, details)));
}

/** Runs a step, which may run several commands, with a progress bar and a button that stops it. Returns the result of
 * the step, or undefined if it failed. */
async function during(title, step) {
  if (abort) return undefined;
  abort = new AbortController();
  const bar = h('progress', { max: 100 }), label = h('span', {}, title);
  busy.replaceChildren(label, bar, h('button', { type: 'button', className: 'plain', onclick: () => abort?.abort() }, 'Cancel'));
  busy.hidden = false;
  const { signal } = abort;
  const onProgress = ({ label: text, percent }) => {
    bar.value = percent;
    label.textContent = `${title}: ${text.trim()}`;
  };
  try {
    return await step((args, files) => run(args, files, { signal, onProgress }));
  } catch (error) {
    if (!signal.aborted) explain(error);
    return undefined;
  } finally {
    abort = undefined;
    busy.hidden = true;
  }
}

const TOO_LARGE = 'The browser does not have enough memory for this file. Close other pages, or use the chronormal program on your computer.';
const UNUSABLE = 'This file cannot be used. The message below says where the file is wrong; exporting the model again often helps.';

function explain(error) {
  if (!(error instanceof EngineError)) return say(error.message);
  if (/memory/i.test(error.message)) return say(TOO_LARGE, error.message);
  if (/nothing to show/.test(error.message)) return say(NOTHING_MOVES, error.message);
  say(error.code === 3 ? UNUSABLE : 'The program failed. Its message below says why.', error.message);
}

async function reportOf(call, { args, bytes }) {
  const viewers = args.some((name) => DOCUMENT.test(name)) ? ['--for', 'all'] : [];
  const { files } = await call(['report', ...args, '--no-plan', ...viewers, '-o', 'out/report.bin'], bytes);
  return readContainer(files['report.bin']);
}

// Reads a file into `bytes`. Returns a sentence with the reason on failure, and undefined otherwise.
async function read(file, bytes) {
  try {
    bytes[file.name] = new Uint8Array(await file.arrayBuffer());
    return undefined;
  } catch {
    return `“${file.name}” could not be read. Perhaps the file was moved, or is a folder. Choose the file again.`;
  }
}

// Reads the files of an input. Returns a sentence with the reason if they cannot be used, and undefined otherwise.
// Files to which a .gltf refers may have any content.
async function load({ args, files }, bytes) {
  for (const file of files) {
    const isInput = args.includes(file.name);
    const fault = faultOf(file.name, file.size) ?? (await read(file, bytes)) ?? (isInput ? faultOf(file.name, file.size, bytes[file.name]) : undefined);
    if (fault) return fault;
  }
  return undefined;
}

async function add(list) {
  if (abort) return say('The page is still working. Wait until the work is done, or click Cancel.');
  say();
  const faults = [];
  for (const input of inputsOf(list)) {
    const bytes = {}, fault = await load(input, bytes);
    if (fault) faults.push(fault);
    else await open({ name: input.name, args: input.args, bytes });
  }
  if (faults.length > 0) say(faults.join(' '));
}

async function open(input) {
  const came = await during(`Checking ${input.name}`, (call) => reportOf(call, input));
  if (!came) return;
  inputs.push({ ...input, came });
  chooser.append(h('option', { value: inputs.length - 1 }, input.name));
  show(inputs.at(-1), 'came');
}

// Computes the figures of a face on its path, with samples at 41 times. The tables of the paper have samples at 21
// times.
async function figureOf(way) {
  const { args, files } = commandOf(way, FIGURE_SCHEMES, 41), { stdout } = await run(args, files, { signal: new AbortController().signal, onProgress() {} });
  return JSON.parse(stdout).figure;
}

// Loads a generated morph, for people who have no file at hand.
async function example() {
  const made = await during('Making an example', (call) => call(['convert', '--sample', 'bumps', '-o', 'out/bumps.glb'], {}));
  if (made) await open({ name: 'bumps.glb', args: ['bumps.glb'], bytes: { 'bumps.glb': made.files['bumps.glb'] } });
}

function show(input, side) {
  current = input;
  const shown = side === 'baked' ? input.baked.report : input.came;
  chooser.hidden = inputs.length < 2;
  chooser.value = inputs.indexOf(input);
  top.querySelector('.file').textContent = inputs.length < 2 ? input.name : '';
  sides.hidden = !input.baked;
  sides.choose(side);
  download.hidden = !input.baked;
  more.hidden = false;
  work.querySelector('.welcome')?.remove();
  viewer?.close();
  viewer = makeViewer(root, shown, figureOf);
  const bake = makeBakePanel(input, { plan: () => plan(input), bake: () => make(input) });
  root.querySelector('.verdict').after(bake);
  Object.assign(globalThis, { chronormal: viewer });
  root.dataset.ready = `${inputs.indexOf(input)} ${side}`;
}

const flagsOf = ({ viewers, tolerance, maxTargets, maxBytes }) => [
  ...(viewers.length > 0 ? ['--for', viewers.join(',')] : []), ...(tolerance ? ['--tolerance', tolerance] : []),
  ...(maxTargets ? ['--max-targets', maxTargets] : []), ...(maxBytes ? ['--max-bytes', maxBytes] : []),
];

async function plan(input) {
  say();
  const done = await during('Planning the bake', (call) => call(['bake', ...input.args, '--plan', '--json', ...flagsOf(input.options)], input.bytes));
  if (!done) return;
  input.plan = { plan: JSON.parse(done.stdout), said: done.stderr };
  show(input, 'came');
}

async function make(input) {
  say();
  const name = input.args.length === 1 && DOCUMENT.test(input.args[0]) ? input.args[0].replace(/(\.[^.]+)$/, '.right$1') : 'baked.glb';
  const found = await during('Baking', async (call) => {
    const done = await call(['bake', ...input.args, '--json', ...flagsOf(input.options), '-o', `out/${name}`], input.bytes);
    const report = await reportOf(call, { args: [name], bytes: { ...input.bytes, ...done.files } });
    return { report, name, files: done.files, warnings: done.stderr, within: done.code === 0 };
  });
  if (!found) return;
  input.baked = found;
  show(input, 'baked');
  const text = found.within ? 'The file is baked, with these notes.' : 'The file is baked, but its errors are larger than your tolerance. Accept a larger error, or allow more targets or bytes.';
  if (found.warnings) remark(text, found.warnings);
}

function save() {
  for (const [name, bytes] of Object.entries(current.baked.files)) {
    const address = URL.createObjectURL(new Blob([bytes]));
    h('a', { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  }
}

work.append(h('section', { className: 'welcome' },
  h('h2', {}, 'Are the normals of your model right while it moves?'),
  h('p', {}, 'Drop one or several .glb files here. You see your model as viewers show it beside correct shading, with the error in degrees, ' +
    'and can download a corrected file, in which only the normals have changed.'),
  h('p', {}, h('button', { type: 'button', className: 'primary', onclick: () => picker.click() }, 'Choose files'), ' ',
    h('button', { type: 'button', className: 'plain', onclick: example }, 'Show me an example')),
  h('p', { className: 'note' }, 'GLB, VRM, glTF with its .bin; keyframes as OBJ or PLY; a mesh with a .pc2, .mdd, .npy or Maya cache.'),
  h('p', { className: 'note' }, 'Nothing is sent anywhere: the whole program is in this page, and it works without a network.')));

for (const name of ['dragover', 'dragleave', 'drop']) {
  addEventListener(name, (event) => {
    event.preventDefault();
    document.body.classList.toggle('dropping', name === 'dragover');
    if (name === 'drop') add(event.dataTransfer.files);
  });
}

addEventListener('keydown', (event) => {
  if (viewer?.key(event)) event.preventDefault();
  else if (event.key.toLowerCase() === 'd' && !event.ctrlKey && !event.metaKey && !event.target.closest('input, select')) theme.toggle();
});
document.body.dataset.ready = 'true';
