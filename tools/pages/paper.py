"""Repeats the measurements of the paper on the built-in morphs with the Python package and the program, for
docs/paper.md.

The normals of the schemes come from the library. This file computes everything that they are compared with: exact
normals from positions, in double, and the polynomials, circles and matrices of the paper.
"""

import io
import re
import subprocess
from concurrent.futures import ThreadPoolExecutor

import chronormal as cn
import numpy as np
from page import BLACK, BLUE, GREEN, GREY, ORANGE, PROGRAM, PURPLE, RED, SKY, Page, grouped, percent, plt, ratio, scientific

MORPHS = ["cloth", "bend", "twist", "eversion"]  # from mild to dramatic; the columns of every table have this order
COLOURS = dict(zip([*MORPHS, "soup"], [BLUE, GREEN, ORANGE, RED, PURPLE]))
# Table 1 of the paper: the sums of angles in degrees for the morphs, which have 15,300, 44,700, 35,180 and 21,040
# faces.
PAPER = {"linear": ("Linear", [18916, 55756, 44078, 20061]), "quadratic": ("Quadratic", [4820, 15792, 9681, 5425]),
         "cubic": ("Cubic", [1906, 6444, 3640, 1572]), "polynomial": ("t-variant cross product", [0, 0, 0, 0]),
         "slerp": ("Vector SLERP", [19427, 57999, 44972, 20861]),
         "decasteljau:4": ("Spherical deCasteljau", [7039, 21772, 16068, 7647]),
         "quaternion:matrix": ("Quaternion SLERP", [17766, 53492, 42831, 19202])}
OURS = ["quaternion:edge", "quaternion:polar", "quaternion:optimal", "circle", "circle:timed", "linear:scaled", "rational"]
MATRIX, OPTIMAL, TIMED = "quaternion:matrix", "quaternion:optimal", "circle:timed"


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def dot(a, b):
    return np.sum(a * b, axis=-1)


def degrees_between(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), dot(a, b)))


class Part:
    """Some faces of a motion, as a file for the program and with their exact normals."""

    def __init__(self, positions, faces):
        positions, faces = np.asarray(positions, np.float32), np.asarray(faces)
        file = io.BytesIO()
        np.savez(file, positions=positions, faces=faces.astype(np.int32), times=np.arange(len(positions), dtype=float))
        self.bytes, self.segments, self.count = file.getvalue(), len(positions) - 1, len(faces)
        self.corners = positions.astype(float)[:, faces]  # (keyframes, faces, 3, 3)

    def normals(self, t, segment=0):
        """Returns n(t) of every face, which is the cross product of two edges."""
        a, b, c = np.moveaxis((1 - t) * self.corners[segment] + t * self.corners[segment + 1], 1, 0)
        return np.cross(b - a, c - a)

    def exact(self, t, segment=0):
        return unit(self.normals(t, segment))

    def sums(self, scheme, samples=21, combine=np.sum):
        """Returns the angles between a scheme and exact normals, in degrees, combined over the samples of each segment
        and face."""
        errors = cn.errors(self.bytes, scheme=scheme, samples=samples, elements="faces")[0].errors
        return combine(np.nan_to_num(errors.reshape(self.segments, samples, -1).astype(float)), axis=1).ravel()

    def shown(self, scheme, times):
        """Returns the normals of a scheme at these times of a motion whose keyframes are a second apart: (times,
        faces, 3)."""
        command = [PROGRAM, "sample", "-", "--scheme", scheme, "--elements", "faces", "-o", "-", "--quiet", "--times",
                   ",".join(map(repr, map(float, times)))]
        return np.load(io.BytesIO(subprocess.run(command, input=self.bytes, check=True, capture_output=True).stdout)).astype(float)

    def face(self, index):
        return Part(self.corners[:2, index], [[0, 1, 2]])


def random_order(faces, count):
    """Returns `count` random faces, chosen by the 64-bit Mersenne twister with the seed 7, in ascending order."""
    mask, state, order = (1 << 64) - 1, [7], list(range(faces))
    for i in range(1, 312):
        state.append((6364136223846793005 * (state[-1] ^ state[-1] >> 62) + i) & mask)
    for i in range(count):
        if i % 312 == 0:
            for k in range(312):
                x = state[k] & 0xFFFFFFFF80000000 | state[(k + 1) % 312] & 0x7FFFFFFF
                state[k] = state[(k + 156) % 312] ^ x >> 1 ^ (0xB5026F5AA96619E9 if x & 1 else 0)
        x = state[i % 312]
        x ^= x >> 29 & 0x5555555555555555
        x ^= x << 17 & 0x71D67FFFEDA60000
        x ^= x << 37 & 0xFFF7EEE000000000
        other = i + (x ^ x >> 43) % (faces - i)
        order[i], order[other] = order[other], order[i]
    return sorted(order[:count])


def some(name, pairs):
    """Returns random faces of a morph as a Part: as many faces as give about `pairs` pairs of a face and a segment. If
    the morph has fewer pairs, returns all its faces."""
    motion = cn.read(sample=name)
    positions, faces = np.asarray(motion.positions), np.asarray(motion.faces)
    count = pairs // (len(positions) - 1)
    return Part(positions, faces if count >= len(faces) else faces[random_order(len(faces), count)])


