"""Measures for docs/truth.md, by `compare --truth`, the errors of normals between keyframes against a known motion.

Sequences by other people are measured if CHRONORMAL_DATA names their folder. Otherwise their tables do not change.
The true normals for the table of pixels are computed here, in double, from positions alone.
"""

import io
import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from page import PROGRAM, Page, scientific

TURN = 2 * np.pi / 3  # total angle of the ball and of the top of the column, in radians
IN_EACH = 8  # number of steps per segment whose positions are known; all except the ends are compared
ROWS = {"linear": "`linear` (nlerp)", "slerp": "`slerp`", "quadratic": "`quadratic`", "decasteljau:4": "`decasteljau:4`",
        "quaternion:optimal": "`quaternion:optimal`", "polynomial": "`polynomial`: exact on straight paths",
        "catmull-rom": "exact on curves through the keyframes (`catmull-rom`)", "hermite": "exact on curves with known velocities (`hermite`)"}
SCHEMES = [name for name in ROWS if name not in ("catmull-rom", "hermite")]


def grid(around, up, place):
    """Returns a closed tube: positions (n, 3) and faces (m, 3). The vertices of the tube are at place(u, v), where u is
    the fraction around the tube and v the fraction upwards."""
    positions = np.array([place(j / around, i / up) for i in range(up + 1) for j in range(around)])
    i, j = np.divmod(np.arange(up * around), around)
    a, b = i * around + j, i * around + (j + 1) % around
    return positions, np.stack([a, a + around, b, b, a + around, b + around], axis=1).reshape(-1, 3).astype(np.int32)


def ball(around, up):
    at, down = 2 * np.pi * around, np.pi * (0.02 + 0.96 * up)
    return np.sin(down) * np.cos(at), np.cos(down), np.sin(down) * np.sin(at)


def column(around, up):
    side, part = divmod(4 * around, 1)
    corners = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)])
    x, z = (1 - part) * corners[int(side)] + part * corners[int(side) + 1]
    return x, 2 * up - 1, z


# The mesh of each motion, and a function that returns the speed at which each vertex turns around y, in radians per
# unit of time.
MOTIONS = {"turn": (grid(48, 24, ball), lambda p: TURN + 0 * p[:, 1]), "twist": (grid(48, 48, column), lambda p: TURN * (p[:, 1] + 1) / 2)}


def write_motion(path, name, times):
    (positions, faces), rate_of = MOTIONS[name]
    rate, (x, y, z) = rate_of(positions), positions.T
    turned = lambda t: np.stack([np.cos(rate * t) * x + np.sin(rate * t) * z, y, np.cos(rate * t) * z - np.sin(rate * t) * x], axis=1)  # noqa: E731
    frames = np.array([turned(t) for t in times])
    velocities = np.stack([rate * frames[..., 2], 0 * frames[..., 1], -rate * frames[..., 0]], axis=-1)
    np.savez(path, positions=frames.astype(np.float32), velocities=velocities.astype(np.float32), faces=faces, times=times)


def run(*words):
    return subprocess.run([PROGRAM, *map(str, words), "--quiet"], check=True, capture_output=True).stdout


def compared(path, every):
    """Returns the average error of each scheme or path in degrees, by its name, and the `bend` of compare as text."""
    result = json.loads(run("compare", path, "--truth", every, "--elements", "vertices", "--json", "--schemes", ",".join(SCHEMES)))
    found = {row["scheme"] if row["path"] == "linear" else row["path"]: row["mean_degrees"] for row in result["rows"]}
    of_faces = json.loads(run("compare", path, "--truth", every, "--elements", "faces", "--json", "--schemes", "quaternion:matrix"))
    found["matrix"] = next(row["mean_degrees"] for row in of_faces["rows"] if row["path"] == "linear")
    return found, f"{result['bend']:.2f}"


