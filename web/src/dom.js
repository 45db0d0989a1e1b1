// Makes elements of the page. Text is always set as text and never as HTML, because names in files come from strangers.

/** Makes an element: h('button', { onclick, className, ... }, children...). Children are elements or text; null and
 * false are left out. */
export function h(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else if (name.startsWith('aria-') || name.startsWith('data-') || name === 'for') made.setAttribute(name, value);
    else made[name] = value;
  }
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false));
  return made;
}

/** Makes a group of buttons of which exactly one is pressed. `choices` is [[value, text, title], ...]. */
export function segmented(label, choices, onChoose) {
  const buttons = choices.map(([value, text, title]) => h('button', { type: 'button', title: title ?? text, onclick: () => onChoose(value) }, text));
  const group = h('div', { className: 'segmented', role: 'group', 'aria-label': label }, buttons);
  group.choose = (value) => buttons.forEach((button, i) => button.setAttribute('aria-pressed', String(choices[i][0] === value)));
  return group;
}

/** Makes a panel that the user can open and close. */
export const panel = (title, isOpen, ...children) =>
  h('details', { className: 'panel', open: isOpen }, h('summary', {}, title), h('div', { className: 'content' }, children));

/** Makes a table whose cells are text or elements. A title that ends with a space marks a column of numbers. */
export function table(caption, titles, rows) {
  const numbers = titles.map((title) => title.endsWith(' '));
  const cell = (tag, value, i) => h(tag, { className: numbers[i] ? 'number' : '' }, value);
  return h('div', { className: 'scrolled' }, h('table', { 'aria-label': caption },
    h('thead', {}, h('tr', {}, titles.map((title, i) => cell('th', title.trim(), i)))),
    h('tbody', {}, rows.map(({ cells, ...properties }) => h('tr', properties, cells.map((value, i) => cell('td', value, i)))))));
}