def in_parallel(work, items):
    with ThreadPoolExecutor() as pool:
        return list(pool.map(work, items))


def lagrange(part, degree, t, segment=0):
    """Returns the polynomial through exact unit normals at degree + 1 nodes, before it is normalised."""
    nodes, value = np.arange(degree + 1), 0
    for k in nodes:
        others = nodes[nodes != k]
        value = value + np.prod((t * degree - others) / (k - others)) * part.exact(k / degree, segment)
    return value


# The next functions make section 1 of docs/paper.md.

def measure_table1(page):
    measured = {}
    for name in MORPHS:
        found = cn.compare(sample=name, schemes=[*PAPER, *OURS])["schemes"]
        for row in found:
            measured.setdefault(row["scheme"], []).append(row)
    theirs = {scheme: np.array(sums) / PAPER["linear"][1] for scheme, (_, sums) in PAPER.items()}
    ours = {scheme: np.array([row["relative_to_linear"] for row in rows]) for scheme, rows in measured.items()}
    page.table("ratios", ["sum relative to linear", "paper 15,300", "44,700", "35,180", "21,040", *MORPHS],
               [[f"{PAPER[s][0]} (`{s}`)", *map(ratio, theirs[s]), *map(ratio, ours[s])] for s in PAPER]
               + [[f"ours: `{s}`", "", "", "", "", *map(ratio, ours[s])] for s in OURS])
    draw_ratios(page, theirs, ours)

    ranked = [scheme for scheme in PAPER if scheme != "polynomial"]
    orders = [sorted(ranked, key=lambda s: theirs[s][m]) for m in range(4)]
    page.requires(all(order == orders[0] for order in orders), "the paper has one order on all morphs")
    page.says("best first, is " + ", ".join(f"`{s}`" for s in orders[0][:-1]) + f" and `{orders[0][-1]}`")
    exact = measured["polynomial"]
    mean, worst = (max(row[key] for row in exact) for key in ("mean_degrees", "max_degrees"))
    slerp, casteljau, matrix, cubic = (ours[s] for s in ("slerp", "decasteljau:4", MATRIX, "cubic"))
    page.says(f"{scientific(mean, 1)} degrees on average and {scientific(worst, 1)} at worst",
              f"{ratio(casteljau[0])}, {ratio(casteljau[1])} and {ratio(casteljau[2])} on our first three morphs",
              "{} to {} in the paper, but {}, {} and {}".format(*map(ratio, [theirs["cubic"].min(), theirs["cubic"].max(), *cubic[:3]])),
              f"`quaternion:matrix` gains {percent(1 - matrix[1])} and {percent(1 - matrix[2])}",
              f"The paper gains {100 * (1 - theirs[MATRIX].max()):.1f} % to {percent(1 - theirs[MATRIX].min(), 1)}")
    page.says(f"It is {1 / theirs['quadratic'].max():.1f} to {1 / theirs['quadratic'].min():.1f} times better there, and"
              + f" {1 / ours['quadratic'][0]:.1f}, {1 / ours['quadratic'][1]:.1f} and {1 / ours['quadratic'][2]:.1f} times",
              f"There it gains {percent(1 - theirs[MATRIX].mean(), 1)} on average, and here {percent(1 - matrix[0], 1)}, {percent(1 - matrix[1])}, "
              f"{percent(1 - matrix[2])} and {percent(1 - matrix[3])}")
    page.requires((slerp > 1).all() and ours["quadratic"][3] > slerp[3] and matrix[0] > slerp[0], "slerp is not always the worst")
    measure_parts(page, ours)
    page.says(f"`quadratic` is worse than linear (ratio {ratio(ours['quadratic'][3])})", f"`cubic` is better (ratio {ratio(cubic[3])})")


def draw_ratios(page, theirs, ours):
    rows = ["slerp", "linear", MATRIX, OPTIMAL, "circle", "decasteljau:4", "quadratic", TIMED, "cubic"]
    figure, axes = plt.subplots(figsize=(8.6, 4.2), layout="constrained")
    for y, scheme in enumerate(rows):
        if scheme in theirs:
            axes.plot(theirs[scheme], [y + 0.22] * 4, "o", color=BLACK, fillstyle="none", ms=5, label="paper, four morphs" if y == 0 else None)
        for m, (name, mark) in enumerate(zip(MORPHS, "os^D")):
            axes.plot(ours[scheme][m], y + 0.06 - 0.12 * m, mark, color=COLOURS[name], ms=5, label=f"ours: {name}" if y == 0 else None)
    axes.set(xscale="log", xlim=(0.02, 1.6), xlabel="sum of angles relative to linear", yticks=range(len(rows)), yticklabels=rows,
             xticks=[0.02, 0.05, 0.1, 0.2, 0.5, 1], xticklabels=["0.02", "0.05", "0.1", "0.2", "0.5", "1"])
    axes.minorticks_off()
    axes.grid(color="0.9")
    axes.legend(loc="lower left")
    page.picture(figure, "table1.svg")


