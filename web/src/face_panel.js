// Shows the panel of one face: Figures 1 to 3 of the paper for this face at any t. If the program is available, the
// user can drag the corners of the face.
import { h, panel, table } from './dom.js';
import { degreesText } from './colors.js';
import { faceOf, faceOfNumber, wayOf } from './faces.js';
import { GRAPH, SPHERE, TRIANGLE, cornersInPicture, errorFigure, frameOf, inksOf, lengthFigure, liftedFrom, lookOf, nearOf, s, sphereFigure, stageOf, triangleFigure, turned,
  viewOf } from './figures.js';

/** The schemes that the panel shows. The command `chronormal report` stores figures of the same schemes. */
export const FIGURE_SCHEMES = ['linear', 'quadratic', 'cubic', 'slerp', 'decasteljau:4', 'quaternion:matrix', 'quaternion:optimal'];
const FIRST_SHOWN = ['linear', 'slerp', 'decasteljau:4', 'quaternion:matrix'];
// An arrow key moves a corner by this many pixels of the picture, and with Shift by five times as many.
const STEP = 6;
const TURN = 0.01; // radians by which a drag of one pixel turns the picture

const letterOf = (i) => String.fromCharCode(97 + (i % 26));

/**
 * Makes the panel of one face.
 * @param player from makePlayer()
 * @param {{outline(corners: number[]): void}} view gets the corners of the face that is shown
 * @param {((way: {from: number[][], to: number[][]}) => Promise<object>) | undefined} compute asks the program for the
 *   figures of a face that moves straight from one triangle to another. Without a program it is undefined, and the
 *   panel shows the figures that are stored in the report
 */
