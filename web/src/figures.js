// Draws Figures 1 to 3 of the paper for one face, as SVG that needs no style sheet. The program (`compare --face`) has
// computed every normal, length, angle, frame and point; this file only turns, projects and draws them.

const SPACE = 'http://www.w3.org/2000/svg';

/** Makes an element of SVG. Attributes that are undefined are left out. */
export function s(tag, attributes = {}, ...children) {
  const made = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) if (value !== undefined) made.setAttribute(name, value);
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, k, b) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
const unit = (a) => {
  const length = Math.hypot(...a);
  return length > 0 ? a.map((c) => c / length) : a;
};
const isZero = (a) => a[0] === 0 && a[1] === 0 && a[2] === 0;

/** Returns vector i of a flat array. */
export const vector = (flat, i) => [flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]];
const vectors = (flat) => Array.from({ length: flat.length / 3 }, (_, i) => vector(flat, i));

// Each scheme has its own colour, for a light and for a dark background, and its own dashes, so that schemes can be
// told apart without colours.
const LOOKS = {
  linear: ['#0b67b2', '#6cb8f5', ''], quadratic: ['#b3470a', '#ff9566', '7 3'], cubic: ['#18714a', '#6fd3a4', '2 3'], slerp: ['#6d28d9', '#b794f6', '9 3 2 3'],
  'decasteljau:4': ['#a21caf', '#f08ce8', '5 2'], 'quaternion:matrix': ['#0e7490', '#5fd4e6', '12 4'], 'quaternion:optimal': ['#be123c', '#ff7d95', '3 2'],
};

/** Returns the {colour, dashes} of a scheme. */
export const lookOf = (scheme, isDark) => {
  const [light, dark, dashes] = LOOKS[scheme] ?? ['#5b5b5b', '#b0b0b0', '1 2'];
  return { colour: isDark ? dark : light, dashes: dashes || undefined };
};

/** Returns the colours of the light or of the dark theme. */
export const inksOf = (isDark) => isDark
  ? { isDark, ink: '#eceae6', quiet: '#a3a099', line: '#43474c', sheet: '#1f2124', start: '#6cb8f5', end: '#ff9566', ball: '#2a2d31' }
  : { isDark, ink: '#1d1c1a', quiet: '#66625c', line: '#d0ccc4', sheet: '#ffffff', start: '#0b67b2', end: '#c2410c', ball: '#f1efec' };

/** Returns a view of a face, as three unit vectors, in which the normals lean away from the observer and move from left
 * to right. */