def measure_parts(page, ours):
    """Measures how much of the error of slerp comes from a wrong path, and how much from a wrong speed along the
    path."""
    rows = []
    for name in MORPHS:
        part, path, speed = some(name, 4000), [], []
        for s in range(part.segments):
            u0, u1 = part.exact(0, s), part.exact(1, s)
            turns = np.linalg.norm(np.cross(u0, u1), axis=1) >= 1e-6
            u0, u1 = u0[turns], u1[turns]
            pole, whole = unit(np.cross(u0, u1)), np.radians(degrees_between(u0, u1))
            ahead = np.cross(pole, u0)
            for t in np.linspace(0, 1, 21):
                u = part.exact(t, s)[turns]
                path.append(np.degrees(np.abs(np.arcsin(np.clip(dot(u, pole), -1, 1)))))
                off = np.arctan2(dot(u, ahead), dot(u, u0)) - t * whole
                speed.append(np.degrees(np.abs((off + np.pi) % (2 * np.pi) - np.pi)))
        rows.append([name, grouped(np.concatenate(path).mean(), 2), grouped(np.concatenate(speed).mean(), 2)])
    page.table("slerp_parts", ["error of slerp, degrees", *MORPHS],
               [[title, *(row[k] for row in rows)] for k, title in ((1, "distance from its path"), (2, "along the path"))])
    page.says(f"({rows[0][1]} degrees away on average)", f"({rows[0][2]} degrees)",
              f"`linear:scaled`, which only scales one end, has the ratio {ratio(ours['linear:scaled'][0])}",
              f"`quaternion:matrix` is worse than linear (ratio {ratio(ours[MATRIX][0])})", f"frames gain only {percent(1 - ours[OPTIMAL][0], 1)}")


# The next functions make section 2 of docs/paper.md.

def measure_table2(page):
    schemes = ["recompute", "linear", "quadratic", "cubic", "polynomial", "rational", "slerp", "decasteljau:4", MATRIX, TIMED]
    count = lambda row: "/".join(str(row["operations"][k]) for k in ("add", "multiply", "divide", "sqrt", "trigonometric"))  # noqa: E731
    found, played = ({row["scheme"]: row for row in cn.compare(sample="bend", schemes=schemes, samples=2, access=access)["schemes"]}
                     for access in ("random", "sequential"))
    page.table("operations", ["scheme", "random access", "sequential access", "bytes"],
               [[f"`{s}`", count(found[s]), count(played[s]) if played[s]["access"] == "sequential" else "-", f"{found[s]['bytes']:.0f}"] for s in schemes])
    take = lambda of, s: [of[s]["operations"][k] for k in ("add", "multiply")]  # noqa: E731
    # A normalisation takes two additions and six multiplications.
    page.requires(take(found, "polynomial") == [6 + 2, 9 + 6] and take(found, "linear") == [3 + 2, 6 + 6],
                  "polynomial and linear take 6, 9 and 3, 6 operations")
    page.requires(found["decasteljau:4"]["operations"]["trigonometric"] == 6 + 6, "de Casteljau takes 6 sines and 6 arc tangents")


# The next functions make section 3 of docs/paper.md.

PLAYED = ["polynomial", "linear", "quadratic", "cubic", "slerp", OPTIMAL, "circle"]


def drift(part, scheme, steps, anchor):
    """Plays a scheme step by step. Returns the largest angle to the normals by random access, in radians."""
    command = [PROGRAM, "sample", "-", "--scheme", scheme, "--elements", "faces", "-o", "-", "--step", f"{steps}:{anchor}"]
    run = subprocess.run(command, input=part.bytes, check=True, capture_output=True)
    return np.radians(float(re.search(rb"by up to (\S+) degrees", run.stderr)[1]))


def measure_drift(page):
    parts = {name: some(name, 400) for name in MORPHS}
    steps = [100, 1000, 10000]
    jobs = [(name, scheme, n, anchor) for name in MORPHS for scheme in PLAYED for n in steps for anchor in (0, 64)]
    found = dict(zip(jobs, in_parallel(lambda job: drift(parts[job[0]], *job[1:]), jobs)))
    angle = lambda name, scheme, n, anchor: scientific(found[name, scheme, n, anchor], 1)  # noqa: E731
    page.table("drifts", ["largest drift, radians", "100 steps", "10,000", "10,000, renewed"],
               [[f"`{s}`", *(angle("twist", s, n, a) for n, a in ((100, 0), (10000, 0), (10000, 64)))] for s in PLAYED])
    worst = {name: max(found[name, s, n, 64] for s in PLAYED for n in steps) for name in MORPHS}
    page.requires(max(worst.values()) < 5e-6, "anchored drift stays below 5e-6 rad, as schemes/scheme.h says")
    page.says(f"by more than {scientific(max(worst.values()), 1)} radians")


# The next functions make section 4 of docs/paper.md.