export function makeFacePanel(report, player, view, compute) {
  const stored = report.figures ?? [];
  let face, figure, way, stage, sight, sample = 0, shown = new Set(FIRST_SHOWN), construction = 'decasteljau:4', wanted, isAsking = false, isNear = false;

  const input = h('input', { type: 'number', min: 0, step: 1, 'aria-label': 'number of the face', onchange: () => choose(faceOfNumber(player.part, Number(input.value))) });
  const words = h('p', { className: 'note', role: 'status' }), body = h('div', { className: 'figures', hidden: true });
  const places = h('div', { className: 'acts' });
  const save = h('button', { type: 'button', className: 'plain save', onclick: download }, 'Save as SVG');
  const back = h('button', { type: 'button', className: 'plain', hidden: true, onclick: () => face && choose(face) }, 'Reset the corners');
  const slider = h('input', { type: 'range', min: 0, step: 1, 'aria-label': 't of the figures', oninput: () => go(Number(slider.value)) });
  const moment = h('output', { className: 'moment' });
  const build = h('select', { 'aria-label': 'construction on the sphere', onchange: () => ((construction = build.value), draw()) });
  const near = h('button', { type: 'button', className: 'plain', onclick: () => ((isNear = !isNear), draw()) });
  const layer = () => s('g'), [one, two, three, four] = [layer(), layer(), layer(), layer()];
  const sheet = (size, label, child, more = {}) => s('svg', { viewBox: `0 0 ${size.width} ${size.height}`, role: 'img', 'aria-label': label, ...more }, child);
  const triangle = sheet(TRIANGLE, 'Figure 1: the moving face, its exact normal and the normals of the schemes', one, { tabindex: 0, class: 'turns' });
  const sphere = sheet(SPHERE, 'Figure 3: the unit sphere with the paths of the normals', two, { tabindex: 0, class: 'turns' });
  const lengths = sheet(GRAPH, 'Figure 2: lengths of the normals before they are made unit vectors', three, { class: 'goes' });
  const errors = sheet(GRAPH, 'the angle to the exact normal', four, { class: 'goes' });
  const handles = layer(), rows = h('div', {}), frames = h('details', { className: 'frames' });
  triangle.append(handles);
  body.append(triangle, h('div', { className: 'timeline' }, slider, moment), sphere, h('label', { className: 'field' }, h('span', {}, 'sphere'), build, near), lengths, errors, rows, frames);
  const box = panel('One face and its normals over time', false,
    h('p', { className: 'acts' }, h('label', { className: 'number-field' }, 'face ', input), save, back), words, places, body);
  box.classList.add('face');
  save.disabled = true;

  box.addEventListener('toggle', () => {
    view.outline(box.open && face ? face.corners : []);
    if (box.open && !face) showStored(0);
    else draw();
  });

  const ofPart = () => stored.filter(({ place }) => report.worst[place].part === player.index);
  const storedOf = ({ triangle: first }) => ofPart().find((one) => one.triangle === first);
  function showStored(i) {
    const found = stored[i];
    if (!found) return;
    player.visit(report.worst[found.place]);
    choose(faceOf(player.part, found.triangle));
  }

  // Shows a face. The figure of the face comes from the program, or else from the report.
  function choose(found) {
    if (!found) {
      words.textContent = `There is no such face; the last face has the number ${(player.part.faces?.at(-1) ?? player.part.triangles.length / 3 - 1).toLocaleString('en')}. Type another number.`;
      return;
    }
    face = found;
    box.open = true;
    input.value = face.number;
    places.replaceChildren();
    view.outline(face.corners);
    back.hidden = true;
    if (compute) {
      way = wayOf(player, face);
      words.textContent = `Face ${face.number.toLocaleString('en')} moves ${way.words}. Drag its corners; drag beside them to turn the picture.`;
      ask(way, true);
      return;
    }
    const known = storedOf(face);
    if (!known) {
      figure = undefined;
      body.hidden = true;
      save.disabled = true;
      words.textContent = `This file has diagrams for some of the worst places only, and none for face ${face.number.toLocaleString('en')}. The page with the program inside shows any face.`;
      places.replaceChildren(...stored.map((one, i) => h('button', { type: 'button', className: 'plain', onclick: () => showStored(i) }, `face ${one.face.toLocaleString('en')}`)));
      return;
    }
    const place = report.worst[known.place], motion = report.parts[place.part].motions[place.motion];
    const t = motion.t ? motion.t[place.sample] : motion.seconds ? 1 : motion.at[place.sample];
    words.textContent = `Face ${face.number.toLocaleString('en')}, at ${place.label}. Drag beside it to turn the picture.`;
    way = { from: known.from, to: known.to, t };
    take(known, true);
  }

  // Asks the program for a figure. While the program is busy, only the latest request is kept, and sent when the
  // program is free.
  async function ask(next, isNew) {
    wanted = { next, isNew: isNew || wanted?.isNew };
    if (isAsking) return;
    isAsking = true;
    box.dataset.state = 'asking';
    while (wanted) {
      const now = wanted;
      wanted = undefined;
      try {
        take(await compute(now.next), now.isNew);
      } catch (error) {
        if (!wanted) words.textContent = error.message;
      }
    }
    isAsking = false;
    box.dataset.state = 'done';
  }

  function take(found, isNew) {
    figure = found;
    if (isNew) {
      sight = viewOf(figure);
      stage = stageOf(figure, sight);
      isNear = nearOf(figure).zoom > 1.5;
      slider.max = figure.t.length - 1;
      sample = Math.round(Math.min(Math.max(way.t, 0), 1) * (figure.t.length - 1));
      makeHandles();
    }
    const built = figure.schemes.filter(({ points, tangents }) => points || tangents);
    if (!built.some(({ scheme }) => scheme === construction)) construction = '';
    build.replaceChildren(...[['', 'paths alone'], ...built.map(({ scheme, points }) => [scheme, points ? `the arcs of ${scheme} at t` : `the frames of ${scheme}`])]
      .map(([value, name]) => h('option', { value, selected: value === construction }, name)));
    body.hidden = false;
    save.disabled = false;
    draw();
  }

  const isDark = () => document.documentElement.dataset.theme === 'dark';
  const look = () => ({ view: sight, stage, sample, shown, construction, inks: inksOf(isDark()), near: isNear ? nearOf(figure) : { zoom: 1 } });
  const drawings = () => [[one, triangleFigure], [two, sphereFigure], [three, lengthFigure], [four, errorFigure]];

  function draw() {
    if (!figure || !box.open) return;
    for (const [parent, make] of drawings()) parent.replaceChildren(make(figure, look()));
    near.textContent = isNear ? 'Whole sphere' : 'Paths near';
    slider.value = sample;
    moment.textContent = `t = ${+figure.t[sample].toFixed(3)}`;
    placeHandles();
    fillRows();
    fillFrames();
    box.dataset.face = face?.number;
    box.dataset.sample = sample;
  }

  function fillRows() {
    const dark = isDark();
    const tick = (scheme) => h('label', { className: 'tick' }, h('input', { type: 'checkbox', checked: shown.has(scheme), onchange: () => toggle(scheme) }),
      swatch(lookOf(scheme, dark)), scheme);
    const focused = rows.contains(document.activeElement) ? [...rows.querySelectorAll('input')].indexOf(document.activeElement) : -1;
    rows.replaceChildren(table('the schemes on this face', ['scheme', 'q ', 'at t ', 'length '], figure.schemes.map((one) => ({
      'data-scheme': one.scheme, 'data-sum': one.sum_degrees,
      cells: [tick(one.scheme), `${one.sum_degrees.toFixed(one.sum_degrees < 10 ? 2 : 1)}°`, degreesText(one.degrees[sample] ?? NaN), one.lengths ? one.lengths[sample].toFixed(3) : '1'],
    }))), h('p', { className: 'note' }, `q is the sum of the angles to the exact normal at ${figure.t.length} moments, as in the paper. The program computed all numbers.`));
    if (focused >= 0) rows.querySelectorAll('input')[focused]?.focus();
  }
  const swatch = ({ colour, dashes }) => s('svg', { viewBox: '0 0 30 8', class: 'swatch' }, s('line', { x1: 0, x2: 30, y1: 4, y2: 4, stroke: colour, 'stroke-width': 2.5, 'stroke-dasharray': dashes }));
  function toggle(scheme) {
    if (!shown.delete(scheme)) shown.add(scheme);
    draw();
  }

  // Shows the matrix M of the paper, by which quaternion:matrix chooses frames, and the frames at both ends. The
  // columns of a frame are the tangent, the binormal and the normal.
  function fillFrames() {
    const built = figure.schemes.find(({ scheme, tangents }) => scheme === construction && tangents), isOpen = frames.open;
    frames.hidden = !built;
    if (!built) return;
    const numbers = (name, lines) => [h('h3', {}, name), table(name, lines[0].map(() => ' '), lines.map((line) => ({ cells: line.map((x) => (Math.abs(x) < 5e-5 ? 0 : x).toFixed(4)) })))];
    const columns = (i) => {
      const { t, b, n } = frameOf(built, i);
      return [0, 1, 2].map((c) => [t[c], b[c], n[c]]);
    };
    frames.replaceChildren(h('summary', {}, `Frames of ${built.scheme} in numbers`), ...numbers('F₀: tangent, binormal, normal', columns(0)), ...numbers('F₁', columns(figure.t.length - 1)),
      ...(figure.matrix ? numbers('M, by which the frames of quaternion:matrix are chosen', figure.matrix) : []));
    frames.open = isOpen;
  }

  function go(to) {
    sample = Math.min(Math.max(to, 0), figure.t.length - 1);
    draw();
  }

  // Makes handles on the corners, which the user can drag with the mouse or move with keys.
  function makeHandles() {
    const count = figure.from.length;
    handles.replaceChildren(...(compute ? [...figure.from, ...figure.to].map((_, i) => {
      const name = `${letterOf(i % count)}${i < count ? '₀' : '₁'}`;
      const handle = s('g', { class: 'handle', tabindex: 0, role: 'button', 'aria-label': `corner ${name}: arrow keys move it` },
        s('circle', { r: 17, fill: 'transparent' }), s('circle', { r: 6 }), s('text', { x: 9, y: -8, 'font-size': 13, 'font-family': 'system-ui, sans-serif' }, name));
      let last;
      handle.addEventListener('pointerdown', (event) => {
        last = [event.clientX, event.clientY];
        handle.setPointerCapture(event.pointerId);
        handle.focus();
        event.preventDefault();
        event.stopPropagation();
      });
      handle.addEventListener('pointermove', (event) => {
        if (!last) return;
        const share = TRIANGLE.width / triangle.getBoundingClientRect().width;
        move(i, (event.clientX - last[0]) * share, (event.clientY - last[1]) * share);
        last = [event.clientX, event.clientY];
      });
      for (const end of ['pointerup', 'pointercancel']) handle.addEventListener(end, () => (last = undefined));
      handle.addEventListener('keydown', (event) => {
        const by = STEP * (event.shiftKey ? 5 : 1), way = { ArrowLeft: [-by, 0], ArrowRight: [by, 0], ArrowUp: [0, -by], ArrowDown: [0, by] }[event.key];
        if (!way) return;
        event.preventDefault();
        event.stopPropagation();
        move(i, ...way);
      });
      return handle;
    }) : []));
  }
  function placeHandles() {
    const inks = inksOf(isDark());
    cornersInPicture(way, stage, sight).forEach(([x, y], i) => {
      const handle = handles.children[i];
      if (!handle) return;
      const colour = i < way.from.length ? inks.start : inks.end;
      handle.setAttribute('transform', `translate(${x.toFixed(2)} ${y.toFixed(2)})`);
      handle.children[1].setAttribute('fill', colour);
      handle.children[2].setAttribute('fill', colour);
    });
  }
  function move(i, dx, dy) {
    const by = liftedFrom(dx, dy, stage, sight), count = way.from.length, ends = [way.from, way.to].map((corners) => corners.map((p) => [...p]));
    const p = ends[i < count ? 0 : 1][i % count];
    for (let c = 0; c < 3; ++c) p[c] += by[c];
    way = { ...way, from: ends[0], to: ends[1] };
    back.hidden = false;
    placeHandles();
    ask(way, false);
  }

  // If the user drags the picture of the triangle or of the sphere, both pictures turn.
  for (const picture of [triangle, sphere]) {
    let last;
    picture.addEventListener('pointerdown', (event) => {
      last = [event.clientX, event.clientY];
      picture.setPointerCapture(event.pointerId);
    });
    picture.addEventListener('pointermove', (event) => {
      if (!last || !figure) return;
      sight = turned(sight, TURN * (event.clientX - last[0]), TURN * (event.clientY - last[1]));
      last = [event.clientX, event.clientY];
      draw();
    });
    for (const end of ['pointerup', 'pointercancel']) picture.addEventListener(end, () => (last = undefined));
    picture.addEventListener('keydown', (event) => {
      const way = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
      if (!way || !figure) return;
      event.preventDefault();
      event.stopPropagation();
      sight = turned(sight, ...way);
      draw();
    });
  }
  for (const picture of [lengths, errors]) {
    picture.addEventListener('pointerdown', (event) => {
      const { left, width } = picture.getBoundingClientRect(), x = ((event.clientX - left) / width) * GRAPH.width;
      go(Math.round(((x - GRAPH.left) / (GRAPH.right - GRAPH.left)) * (figure.t.length - 1)));
    });
  }

  /** Returns the four pictures as one SVG file, as they are on the screen. */
  function svgOf() {
    const inks = inksOf(isDark()), gap = 12, width = 2 * TRIANGLE.width + 3 * gap, below = Math.max(TRIANGLE.height, SPHERE.height) + 2 * gap, height = below + GRAPH.height + gap + 24;
    const spots = [[gap, gap], [2 * gap + TRIANGLE.width, gap], [gap, below], [2 * gap + GRAPH.width, below]];
    const names = figure.schemes.filter(({ scheme }) => shown.has(scheme));
    const legend = [['exact', { colour: inks.ink }], ...names.map(({ scheme }) => [scheme, lookOf(scheme, inks.isDark)])].map(([name, { colour, dashes }], i) => {
      const x = gap + i * ((width - 2 * gap) / (names.length + 1));
      return [s('line', { x1: x, x2: x + 18, y1: height - 14, y2: height - 14, stroke: colour, 'stroke-width': 2, 'stroke-dasharray': dashes }),
        s('text', { x: x + 22, y: height - 10, fill: inks.ink, 'font-size': 10, 'font-family': 'system-ui, sans-serif' }, name)];
    }).flat();
    return s('svg', { xmlns: 'http://www.w3.org/2000/svg', viewBox: `0 0 ${width} ${height}`, width, height }, s('rect', { width, height, fill: inks.sheet }),
      drawings().map(([, make], i) => {
        const { width: across, height: down } = [TRIANGLE, SPHERE, GRAPH, GRAPH][i], [x, y] = spots[i];
        return s('svg', { x, y, width: across, height: down, viewBox: `0 0 ${across} ${down}` }, make(figure, look()));
      }), legend);
  }
  function download() {
    const address = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(svgOf())], { type: 'image/svg+xml' }));
    h('a', { href: address, download: `face-${face.number}.svg` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  }

  return {
    box,
    /** Shows the face to which a triangle of the current part belongs. */
    pick: (index) => choose(faceOf(player.part, index)),
    /** Hides the face. Called when the player shows another part, to which the face does not belong. */
    leave() {
      face = figure = undefined;
      body.hidden = true;
      save.disabled = true;
      words.textContent = compute ? 'Click a face of the mesh, or type its number.' : 'Click a face of the mesh, or type its number. This file has diagrams for some of the worst places only.';
      places.replaceChildren(...ofPart().map((one) => h('button', { type: 'button', className: 'plain', onclick: () => showStored(stored.indexOf(one)) }, `face ${one.face.toLocaleString('en')}`)));
    },
    restyle: draw,
    svg: () => new XMLSerializer().serializeToString(svgOf()),
    figure: () => figure,
    way: () => way,
    /** The settings with which the pictures are drawn: {view, stage, sample, near, ...}. */
    look,
  };
}
