// Chooses the theme, dark or light. The theme follows the system until a person presses the button.
import { h } from './dom.js';

/** Makes the button that changes the theme. @param {() => void} onChange is called after the colours have changed */
export function makeTheme(onChange) {
  const system = matchMedia('(prefers-color-scheme: dark)');
  let chosen;
  const button = h('button', { type: 'button', className: 'plain', title: 'Dark or light (D)', onclick: () => toggle() });
  const apply = () => {
    const theme = chosen ?? (system.matches ? 'dark' : 'light');
    document.documentElement.dataset.theme = theme;
    button.textContent = theme === 'dark' ? 'Light' : 'Dark';
    onChange();
  };
  const toggle = () => {
    chosen = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    apply();
  };
  system.addEventListener('change', apply);
  apply();
  return { button, toggle };
}

/** Makes the logo of chronormal: a surface, and its normal. */
export function logo() {
  const space = 'http://www.w3.org/2000/svg', svg = document.createElementNS(space, 'svg');
  svg.setAttribute('viewBox', '0 0 20 20');
  svg.setAttribute('class', 'mark');
  for (const [d, colour] of [['M2 16 Q10 8 18 16', 'currentColor'], ['M10 12 L10 3 M6.8 6 L10 2.8 L13.2 6', 'var(--accent)']]) {
    const path = document.createElementNS(space, 'path');
    const line = { d, fill: 'none', stroke: colour, 'stroke-width': '2', 'stroke-linecap': 'round', 'stroke-linejoin': 'round' };
    for (const [name, value] of Object.entries(line)) path.setAttribute(name, value);
    svg.append(path);
  }
  return svg;
}