def zeros_of_squared_length(part):
    """Finds, for each face, the four complex values of t at which n(t).n(t) = 0. Returns the value that limits the
    convergence of interpolation (Runge 1901), and its margin()."""
    c0, m, n1 = part.normals(0), 2 * part.normals(0.5) - (part.normals(0) + part.normals(1)) / 2, part.normals(1)
    c1, c2 = 2 * (m - c0), c0 - 2 * m + n1
    quartic = np.stack([dot(c2, c2), 2 * dot(c1, c2), dot(c1, c1) + 2 * dot(c0, c2), 2 * dot(c0, c1), dot(c0, c0)], axis=1)
    zeros = np.full((len(quartic), 4), 1e9 + 0j)
    for zero, coefficients in zip(zeros, quartic):
        roots = np.roots(coefficients)
        zero[:len(roots)] = roots
    margins = margin(zeros)
    nearest = margins.argmin(1)[:, None]
    return np.take_along_axis(zeros, nearest, 1)[:, 0], np.take_along_axis(margins, nearest, 1)[:, 0]


def margin(z):
    """Returns the rate of convergence that a singular point z allows. The error of interpolation at K + 1 equidistant
    nodes of [0, 1] falls like exp(-K g), where g is the smallest rate of all singular points."""
    z_log_z = lambda w: np.where(w == 0, 0, w * np.log(np.where(w == 0, 1, w)))  # noqa: E731
    return (z_log_z(z) - z_log_z(z - 1)).real


def worst_of_twist():
    """Returns the face of the morph twist with the largest error of linear interpolation."""
    face = cn.compare(sample="twist", schemes=["linear"])["schemes"][0]["max_at"]["element"]
    motion = cn.read(sample="twist")
    return face, Part(motion.positions, np.asarray(motion.faces)[[face]])


def measure_figure2(page):
    (face, part), t = worst_of_twist(), np.linspace(0, 1, 201)
    exact = np.array([part.exact(x)[0] for x in t])
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    lengths = {}
    for degree, name, colour in ((1, "linear", SKY), (2, "quadratic", BLUE), (3, "cubic", PURPLE), (8, "degree 8", RED)):
        vectors = np.array([lagrange(part, degree, x)[0] for x in t])
        lengths[degree] = np.linalg.norm(vectors, axis=1)
        left.plot(t, lengths[degree], color=colour)
        right.plot(t, degrees_between(vectors, exact), color=colour, label=name)
    left.set(title="length before it is normalised", xlabel="t", ylabel="length", xlim=(0, 1), ylim=(0.5, 1.2))
    right.set(title="error of the direction", xlabel="t", ylabel="degrees", xlim=(0, 1), ylim=(0, 45))
    right.legend()
    page.picture(figure, "figure2_length.svg")
    page.says(f"face {grouped(face)} of twist", "this length falls to {:.3f} (linear), {:.3f} (quadratic) and {:.3f} (cubic)".format(
        *(lengths[k].min() for k in (1, 2, 3))))

    parts = {name: some(name, 2000) for name in [*MORPHS, "soup"]}
    jobs = [(name, degree) for name in parts for degree in range(1, 17)]
    found = dict(zip(jobs, in_parallel(lambda job: parts[job[0]].sums(f"lagrange:{job[1]}", 98).mean() / 98, jobs)))
    angle = lambda v: scientific(v, 1) if v < 0.01 else f"{v:.2f}"  # noqa: E731
    page.table("by_degree", ["K", *parts], [[k, *(angle(found[name, k]) for name in parts)] for k in (2, 3, 4, 8, 12, 16)])
    least = min(range(1, 17), key=lambda k: found["cloth", k])
    at, margins = zeros_of_squared_length(parts["soup"])
    inside = {name: np.mean(np.concatenate([zeros_of_squared_length(segment)[1] for segment in segments_of(parts[name])]) < 0) for name in MORPHS}
    page.requires(inside["cloth"] == inside["bend"] == inside["twist"] == 0, "no zero is inside on mild morphs")
    grows = largest_distance(parts["soup"], 24) > largest_distance(parts["soup"], 12)
    clear, right = np.abs(12 * margins) > np.log(2), (margins < 0) == grows
    page.says(f"falls to {scientific(found['cloth', least], 1)} degrees at K = {least} and is back at {angle(found['cloth', 16])} at K = 16",
              f"{percent((margins < 0).mean())} have a zero in the lens",
              f"on eversion {percent(inside['eversion'])} have",
              f"on {percent((margins < 0).mean())} of the faces of soup, on {percent(inside['eversion'])} of those of eversion",
              "for {} of the faces, and for {} of the {} faces".format(percent(right.mean(), 1), percent(right[clear].mean(), 1), grouped(clear.sum())))
    draw_lens(page, at, grows)
    draw_oscillation(page, parts["soup"], at, found)


def segments_of(part):
    for s in range(part.segments):
        yield Part(part.corners[s:s + 2].reshape(2, -1, 3), np.arange(3 * part.count).reshape(-1, 3))


def largest_distance(part, degree):
    """Returns the largest distance of the interpolating polynomial from the unit normal, before the polynomial is
    normalised. Runge's theory is about this distance."""
    times = np.arange(1, 197) / 197
    return np.max([np.linalg.norm(lagrange(part, degree, t) - part.exact(t), axis=1) for t in times], axis=0)