def degrees(value):
    # Smaller errors would be close to the rounding of float32.
    return f"{value:.3f}" if value >= 0.01 else f"{value:.4f}" if value >= 1e-4 else "< 0.0001"


def put(page, name, heads, columns):
    cell = lambda found, row: degrees(found[row]) if row in found else "-"  # noqa: E731
    titles = {row: title for row, title in {**ROWS, "matrix": "`quaternion:matrix`, of faces"}.items() if any(row in found for found, _ in columns)}
    page.table(name, ["average error, degrees", *heads], [[title, *(cell(found, row) for found, _ in columns)] for row, title in titles.items()]
               + [["bend of the path", *(bend for _, bend in columns)]])


def known(page, name):
    columns, counts = [], [1, 2, 4, 16]
    with tempfile.TemporaryDirectory() as folder:
        for count in counts:
            path = Path(folder) / f"{name}_{count}.npz"
            write_motion(path, name, np.linspace(0, 1, count * IN_EACH + 1))
            columns.append(compared(path, IN_EACH))
    put(page, name, [f"{count} segment" + "s" * (count > 1) for count in counts], columns)


def as_sequence(folder, path, *moments):
    """Writes a motion at some moments as a sequence. Returns the file, and its positions, times and faces."""
    file = Path(folder) / f"{path.stem}.npz"
    run("sample", path, *moments, "--force", "-o", file)
    arrays = np.load(file)
    poses, times, faces = arrays["positions"], arrays["times"], arrays["faces"]
    np.savez(file, positions=poses, times=times, faces=faces)
    return file, poses.astype(float), times, faces


def shown(path, name, times):
    """Returns the normals of a scheme at these times: an array (times, vertices, 3)."""
    out = run("sample", path, "--scheme", name, "--no-weld", "-o", "-", "--times", ",".join(map(repr, map(float, times))))
    return np.load(io.BytesIO(out)).astype(float)


def unit(vectors):
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)


def exact(positions, faces):
    a, b, c = np.moveaxis(positions[faces], 1, 0)
    sums = np.zeros_like(positions)
    for corner in faces.T:
        np.add.at(sums, corner, np.cross(b - a, c - a))
    return unit(sums)


def pixels_of(positions, faces, view, size=512):
    """Returns the pixels in which a face is visible, seen along z: for each of p pixels the face, and the weights (p,
    3) of its corners."""
    left, bottom, width = view
    screen = np.column_stack([(positions[:, :2] - (left, bottom)) / width * size, positions[:, 2]])
    depth, face_at, weights = np.full((size, size), -np.inf), np.full((size, size), -1), np.zeros((size, size, 3))
    for f, (a, b, c) in enumerate(screen[faces]):
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        low = np.maximum(np.ceil(np.min([a, b, c], 0)[:2] - 0.5).astype(int), 0)
        high = np.minimum(np.floor(np.max([a, b, c], 0)[:2] - 0.5).astype(int), size - 1)
        if area <= 0 or (low > high).any():  # the face shows its back, or covers no pixel
            continue
        x, y = np.meshgrid(np.arange(low[0], high[0] + 1) + 0.5, np.arange(low[1], high[1] + 1) + 0.5)
        v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        z = (1 - v - w) * a[2] + v * b[2] + w * c[2]
        part = (slice(low[1], high[1] + 1), slice(low[0], high[0] + 1))
        inside = (v >= 0) & (w >= 0) & (v + w <= 1) & (z > depth[part])
        depth[part][inside], face_at[part][inside], weights[part][inside] = z[inside], f, np.stack([1 - v - w, v, w], -1)[inside]
    return face_at[face_at >= 0], weights[face_at >= 0]


