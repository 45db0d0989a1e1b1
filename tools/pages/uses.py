"""Draws the pictures of docs/uses.md from the answers that the Python package gives."""

import chronormal as cn
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from page import Page, plt

EXACT, BASELINE = "#1b7837", "#c2410c"


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def soup(motion, count):
    """Returns random triangles whose corners move by up to `motion` times the size of a triangle, and the unit normals
    of the triangles at 201 times from 0 to 1."""
    random = np.random.default_rng(3)
    start = random.uniform(-0.5, 0.5, (3 * count, 3))
    end = start + random.uniform(-motion, motion, (3 * count, 3))
    keyframes, curves = np.stack([start, end]).astype(np.float32), []
    for t in np.linspace(0, 1, 201):
        a, b, c = np.moveaxis(((1 - t) * keyframes[0].astype(float) + t * keyframes[1]).reshape(-1, 3, 3), 1, 0)
        curves.append(unit(np.cross(b - a, c - a)))
    return keyframes, np.arange(3 * count).reshape(-1, 3), np.stack(curves)


def flat(axis):
    """Returns two functions of a flat map of the sphere around an axis, in which distances from the axis are angles in
    degrees. seen(directions) maps directions, and rim(half_angle) returns the directions on the rim of a cone around
    the axis."""
    axis = unit(np.asarray(axis, float))
    right = unit(np.cross(np.eye(3)[np.abs(axis).argmin()], axis))
    up = np.cross(axis, right)

    def seen(directions):
        across = np.stack([directions @ right, directions @ up], axis=-1)
        sine = np.linalg.norm(across, axis=-1)
        return across / np.maximum(sine, 1e-300)[..., None] * np.degrees(np.arctan2(sine, directions @ axis))[..., None]

    def rim(half_angle):
        turn = np.linspace(0, 2 * np.pi, 181)[:, None]
        return np.cos(half_angle) * axis + np.sin(half_angle) * (np.cos(turn) * right + np.sin(turn) * up)

    return seen, rim


def draw_cones(page):
    """Draws a normal that leaves the cone of its two ends, and the cone of the whole interval. Counts the random
    triangles whose normals leave the cone of their ends."""
    figure, (sphere, bars) = plt.subplots(1, 2, figsize=(9, 4.2), width_ratios=(1.1, 1), layout="constrained")

    def measured(motion, count):
        keyframes, faces, curves = soup(motion, count)
        ends = unit(curves[0] + curves[-1])
        angle = lambda axis: np.arccos(np.clip((curves * axis).sum(-1), -1, 1))  # noqa: E731
        return curves, ends, angle(ends)[0], angle(ends).max(0), cn.cones(keyframes, faces), angle

    curves, ends, of_ends, farthest, found, _ = measured(0.6, 400)
    # Selects the face whose normal leaves the cone of its ends the farthest. For a good picture, the cone of the
    # interval must not be too wide, and the cone of the ends not too narrow.
    face = np.argmax(np.where((found["half_angle"] < 40) & (np.degrees(of_ends) > 8), farthest - of_ends, -1))
    seen, rim = flat(found["axis"][face])
    sphere.plot(*seen(rim(np.arcsin(found["sine"][face]))).T, color=EXACT, label="cone of the interval")
    sphere.plot(*seen(flat(ends[face])[1](of_ends[face])).T, color=BASELINE, linestyle="--", label="cone of the two ends")
    sphere.plot(*seen(curves[:, face]).T, color="black", label="the normal, t from 0 to 1")
    sphere.plot(*seen(curves[[0, -1], face]).T, "o", color="black", markersize=4)
    sphere.set(title="one face", xlabel="degrees", ylabel="degrees", aspect="equal")
    sphere.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncol=3)
    motions, outside = [0.05, 0.1, 0.2, 0.4, 0.7, 1], []
    for motion in motions:
        _, _, of_ends, farthest, found, angle = measured(motion, 4000)
        outside.append(100 * (farthest > of_ends + 1e-6).mean())
        inside = np.degrees(angle(unit(found["axis"].astype(float)))).max(0) <= found["half_angle"] + 1e-5
        page.requires(inside.all(), "no normal leaves the cone of its interval")
    bars.plot(motions, outside, "o--", color=BASELINE, label="cone of the two ends")
    bars.plot(motions, [0 for _ in motions], "o-", color=EXACT, label="cone of the interval")
    bars.set(title="faces that leave their cone on the way", xlabel="motion of the corners / size of the triangle", ylabel="% of 4,000 random triangles", ylim=(-2, None))
    bars.legend()
    page.picture(figure, "uses_cones.png")