def draw_lens(page, at, grows):
    figure, axes = plt.subplots(figsize=(8.6, 3.6), layout="constrained")
    axes.plot(at[~grows].real, np.abs(at[~grows].imag), "o", color=BLUE, ms=2, label="error shrinks from K = 12 to 24")
    axes.plot(at[grows].real, np.abs(at[grows].imag), "^", color=RED, ms=2.5, label="error grows")
    x = np.linspace(0, 1, 201)[1:-1]
    low, high = np.zeros_like(x), np.ones_like(x)
    for _ in range(50):
        middle = (low + high) / 2
        inside = margin(x + 1j * middle) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    axes.plot([0, *x, 1], [0, *low, 0], color=BLACK, label="Runge's lens")
    axes.set(xlabel="real part of t", ylabel="imaginary part of t", xlim=(-0.15, 1.15), ylim=(0, 0.6))
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    figure.set_dpi(140)
    page.picture(figure, "figure2_zeros.png")


def draw_oscillation(page, soup, at, found):
    """Draws the errors of the face whose zero of n(t).n(t) is nearest to 0.5 + 0.1i, and the average error of all
    morphs for each degree."""
    shown = np.abs(at.real + 1j * np.abs(at.imag) - (0.5 + 0.1j)).argmin()
    face, t = soup.face(shown), np.linspace(0, 1, 401)
    exact = np.array([face.exact(x)[0] for x in t])
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    errors = {}
    for degree, colour in ((4, BLUE), (8, GREEN), (16, RED)):
        errors[degree] = degrees_between(np.array([lagrange(face, degree, x)[0] for x in t]), exact)
        left.plot(t, errors[degree], color=colour, label=f"K = {degree}")
    left.set(title="one face of soup: error over t", xlabel="t", ylabel="degrees", xlim=(0, 1), ylim=(0, 100))
    left.legend(loc="upper center")
    for name, mark in zip([*MORPHS, "soup"], "os^Dv"):
        right.plot(range(1, 17), [found[name, k] for k in range(1, 17)], mark + "-", color=COLOURS[name], ms=4, label=name)
    right.set(title="all morphs: average error", xlabel="degree K", ylabel="degrees", yscale="log", xticks=range(2, 17, 2))
    right.legend(loc="lower left")
    page.picture(figure, "figure2_oscillation.svg")
    page.says("falls to {:.1f} degrees at K = 16. Near the ends, the error rises from {:.1f} degrees at K = 8 to {:.1f} degrees at K = 16.".format(
        errors[16][120:281].max(), errors[8].max(), errors[16].max()),
              f"has such a zero at {at[shown].real:.2f} + {abs(at[shown].imag):.2f} i")


# The next functions make section 5 of docs/paper.md.

CHOICES = {"slerp": (BLACK, "x"), "quaternion:edge": (SKY, "s"), "quaternion:polar": (PURPLE, "v"), MATRIX: (BLUE, "s"), OPTIMAL: (RED, "D"),
           "circle": (GREEN, "o"), TIMED: (ORANGE, "^")}
SEEDS = 200


def measure_frames(page):
    columns, (figure, axes) = [], plt.subplots(1, 4, figsize=(9, 3), sharey=True, layout="constrained")
    for name, ax in zip(MORPHS, axes):
        part = some(name, 2000)
        linear = part.sums("linear").sum()
        seeds = np.array(in_parallel(lambda seed: part.sums(f"quaternion:random:{seed}"), range(SEEDS)))  # noqa: B023
        chosen = {scheme: part.sums(scheme) for scheme in [*CHOICES, "quadratic"]}
        of = {scheme: sums.sum() / linear for scheme, sums in chosen.items()}
        of_seeds, best = seeds.sum(1) / linear, np.minimum.accumulate(seeds, axis=0).sum(1) / linear
        beats = seeds < chosen[MATRIX]
        columns.append((of, of_seeds, best[-1], beats.mean(), beats.any(0).mean()))
        page.requires(of_seeds.min() > of[MATRIX] > best[-1] > of[OPTIMAL], f"chance is worse than matrix, and its best better, on {name}")
        ax.plot(range(1, SEEDS + 1), best, color=GREY, lw=2.5, label="best random pair")
        for scheme, title in ((MATRIX, "matrix"), (OPTIMAL, "optimal")):
            ax.axhline(of[scheme], color=CHOICES[scheme][0], ls="--", label=title)
        ax.set(title=name, xlabel="pairs tried per face", xscale="log", xlim=(1, SEEDS), ylim=(0, 3.4), xticks=[1, 10, 100], xticklabels=["1", "10", "100"])
    axes[0].set_ylabel("sum relative to linear")
    axes[3].legend()
    page.picture(figure, "frames_best_of.svg")
    row = lambda title, cell: [title, *(cell(*column) for column in columns)]  # noqa: E731
    page.table("frames", ["sum relative to linear", *MORPHS], [
        row("random, mean of the seeds", lambda of, seeds, *_: ratio(seeds.mean())),
        row("random, least and most", lambda of, seeds, *_: f"{ratio(seeds.min())} to {ratio(seeds.max())}"),
        row("random, best of 200 on each face", lambda of, seeds, best, *_: ratio(best)),
        *(row(f"`{s}`", lambda of, *_, s=s: ratio(of[s])) for s in (MATRIX, OPTIMAL, "circle", TIMED)),
        row("random pairs better than `matrix`", lambda of, seeds, best, wins, _: percent(wins, 1)),
        row("faces where one of 200 is", lambda of, seeds, best, wins, faces: percent(faces, 1))])
    over = lambda a, b, form: [form(column[0][a] / column[0][b]) for column in columns]  # noqa: E731
    times = "{:.2f}".format
    page.table("worth", ["ratio of sums", *MORPHS], [["`optimal` against `matrix`", *over(OPTIMAL, MATRIX, times)],
                                                     ["`circle` against `optimal`", *over("circle", OPTIMAL, times)],
                                                     ["`circle:timed` against `optimal`", *over(TIMED, OPTIMAL, times)],
                                                     ["`quadratic` against `optimal`", *over("quadratic", OPTIMAL, times)]])
    saved, excess = over(OPTIMAL, MATRIX, lambda r: percent(1 - r)), over("circle", OPTIMAL, lambda r: r - 1)
    page.says(f"differ by {percent(max(seeds.max() / seeds.min() - 1 for _, seeds, *_ in columns))} at most",
              f"by {saved[0]}, {saved[1]}, {saved[2]} and {saved[3]} on the four morphs", f"({percent(columns[2][3])} of the draws on twist)",
              f"within {percent(excess[0], 2)}, {percent(excess[1], 1)} and {percent(excess[2], 1)} of the optimum",
              f"On eversion `circle` is {percent(excess[3])} worse",
              "the best is at " + "{}, {}, {} and {} relative to linear".format(*(ratio(column[0][OPTIMAL]) for column in columns)))
    draw_angle(page)


