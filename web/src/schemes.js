// Interpolates the unit normals of elements between two keyframes (docs/theory.md, section 4). Each scheme gets exact
// unit normals at equidistant t, and writes unit normals. Arrays have three numbers for each element.

// Returns a scheme that computes the vector of each element by itself. rule(t, exact) returns a function (units, at,
// result), which writes the vector that begins at index `at` of `result`.
const each = (rule) => (units, t, result, exact) => {
  const make = rule(t, exact);
  for (let at = 0; at < result.length; at += 3) {
    make(units, at, result);
    const length = Math.hypot(result[at], result[at + 1], result[at + 2]);
    for (let c = 0; c < 3; ++c) result[at + c] = length > 0 ? result[at + c] / length : 0;
  }
};

// Returns the scheme of section 4.3 of docs/theory.md: Lagrange's polynomial through intervals + 1 exact unit normals.
// The weights of the polynomial depend only on t.
function lagrange(intervals) {
  const rule = (t) => {
    const weights = Array.from({ length: intervals + 1 }, (_, i) => {
      let weight = 1;
      for (let j = 0; j <= intervals; ++j) if (j !== i) weight *= (intervals * t - j) / (i - j);
      return weight;
    });
    return (units, at, result) => {
      for (let c = 0; c < 3; ++c) {
        let value = 0;
        for (let i = 0; i <= intervals; ++i) value += weights[i] * units[i][at + c];
        result[at + c] = value;
      }
    };
  };
  return { intervals, evaluate: each(rule) };
}

// Interpolates along the great circle (section 4.4 of docs/theory.md). If both ends are the same vector, the result is
// this vector. If the ends are opposite, many great circles lead from one to the other, and the result has no meaning.
function alongArc(a, i, b, j, t, result, at) {
  const d = a[i] * b[j] + a[i + 1] * b[j + 1] + a[i + 2] * b[j + 2];
  const x = a[i + 1] * b[j + 2] - a[i + 2] * b[j + 1], y = a[i + 2] * b[j] - a[i] * b[j + 2], z = a[i] * b[j + 1] - a[i + 1] * b[j];
  const sine = Math.hypot(x, y, z), angle = Math.atan2(sine, d);
  if (sine < 1e-12 && d > 0) {
    for (let c = 0; c < 3; ++c) result[at + c] = a[i + c];
    return;
  }
  const [p, q] = [Math.sin((1 - t) * angle) / sine, Math.sin(t * angle) / sine];
  for (let c = 0; c < 3; ++c) result[at + c] = p * a[i + c] + q * b[j + c];
}

const slerp = { intervals: 1, evaluate: each((t) => (units, at, result) => alongArc(units[0], at, units[1], at, t, result, at)) };

// Returns the scheme of de Casteljau's algorithm over `points` exact normals, with arcs of great circles in place of
// lines.
function deCasteljau(points) {
  const work = new Float64Array(3 * points);
  const rule = (t) => (units, at, result) => {
    for (let i = 0; i < points; ++i) for (let c = 0; c < 3; ++c) work[3 * i + c] = units[i][at + c];
    for (let count = points - 1; count > 0; --count) for (let i = 0; i < count; ++i) alongArc(work, 3 * i, work, 3 * i + 3, t, work, 3 * i);
    for (let c = 0; c < 3; ++c) result[at + c] = work[c];
  };
  return { intervals: points - 1, evaluate: each(rule) };
}

// Returns the scheme of section 4.7 of docs/theory.md: the circle through the exact normals at t = 0, 1/2 and 1. If
// isTimed is true, the result at t = 1/2 is the middle normal.
function circle(isTimed) {
  const rule = (t) => (units, at, result) => {
    const [a, m, b] = units, ax = a[at], ay = a[at + 1], az = a[at + 2];
    const ex = m[at] - ax, ey = m[at + 1] - ay, ez = m[at + 2] - az, fx = b[at] - ax, fy = b[at + 1] - ay, fz = b[at + 2] - az;
    let x = ey * fz - ez * fy, y = ez * fx - ex * fz, z = ex * fy - ey * fx;
    const length = Math.hypot(x, y, z), e = Math.hypot(ex, ey, ez), f = Math.hypot(fx, fy, fz);
    if (length <= 1e-12 * Math.max(e, f) || e === 0 || f === 0 || ax * m[at] + ay * m[at + 1] + az * m[at + 2] < -1 + 1e-12) {
      return alongArc(a, at, b, at, t, result, at);
    }
    (x /= length), (y /= length), (z /= length);
    const along = x * ax + y * ay + z * az, wx = along * x, wy = along * y, wz = along * z;
    const px = ax - wx, py = ay - wy, pz = az - wz, qx = y * az - z * ay, qy = z * ax - x * az, qz = x * ay - y * ax;
    const angleOf = (u) => {
      const angle = Math.atan2(qx * u[at] + qy * u[at + 1] + qz * u[at + 2], px * u[at] + py * u[at + 1] + pz * u[at + 2]);
      return angle > 0 ? angle : angle + 2 * Math.PI;
    };
    const whole = angleOf(b), r = angleOf(m) / whole, s = isTimed ? (r * t) / ((1 - r) * (1 - t) + r * t) : t;
    const cosine = Math.cos(s * whole), sine = Math.sin(s * whole);
    result[at] = wx + cosine * px + sine * qx;
    result[at + 1] = wy + cosine * py + sine * qy;
    result[at + 2] = wz + cosine * pz + sine * qz;
  };
  return { intervals: 2, evaluate: each(rule) };
}

// The scheme of section 4.2 of docs/theory.md: the polynomial n(t), normalised.
const polynomial = {
  intervals: 1,
  evaluate: each((t, exact) => (units, at, result) => {
    for (let c = 0; c < 3; ++c) result[at + c] = exact[at + c];
  }),
};

/** The schemes that a page can show, by their names in `compare`. */
export const SCHEMES = {
  linear: { ...lagrange(1), title: 'linear: between the normals of the keyframes, then normalised' },
  slerp: { ...slerp, title: 'slerp: along the great circle' },
  quadratic: { ...lagrange(2), title: 'quadratic: a parabola through 3 exact normals' },
  cubic: { ...lagrange(3), title: 'cubic: a cubic curve through 4 exact normals' },
  'decasteljau:4': { ...deCasteljau(4), title: 'decasteljau:4: a spherical curve of 4 exact normals' },
  circle: { ...circle(false), title: 'circle: the circle through 3 exact normals' },
  'circle:timed': { ...circle(true), title: 'circle:timed: the circle through 3 exact normals, with the middle normal at t = 1/2' },
  polynomial: { ...polynomial, title: 'polynomial: the exact normals, from three control normals' },
};

export const schemeOf = (name) => SCHEMES[name];