export function viewOf({ normals, from }) {
  const all = vectors(normals).filter((n) => !isZero(n)), first = all[0] ?? [0, 0, 1], last = all.at(-1) ?? first;
  const middle = unit(all.reduce((sum, n) => plus(sum, 1, n), [0, 0, 0])), up = isZero(middle) ? unit(cross(first, [0.6, 0.8, 0.02])) : middle;
  const across = (along) => plus(along, -dot(along, up), up);
  let right = across(plus(last, -1, first));
  if (Math.hypot(...right) < 1e-3) right = across(plus(from[1], -1, from[0]));
  if (Math.hypot(...right) < 1e-9) right = cross(up, Math.abs(up[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0]);
  return turned({ right: unit(right), up: cross(up, unit(right)), towards: up }, 0, 0.6);
}

/** Returns a view that is turned by angles in radians, to the right and down. */
export function turned({ right, up, towards }, across, down) {
  const turn = (a, b, angle) => [plus(a.map((c) => c * Math.cos(angle)), Math.sin(angle), b), plus(b.map((c) => c * Math.cos(angle)), -Math.sin(angle), a)];
  const [newRight, between] = turn(right, towards, -across), [newUp, newTowards] = turn(up, between, down);
  return { right: newRight, up: newUp, towards: newTowards };
}

const project = ({ right, up, towards, zoom, centre }, v) => {
  const [x, y, z] = [dot(v, right), dot(v, up), dot(v, towards)];
  return zoom ? [zoom * (x - centre[0]), zoom * (y - centre[1]), z] : [x, y, z];
};

const text = (x, y, words, fill, more = {}) => s('text', { x, y, fill, 'font-size': 12, 'font-family': 'system-ui, sans-serif', ...more }, words);
const number = (x) => Number(x.toFixed(2));
const place = (points) => points.map(([x, y]) => `${number(x)},${number(y)}`).join(' ');

function arrow([x0, y0], [x1, y1], stroke, width, more = {}) {
  const length = Math.hypot(x1 - x0, y1 - y0) || 1, ux = (x1 - x0) / length, uy = (y1 - y0) / length, head = Math.min(3 * width + 2, length / 2);
  const tip = [[x1, y1], [x1 - head * ux + 0.5 * head * uy, y1 - head * uy - 0.5 * head * ux], [x1 - head * ux - 0.5 * head * uy, y1 - head * uy + 0.5 * head * ux]];
  return s('g', more, s('line', { x1: number(x0), y1: number(y0), x2: number(x1 - 0.8 * head * ux), y2: number(y1 - 0.8 * head * uy), stroke, 'stroke-width': width }),
    s('polygon', { points: place(tip), fill: stroke }));
}

/** Returns {centres, size}, by which the face is placed in the picture. During the segment, the picture follows the
 * face from its centre at the start to its centre at the end. `size` is the length in space that fills the picture in
 * the first view. */
export function stageOf({ from, to }, view) {
  const centreOf = (corners) => corners.reduce((sum, p) => plus(sum, 1 / corners.length, p), [0, 0, 0]), centres = [centreOf(from), centreOf(to)];
  const { width, height, y, reach } = TRIANGLE, ways = [from, to].flatMap((corners, end) => corners.map((p) => plus(p, -1, centres[end])));
  const size = Math.max(...ways.map((way) => {
    const [right, up] = project(view, way);
    return Math.max((Math.abs(right) * reach) / (width / 2 - 24), (Math.abs(up) * reach) / (up > 0 ? y - 40 : height - y - 24), 0.5 * Math.hypot(...way));
  }));
  return { centres, size: size || 1 };
}

export const TRIANGLE = { width: 340, height: 300, x: 170, y: 170, reach: 130, normal: 110 };
export const SPHERE = { width: 340, height: 320, x: 170, y: 160, radius: 135 };
export const GRAPH = { width: 340, height: 130, left: 38, right: 332, top: 20, bottom: 110 };

/** Returns the places [x, y] of all corners in the picture: first the corners at t = 0, then the corners at t = 1. */
export function cornersInPicture({ from, to }, { centres, size }, view) {
  const { x, y, reach } = TRIANGLE;
  return [from, to].flatMap((corners, end) => corners.map((p) => {
    const [right, up] = project(view, plus(p, -1, centres[end]));
    return [x + (reach * right) / size, y - (reach * up) / size];
  }));
}

/** Converts a displacement (dx, dy) of the picture into a displacement in space, parallel to the picture. */
export const liftedFrom = (dx, dy, { size }, { right, up }) => plus(right.map((c) => (c * dx * size) / TRIANGLE.reach), (-dy * size) / TRIANGLE.reach, up);

/** Draws Figure 1: the face on its path, its exact normal at a sample, and the normals of the selected schemes. */
export function triangleFigure(figure, { view, stage, sample, shown, inks }) {
  const t = figure.t[sample], places = cornersInPicture(figure, stage, view), count = figure.from.length;
  const start = places.slice(0, count), end = places.slice(count), now = start.map(([x, y], i) => [x + t * (end[i][0] - x), y + t * (end[i][1] - y)]);
  const origin = [TRIANGLE.x, TRIANGLE.y], reach = TRIANGLE.normal;
  const normalTo = (n) => {
    const [right, up] = project(view, n);
    return [origin[0] + reach * right, origin[1] - reach * up];
  };
  const exact = vector(figure.normals, sample);
  return s('g', {},
    start.map((p, i) => s('line', { x1: number(p[0]), y1: number(p[1]), x2: number(end[i][0]), y2: number(end[i][1]), stroke: inks.quiet, 'stroke-dasharray': '3 3' })),
    s('polygon', { points: place(start), fill: 'none', stroke: inks.start, 'stroke-width': 1.6 }),
    s('polygon', { points: place(end), fill: 'none', stroke: inks.end, 'stroke-width': 1.6 }),
    s('polygon', { points: place(now), fill: inks.ink, 'fill-opacity': 0.12, stroke: inks.ink, 'stroke-width': 1.4 }),
    figure.schemes.filter(({ scheme }) => shown.has(scheme)).map(({ scheme, normals }) => {
      const n = vector(normals, sample);
      return isZero(n) ? null : arrow(origin, normalTo(n), lookOf(scheme, inks.isDark).colour, 1.4, { 'data-scheme': scheme });
    }),
    isZero(exact) ? null : arrow(origin, normalTo(exact), inks.ink, 2.4, { 'data-scheme': 'exact' }));
}

/** Returns {zoom, middle}. The zoom enlarges the sphere so that short paths can be told apart, and `middle` is the
 * direction at the middle of the enlarged picture. */
export function nearOf({ normals, schemes }) {
  const all = [normals, ...schemes.map((one) => one.normals)].flatMap(vectors).filter((n) => !isZero(n)), middle = unit(all.reduce((sum, n) => plus(sum, 1, n), [0, 0, 0]));
  const spread = Math.max(...all.map((n) => Math.hypot(...plus(n, -1, middle))), 0.01);
  return { zoom: Math.max(0.75 / spread, 1), middle };
}

// Returns lines on the sphere through points, as arcs of great circles. Lines in front of the sphere and lines behind
// the sphere are separate.
function spherePath(points, view) {
  const fine = [];
  points.forEach((p, i) => {
    if (isZero(p)) return fine.push(null);
    const before = points[i - 1];
    const steps = before && !isZero(before) ? Math.ceil(Math.acos(Math.min(Math.max(dot(before, p), -1), 1)) / 0.05) : 0;
    for (let k = 1; k < steps; ++k) fine.push(unit(plus(before.map((c) => c * (1 - k / steps)), k / steps, p)));
    return fine.push(p);
  });
  const parts = { front: '', back: '' };
  let side;
  for (let i = 1; i < fine.length; ++i) {
    if (!fine[i] || !fine[i - 1]) {
      side = undefined;
      continue;
    }
    const [a, b] = [fine[i - 1], fine[i]].map((p) => project(view, p)), now = a[2] + b[2] >= 0 ? 'front' : 'back', at = ([x, y]) => onSheet(x, y).map(number).join(' ');
    parts[now] += now === side ? `L${at(b)}` : `M${at(a)}L${at(b)}`;
    side = now;
  }
  return parts;
}
const onSheet = (x, y) => [SPHERE.x + SPHERE.radius * x, SPHERE.y - SPHERE.radius * y];
// Returns a view with the zoom of the sphere, so that directions are projected to the places where they are drawn.
const nearer = (view, { zoom, middle }) => (zoom === 1 ? view : { ...view, zoom, centre: project(view, middle) });

const drawn = (points, view, stroke, width, dashes, more = {}) => Object.entries(spherePath(points, view)).reverse().filter(([, d]) => d).map(([side, d]) =>
  s('path', { d, fill: 'none', stroke, 'stroke-width': width, 'stroke-dasharray': dashes, 'stroke-linejoin': 'round', opacity: side === 'back' ? 0.35 : undefined, ...more }));

function mark(p, view, fill, radius, more = {}) {
  const [x, y, z] = project(view, p), [cx, cy] = onSheet(x, y);
  return s('circle', { cx: number(cx), cy: number(cy), r: radius, fill, opacity: z < 0 ? 0.35 : undefined, ...more });
}

// Returns the points of all levels of de Casteljau's algorithm at a sample. The first level consists of the nodes.
function levelsOf({ nodes, points }, sample) {
  const levels = [vectors(nodes)], count = levels[0].length, all = (count * (count - 1)) / 2;
  for (let from = sample * all, size = count - 1; size > 0; from += size, --size) levels.push(Array.from({ length: size }, (_, i) => vector(points, from + i)));
  return levels;
}

/** Returns the frame of a quaternion scheme at a sample: tangent, binormal = normal x tangent, normal. */
export const frameOf = ({ tangents, normals }, sample) => {
  const t = vector(tangents, sample), n = vector(normals, sample);
  return { t, b: cross(n, t), n };
};

function frameAxes(scheme, sample, view, stroke, width, name) {
  return Object.entries(frameOf(scheme, sample)).map(([axis, v]) => {
    const at = (k) => onSheet(...project(view, v.map((c) => k * c))), to = at(1), [nx, ny] = at(1.1);
    return [arrow(at(0), to, stroke, width, { 'data-axis': `${axis}${name}` }), text(nx, ny + 4, `${axis}${name}`, stroke, { 'text-anchor': 'middle', 'font-size': 11 })];
  }).flat();
}

/** Draws Figure 3: the unit sphere with the paths of normals, and the construction of one scheme at a sample. */
export function sphereFigure(figure, { view: whole, near, sample, shown, construction, inks }) {
  const view = nearer(whole, near), [ballX, ballY] = project(view, [0, 0, 0]), [cx, cy] = onSheet(ballX, ballY);
  const exact = vectors(figure.normals), schemes = figure.schemes.filter(({ scheme }) => shown.has(scheme));
  const built = figure.schemes.find(({ scheme }) => scheme === construction), colour = built && lookOf(built.scheme, inks.isDark).colour;
  const arcs = built?.points ? levelsOf(built, sample) : [];
  const last = figure.t.length - 1;
  return s('g', {},
    s('circle', { cx: number(cx), cy: number(cy), r: number(SPHERE.radius * near.zoom), fill: inks.ball, stroke: inks.line }),
    arcs.slice(0, -1).map((level) => level.slice(1).map((p, i) => drawn([level[i], p], view, inks.quiet, 1.2, undefined, { 'data-arc': '' }))).flat(2),
    built?.tangents ? [frameAxes(built, 0, view, inks.start, 1, '₀'), frameAxes(built, last, view, inks.end, 1, '₁'), frameAxes(built, sample, view, colour, 2, '')].flat() : null,
    schemes.map(({ scheme, normals }) => {
      const look = lookOf(scheme, inks.isDark);
      return drawn(vectors(normals), view, look.colour, 1.7, look.dashes, { 'data-path': scheme });
    }).flat(),
    drawn(exact, view, inks.ink, 2.4, undefined, { 'data-path': 'exact' }),
    arcs.map((level, depth) => level.map((p) => mark(p, view, depth === 0 ? inks.ink : colour, depth === 0 ? 4 : 3, { 'data-level': depth }))).flat(),
    schemes.map(({ scheme, normals }) => {
      const n = vector(normals, sample);
      return isZero(n) ? null : mark(n, view, lookOf(scheme, inks.isDark).colour, 4.5, { 'data-mark': scheme, stroke: inks.sheet });
    }),
    isZero(exact[sample]) ? null : mark(exact[sample], view, inks.ink, 5, { 'data-mark': 'exact', stroke: inks.sheet }));
}

/** Draws a graph over t. Each line is {name, values, colour, width, dashes}. A null in `values` leaves a gap. */
export function graphFigure(figure, title, unitName, lines, sample, inks) {
  const { left, right, top, bottom } = GRAPH, most = Math.max(0, ...lines.flatMap(({ values }) => values.filter((v) => v !== null)));
  const scale = most > 0 ? 1.06 * most : 1, x = (t) => left + t * (right - left), y = (v) => bottom - (v / scale) * (bottom - top);
  const step = 10 ** Math.floor(Math.log10(scale)), ticks = [0, 1, 2, 3, 4, 5].map((k) => k * (scale / step > 5 ? 2 : scale / step > 2 ? 1 : 0.5) * step).filter((v) => v <= scale);
  const path = (values) => {
    let d = '', pen = 'M';
    values.forEach((v, i) => {
      if (v === null) return (pen = 'M');
      d += `${pen}${number(x(figure.t[i]))} ${number(y(v))}`;
      return (pen = 'L');
    });
    return d;
  };
  return s('g', {}, text(left, 12, title, inks.quiet),
    ticks.map((v) => [s('line', { x1: left, x2: right, y1: number(y(v)), y2: number(y(v)), stroke: inks.line }), text(left - 5, number(y(v)) + 4, `${+v.toPrecision(3)}${unitName}`, inks.quiet, { 'text-anchor': 'end', 'font-size': 11 })]).flat(),
    [0, 0.5, 1].map((t) => text(x(t), bottom + 15, t === 0.5 ? 't' : String(t), inks.quiet, { 'text-anchor': 'middle', 'font-size': 11 })),
    lines.map(({ name, values, colour, width, dashes }) => s('path', { d: path(values), fill: 'none', stroke: colour, 'stroke-width': width, 'stroke-dasharray': dashes, 'data-line': name })),
    s('line', { x1: number(x(figure.t[sample])), x2: number(x(figure.t[sample])), y1: top, y2: bottom, stroke: inks.quiet }));
}

/** Draws Figure 2: the lengths of interpolated normals before they are made unit vectors. The length of the exact
 * normal, which is twice the area, is drawn as a share of its maximum. For schemes that compute the exact normal, the
 * length is drawn as a share of the same maximum. */
export function lengthFigure(figure, { sample, shown, inks }) {
  const most = Math.max(...figure.lengths) || 1;
  const lines = figure.schemes.filter(({ scheme, lengths }) => shown.has(scheme) && lengths).map(({ scheme, lengths }) => {
    const { colour, dashes } = lookOf(scheme, inks.isDark), unit = scheme === 'polynomial' || scheme === 'recompute' ? most : 1;
    return { name: scheme, values: lengths.map((l) => l / unit), colour, dashes, width: 1.7 };
  });
  lines.unshift({ name: 'exact', values: figure.lengths.map((l) => l / most), colour: inks.ink, width: 2.2 });
  return graphFigure(figure, 'length before normalisation (thick: exact, scaled)', '', lines, sample, inks);
}

/** Draws the angle, in degrees, between the normals of each scheme and the exact normals. */
export function errorFigure(figure, { sample, shown, inks }) {
  const lines = figure.schemes.filter(({ scheme }) => shown.has(scheme)).map(({ scheme, degrees }) => {
    const { colour, dashes } = lookOf(scheme, inks.isDark);
    return { name: scheme, values: degrees, colour, dashes, width: 1.7 };
  });
  return graphFigure(figure, 'angle to the exact normal', '°', lines, sample, inks);
}