def draw_angle(page):
    """Draws the average error as a function of the angle phi (eq. 6 and 7 of docs/theory.md), for one face of each
    morph: the face whose linear error is the median."""
    (figure, axes), t, disagreement = plt.subplots(1, 3, figsize=(9, 3.6), layout="constrained"), np.linspace(0, 1, 201), 0
    for name, ax in zip(("cloth", "twist", "eversion"), axes):
        part = some(name, 2000)
        sums = part.sums("linear")[:part.count]
        face = part.face(np.argsort(sums, kind="stable")[int(0.5 * (part.count - 1) + 0.5)])
        exact = np.array([face.exact(x)[0] for x in t])
        u0, u1 = exact[0], exact[-1]
        pole, bisector = unit(np.cross(u0, u1)), unit(u0 + u1)

        def mean_error(phi):
            axis = np.cos(phi) * pole + np.sin(phi) * bisector  # noqa: B023
            w = dot(axis, u0) * axis  # noqa: B023
            p, q = u0 - w, np.cross(axis, u0)  # noqa: B023
            angle = np.arctan2(dot(q, u1), dot(p, u1)) % (2 * np.pi) * t[:, None]  # noqa: B023
            return degrees_between(w + np.cos(angle) * p + np.sin(angle) * q, exact).mean()  # noqa: B023

        for band in ((-180, -90), (90, 180)):
            ax.axvspan(*band, color="0.93", lw=0)
        ax.plot(range(-180, 181), [mean_error(np.radians(phi)) for phi in range(-180, 181)], color=GREY, lw=2)
        top = 0
        for scheme in list(CHOICES)[:-1]:
            shown = face.shown(scheme, t)[:, 0]
            axis = np.cross(shown[100] - u0, u1 - u0)
            phi = np.arctan2(dot(axis, bisector), dot(axis, pole))
            error = mean_error(phi)
            disagreement, top = max(disagreement, abs(error - degrees_between(shown, exact).mean())), max(top, error)
            colour, mark = CHOICES[scheme]
            ax.plot(np.degrees(phi), error, mark, color=colour, label=scheme.split(":")[-1], fillstyle="none" if scheme == "circle" else "full")
        ax.set(title=f"a face of {name}", xlabel="phi, degrees", xlim=(-180, 180), ylim=(0, 2.4 * top), xticks=[-180, -90, 0, 90, 180])
    axes[0].set_ylabel("average error, degrees")
    axes[2].legend(loc="upper center")
    page.picture(figure, "frames_angle.svg")
    page.requires(disagreement < 1e-3, "eq. 6 and 7 give what the schemes give")
    page.says(f"agree to {scientific(disagreement)} degrees")


# The next functions make section 6 of docs/paper.md.

def quaternions_of(tangent, binormal, normal):
    """Returns the quaternions of matrices. Computes the component with the largest square first, and the other
    components from it. For a matrix that is not a rotation, the result is the quaternion that common implementations
    give."""
    a, b, c = tangent.T, binormal.T, normal.T
    squares = np.stack([1 + a[0] + b[1] + c[2], 1 + a[0] - b[1] - c[2], 1 - a[0] + b[1] - c[2], 1 - a[0] - b[1] + c[2]])
    x, y, z, xy, xz, yz = b[2] - c[1], c[0] - a[2], a[1] - b[0], b[0] + a[1], c[0] + a[2], c[1] + b[2]
    rows = [[squares[0], x, y, z], [x, squares[1], xy, xz], [y, xy, squares[2], yz], [z, xz, yz, squares[3]]]
    return unit(np.choose(squares.argmax(0), np.array(rows)).T)