def draw_facing(page):
    """Draws a sphere that turns inside out, seen from far away. The pictures show the intervals in which faces show
    their front, and the silhouette at an instant."""
    viewer = np.array([4.0, -5.0, 2.0])
    motion = cn.read(sample="eversion")
    positions, faces = np.asarray(motion.positions), np.asarray(motion.faces)
    found = cn.facing(positions, faces, direction=viewer, silhouettes=True)
    length = np.bincount(found["face"], found["to"] - found["from"], minlength=len(faces))
    forward, right = unit(viewer), unit(np.cross([0, 0, 1], viewer))
    frame = np.stack([right, np.cross(forward, right), forward], axis=1)
    figure, axes = plt.subplots(1, 3, figsize=(9, 3.4), layout="constrained")
    for ax, t in zip(axes, (0.3, 0.5, 0.7)):
        seen = ((1 - t) * positions[0] + t * positions[1]) @ frame
        order = np.argsort(seen[faces].mean(axis=1)[:, 2])
        shown = PolyCollection(seen[faces[order]][:, :, :2], array=length[order], cmap="coolwarm", edgecolors="face", linewidths=0.2, clim=(0, 1))
        ax.add_collection(shown)
        edges = found["silhouette_vertices"][(found["silhouette_from"] <= t) & (t <= found["silhouette_to"])]
        ax.add_collection(LineCollection(seen[edges][:, :, :2], colors="black", linewidths=0.5))
        ax.autoscale()
        ax.set(aspect="equal", title=f"t = {t}: {len(edges):,} silhouette edges")
        ax.axis("off")
    figure.colorbar(shown, ax=axes, label="share of the time that shows the front", shrink=0.8)
    page.picture(figure, "uses_facing.png")


def ball(rows, columns):
    """Returns a closed sphere with a vertex at each pole."""
    polar, around = np.meshgrid(np.pi * np.arange(1, rows) / rows, 2 * np.pi * np.arange(columns) / columns, indexing="ij")
    rings = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    vertices = np.concatenate([[[0, 0, 1]], rings.reshape(-1, 3), [[0, 0, -1]]])
    ring = lambda row, k: 1 + row * columns + k % columns  # noqa: E731
    k, last = np.arange(columns), len(vertices) - 1
    faces = [(0 * k, ring(0, k), ring(0, k + 1)), (ring(rows - 2, k), 0 * k + last, ring(rows - 2, k + 1))]
    for row in range(rows - 2):
        a, b, c, d = ring(row, k), ring(row + 1, k), ring(row + 1, k + 1), ring(row, k + 1)
        faces += [(a, b, c), (a, c, d)]
    return vertices, np.concatenate([np.stack(part, axis=1) for part in faces])


def draw_contain(page):
    """Draws a drop that falls and is squeezed, and dust that rises through the drop. The pictures show the share of the
    dust inside over time, and the crossings of the surface."""
    vertices, faces = ball(24, 48)
    x, y, z = vertices.T
    falls = np.stack([x * (0.7 + 0.3 * z), y * (0.7 + 0.3 * z), z + 1], axis=1)
    squeezed = np.stack([1.6 * x * (1 - 0.4 * np.cos(3 * z)), y, 0.55 * z - 0.4 * np.abs(x)], axis=1)
    positions = np.array([vertices * [0.8, 0.8, 1.2] + [0, 0, 1], falls, squeezed], np.float32)
    start = np.random.default_rng(7).uniform([-2, -0.05, -1.5], [2, 0.05, 1.5], (500, 3))
    points = np.stack([start, start + [0.3, 0, 0.8]], axis=1)
    found = cn.contain(positions, faces, points)
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.7), layout="constrained")
    for ax, time in zip(axes, (0.5, 1.25, 1.9)):
        k = int(time)
        mesh = (1 - (time - k)) * positions[k] + (time - k) * positions[k + 1]
        dust = points[:, 0] + time / 2 * (points[:, 1] - points[:, 0])
        inside = cn.contain(positions, faces, points, start=time)["inside"]
        ax.add_collection(PolyCollection(mesh[faces][:, :, [0, 2]], facecolors="0.85", edgecolors="0.85", linewidths=0.3))
        ax.scatter(*dust[inside][:, [0, 2]].T, s=6, color="tab:red")
        ax.scatter(*dust[~inside][:, [0, 2]].T, s=3, color="tab:blue", alpha=0.5)
        now = np.abs(found["crossing_time"] - time) < 0.12
        when, which = found["crossing_time"][now], found["crossing_point"][now]
        places = points[which, 0] + when[:, None] / 2 * (points[which, 1] - points[which, 0])
        normals, colours = found["crossing_normal"][now], np.where(found["crossing_inward"][now], "black", "tab:orange")
        ax.quiver(places[:, 0], places[:, 2], normals[:, 0], normals[:, 2], color=colours, width=0.006, scale=12)
        ax.set(xlim=(-2.3, 2.3), ylim=(-1.6, 2.4), aspect="equal", title=f"time {time}: {inside.sum()} inside")
        ax.axis("off")
    page.picture(figure, "uses_contain.png")


def main():
    page = Page("uses")
    for draw in (draw_cones, draw_facing, draw_contain):
        draw(page)
    page.finish()


if __name__ == "__main__":
    main()