def levels(normals, faces, pixels):
    """Returns the grey levels, from 0 to 255 (sRGB), of a matte surface with one light."""
    light = unit(np.einsum("pc,pcd->pd", pixels[1], normals[faces[pixels[0]]])) @ unit(np.array([0.4, 0.5, 0.77]))
    light = 0.1 + 0.9 * np.maximum(light, 0)
    return 255 * np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def screens(page, data):
    """Measures how far the normals of some schemes are from the true normals at t = 1/4 of each segment: in degrees at
    vertices, and in grey levels of pixels."""
    rows = []
    for title, path, moments in [("dance", data / "sequences/rumba_13", ["--times", "keys"]),
                                 ("face", data / "rigs/ict_capture.glb", ["--animation", "0", "--times", "0:0.5:4"])]:
        with tempfile.TemporaryDirectory() as folder:
            file, poses, times, faces = as_sequence(folder, path, *moments)
            of_scheme = {name: shown(file, name, 0.75 * times[:-1] + 0.25 * times[1:])
                         for name in ("linear", "quadratic", "decasteljau:4", "quaternion:optimal")}
        low, high = poses.min((0, 1)), poses.max((0, 1))
        width = 1.02 * (high - low)[:2].max()
        view = (low + high)[0] / 2 - width / 2, (low + high)[1] / 2 - width / 2, width
        angles, differences = {name: [] for name in of_scheme}, {name: [] for name in of_scheme}
        for s, (start, end) in enumerate(zip(poses, poses[1:])):
            positions = 0.75 * start + 0.25 * end
            right = exact(positions, faces)
            pixels = pixels_of(positions, faces, view)
            turning = np.linalg.norm(exact(end, faces) - exact(start, faces), axis=1) > 1e-6
            touched, lit = turning[faces[pixels[0]]].any(1), levels(right, faces, pixels)
            for name, normals in of_scheme.items():
                n = normals[s]
                angles[name].append(np.degrees(np.arctan2(np.linalg.norm(np.cross(n, right), axis=1), np.sum(n * right, 1)))[turning])
                differences[name].append(np.abs(levels(n, faces, pixels) - lit)[touched])
        for name in of_scheme:
            of_vertices, of_pixels = np.concatenate(angles[name]), np.concatenate(differences[name])
            values = of_vertices.mean(), np.percentile(of_vertices, 99), *np.percentile(of_pixels, [90, 99])
            rows.append([f"{title}, `{name}`", *(f"{value:.2f}" for value in values)])
    page.table("screen", ["", "average, degrees", "99 %, degrees", "90 % of pixels, levels", "99 % of pixels, levels"], rows)


def sequences(page, data):
    with tempfile.TemporaryDirectory() as folder:
        face = as_sequence(folder, data / "rigs/ict_capture.glb", "--animation", "0", "--times", "keys")[0]
        inputs = {"dance, every 2nd": (data / "sequences/rumba_13", 2), "dance, 3rd": (data / "sequences/rumba_13", 3),
                  "face, 2nd": (face, 2), "face, 4th": (face, 4), "face, 8th": (face, 8)}
        put(page, "sequences", list(inputs), [compared(*one) for one in inputs.values()])


def table_1(page, data):
    names = ["linear", "quadratic", "cubic", "polynomial", "slerp", "decasteljau:4", "quaternion:matrix", "quaternion:optimal", "circle:timed"]
    columns = []
    for path in ("sequences/rumba_13", "rigs/ict_capture.glb"):
        found = json.loads(run("compare", data / path, "--schemes", ",".join(names), "--json", "--no-times"))
        columns.append({row["scheme"]: row["relative_to_linear"] for row in found["schemes"]})
    page.table("table 1", ["sum relative to linear", "the dance", "a face"],
               [[f"`{name}`", *(f"{c[name]:.3f}" if c[name] > 0.001 else scientific(c[name]) for c in columns)] for name in names])


def main():
    page = Page("truth")
    for name in MOTIONS:
        known(page, name)
    data = os.environ.get("CHRONORMAL_DATA")
    for measure in (sequences, screens, table_1) if data else ():
        measure(page, Path(data))
    page.finish()


if __name__ == "__main__":
    main()