def frames_as_printed(part, tangent=1, w=0):
    """Computes the frames of section 2.5 of the paper by the 4 x 4 matrix of its Eq. 7. The computation is independent
    of the library, whose quaternion:matrix uses neither matrices nor quaternions. If `tangent` is -1, t1 = n1 x b1, as
    the paper prints it. `w` is the fourth component of normals."""
    n0, n1 = part.exact(0), part.exact(1)
    column = lambda v, w: np.concatenate([v, np.full((len(v), 1), float(w))], axis=1)  # noqa: E731
    matrices = [np.stack([column(part.corners[k][:, i], 1) for i in range(3)] + [column(n, w)], axis=2) for k, n in ((0, n0), (1, n1))]
    t0 = unit(part.corners[0][:, 1] - part.corners[0][:, 0])
    b0 = np.cross(n0, t0)
    within = np.linalg.solve(matrices[0], column(b0, 0)[:, :, None])
    b1 = unit((matrices[1] @ within)[:, :3, 0])
    return (t0, b0, n0), (tangent * np.cross(b1, n1), b1, n1)


def played_as_printed(frames, times):
    """Interpolates the quaternions of two frames by slerp. Yields the last column of the matrix, the normal, at each
    time."""
    q0, q1 = (quaternions_of(*frame) for frame in frames)
    q1 = np.where(dot(q0, q1)[:, None] < 0, -q1, q1)
    angle = np.arccos(np.minimum(dot(q0, q1), 1))[:, None]
    sine = np.sin(angle)
    for t in times:
        with np.errstate(invalid="ignore", divide="ignore"):
            wa, wb = (np.where(sine > 1e-9, np.sin(part * angle) / sine, part) for part in (1 - t, t))
        w, x, y, z = (wa * q0 + wb * q1).T
        yield unit(np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z], axis=1))


def measure_slips(page):
    times = np.linspace(0, 1, 21)
    twist, bend = some("twist", 2000), some("bend", 2000)
    linear, sums, from_library, at_end = twist.sums("linear").sum(), {}, {}, 0
    for name, part, options in (("right", twist, {}), ("literal", twist, {"tangent": -1}), ("point", bend, {"w": 1})):
        frames = frames_as_printed(part, **options)
        library = part.shown(MATRIX, times)
        errors = []
        for u, t, shown in zip(played_as_printed(frames, times), times, library):
            errors.append(degrees_between(u, part.exact(t)))
            from_library[name] = max(from_library.get(name, 0), degrees_between(u, shown).max())
        sums[name] = np.sum(errors)
        if name == "literal":
            at_end, determinant = errors[-1].mean(), np.linalg.det(np.stack(frames[1])[:, 0])
    whole = cn.read(sample="twist")
    whole = Part(whole.positions, whole.faces)
    singular = np.mean(np.abs(dot(whole.exact(0), whole.corners[0][:, 0]) - 1) < 1e-6)
    page.says(f"to {scientific(from_library['right'])} degrees on 2,000 faces of twist", f"its determinant is {determinant:.0f}",
              f"is {ratio(sums['literal'] / linear)} instead of {ratio(sums['right'] / linear)}", f"misses n1 by {at_end:.1f} degrees on average",
              f"({scientific(from_library['point'])} degrees apart at most on 2,000 faces of bend)",
              f"for {percent(singular)} of the faces")
    half = np.linalg.norm(twist.normals(0.5), axis=1)[0]
    page.says(f"a vector of length {half:.4f} at t = 1/2")

    faces, part = {"eversion": 21000, "soup": 5000}, some("eversion", 2000)
    row = {(name, found["scheme"]): found for name in faces
           for found in cn.compare(sample=name, schemes=["polynomial", "rational", TIMED, "quadratic", OPTIMAL, "circle"])["schemes"]}
    flagged = {name: percent(row[name, "polynomial"]["flagged"] / faces[name]) for name in faces}
    exact, rational = row["eversion", "polynomial"], row["eversion", "rational"]
    soup = {scheme: ratio(row["soup", scheme]["relative_to_linear"]) for scheme in (TIMED, "quadratic", OPTIMAL, "circle")}
    page.says(f"on eversion they are {flagged['eversion']} and on soup {flagged['soup']} of the faces",
              f"A face of eversion then takes {exact['bytes']:.0f} bytes on average and a face of soup {row['soup', 'polynomial']['bytes']:.0f} bytes",
              f"by {scientific(rational['mean_degrees'], 1)} degrees on average on eversion, and by {scientific(rational['max_degrees'], 1)} at worst",
              f"worse than linear on {percent(np.mean(part.sums(TIMED) > part.sums('linear')))} of the faces",
              f"On soup `circle:timed` has the ratio {soup[TIMED]}, and `quadratic` {soup['quadratic']}", f"(ratio {soup['circle']} against {soup[OPTIMAL]})")


# The next functions make section 7 of docs/paper.md.

def view_against(towards, along):
    """Returns the directions to the right and upwards in the picture of an observer who looks against `towards`. The
    direction `along` points to the right."""
    right = unit(along - dot(along, towards) * towards)
    return np.stack([right, np.cross(towards, right)], axis=1)


