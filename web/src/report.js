// Starts the page of a report: reads the data inside the page, and shows them.
import { fromBase64, readContainer, unzipped } from './data.js';
import { h } from './dom.js';
import { logo, makeTheme } from './theme.js';
import { makeViewer } from './viewer.js';

let viewer;
const theme = makeTheme(() => viewer?.restyle());
const root = document.getElementById('report'), top = document.querySelector('.top'), file = h('span', { className: 'file' });
top.append(logo(), h('h1', {}, 'chronormal'), file, theme.button);

addEventListener('keydown', (event) => {
  if (viewer?.key(event)) event.preventDefault();
  else if (event.key.toLowerCase() === 'd' && !event.ctrlKey && !event.metaKey && !event.target.closest('input, select')) theme.toggle();
});

async function start() {
  const data = document.getElementById('chronormal-data');
  if (!data) throw new Error('This page has no report in it. Make one with `chronormal report FILE -o REPORT.html`.');
  const report = readContainer(await unzipped(fromBase64(data.textContent)));
  data.remove();
  file.textContent = report.input;
  document.title = `${report.input}: chronormal`;
  viewer = makeViewer(root, report);
  globalThis.chronormal = viewer;
  root.dataset.ready = 'true';
}
start().catch((error) => root.replaceChildren(h('p', { className: 'fault', role: 'alert' }, error.message)));