def draw_triangle(page, face):
    u0, u1 = face.exact(0)[0], face.exact(1)[0]
    # Look at both normals from above and from the side, so that neither the normals nor the triangles are seen edge on.
    view = view_against(unit(unit(np.cross(u1, u0)) + 0.8 * unit(u0 + u1)), u1 - u0)
    corners = face.corners[:, 0] - face.corners[:, 0].mean(axis=1, keepdims=True)
    corners = corners / np.linalg.norm(corners, axis=2).max() @ view
    figure, axes = plt.subplots(figsize=(8.6, 4.2), layout="constrained")
    for c in range(3):
        axes.plot(*corners[:, c].T, "--", color=GREY, lw=1, label="paths of the vertices" if c == 0 else None)
    for t in (0.25, 0.5, 0.75, 0, 1):
        colour, width, title = {0: (BLUE, 2, "t = 0"), 1: (RED, 2, "t = 1"), 0.5: (GREY, 1, "between")}.get(t, (GREY, 1, None))
        axes.plot(*((1 - t) * corners[0] + t * corners[1])[[0, 1, 2, 0]].T, color=colour, lw=width, label=title)
        tip, chord = face.exact(t)[0] @ view, unit((1 - t) * u0 + t * u1) @ view
        if t in (0, 1):
            axes.plot([0, tip[0]], [0, tip[1]], color=colour, lw=2.4)
        else:
            axes.plot([0, tip[0]], [0, tip[1]], color=BLACK, lw=2, label="exact normals" if t == 0.5 else None)
            axes.plot([0, chord[0]], [0, chord[1]], "--", color=SKY, lw=1.6, label="linear normals" if t == 0.5 else None)
    axes.set(aspect="equal", xlim=(-1.2, 1.2), ylim=(-0.8, 1.15))
    axes.axis("off")
    axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
    page.picture(figure, "figure1.svg")
    turned = np.array([face.exact(t)[0] for t in np.linspace(0, 1, 1001)])
    page.says(f"{degrees_between(u0, u1):.1f} degrees apart", f"turns by {degrees_between(turned[:-1], turned[1:]).sum():.1f}")


def draw_sphere(page, face):
    """Draws the levels of de Casteljau's algorithm, and the circles of frames, on the sphere."""
    t = np.linspace(0, 1, 101)
    exact = np.array([face.exact(x)[0] for x in t])
    u0, u1, half = exact[0], exact[-1], face.exact(0.5)[0]
    view = view_against(unit(u0 + half + u1), u1 - u0)
    shown = {scheme: face.shown(scheme, t)[:, 0] for scheme in ("decasteljau:4", "slerp", MATRIX, OPTIMAL, "circle")}

    def arc(a, b):
        angle = np.arccos(dot(a, b))
        return (np.outer(np.sin((1 - t) * angle), a) + np.outer(np.sin(t * angle), b)) / np.sin(angle)

    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.2), layout="constrained")
    for axes, title in ((left, "(a) de Casteljau with four normals"), (right, "(b) frames run on circles")):
        axes.plot(*(exact @ view).T, color=BLACK, lw=2.4, label="exact")
        axes.set(title=title, aspect="equal", xlim=(-0.9, 0.9), ylim=(-0.45, 0.95))
    level = [u0, face.exact(1 / 3)[0], face.exact(2 / 3)[0], u1]
    left.plot(*(np.array(level) @ view).T, "o", color=BLACK, ms=5)
    while len(level) > 1:
        arcs = [arc(a, b) for a, b in zip(level, level[1:])]
        for path in arcs:
            left.plot(*(path @ view).T, color=GREY, lw=1.2, label="arcs, at t = 1/2" if len(level) == 4 and path is arcs[0] else None)
        level = [path[50] for path in arcs]
    left.plot(*(shown["decasteljau:4"] @ view).T, color=PURPLE, label="decasteljau:4")
    left.plot(*(level[0] @ view), "s", color=PURPLE, ms=5)
    page.requires(degrees_between(level[0], shown["decasteljau:4"][50]) < 1e-4, "the construction is the scheme")
    for scheme in ("slerp", MATRIX, OPTIMAL, "circle"):
        colour, mark = (SKY, "x") if scheme == "slerp" else CHOICES[scheme]
        right.plot(*(shown[scheme] @ view).T, color=colour, label=scheme)
        right.plot(*(shown[scheme][50] @ view), mark, color=colour, ms=6, fillstyle="none" if scheme == "circle" else "full")
    right.plot(*(half @ view), "o", color=BLACK, ms=5)
    for axes in (left, right):
        axes.legend(loc="upper left")
    page.picture(figure, "figure3.svg")
    off = {scheme: f"{degrees_between(path[50], half):.1f}" for scheme, path in shown.items()}
    page.requires(dot(shown["circle"][50] - half, u1 - u0) > 0, "circle is past the middle at t = 1/2")
    page.says(f"is {off['decasteljau:4']} degrees from the exact normal at t = 1/2", f"is {off['slerp']} degrees away", f"`matrix` {off[MATRIX]}",
              f"`optimal` {off[OPTIMAL]}", f"is {off['circle']} degrees past it")


def main():
    page, face = Page("paper"), worst_of_twist()[1]
    for measure in (measure_table1, measure_table2, measure_drift, measure_figure2, measure_frames, measure_slips):
        measure(page)
    draw_triangle(page, face)
    draw_sphere(page, face)
    page.finish()


if __name__ == "__main__":
    main()
