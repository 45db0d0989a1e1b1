"""A drop that falls and is squeezed, and dust that rises through it: what is inside when, and where it crosses the surface."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import chronormal as cn


def ball(rows, columns):
    """A closed sphere with a vertex at each pole: (V, 3), (F, 3)."""
    polar, around = np.meshgrid(np.pi * np.arange(1, rows) / rows, 2 * np.pi * np.arange(columns) / columns,
                                indexing="ij")
    rings = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1)
    vertices = np.concatenate([[[0, 0, 1]], rings.reshape(-1, 3), [[0, 0, -1]]])
    ring = lambda row, k: 1 + row * columns + k % columns  # noqa: E731
    k, last = np.arange(columns), len(vertices) - 1
    faces = [np.stack([0 * k, ring(0, k), ring(0, k + 1)], axis=1)]
    for row in range(rows - 2):
        a, b, c, d = ring(row, k), ring(row + 1, k), ring(row + 1, k + 1), ring(row, k + 1)
        faces += [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
    faces.append(np.stack([ring(rows - 2, k), 0 * k + last, ring(rows - 2, k + 1)], axis=1))
    return vertices, np.concatenate(faces)


def draw():
    vertices, faces = ball(24, 48)
    x, y, z = vertices.T
    falls = np.stack([x * (0.7 + 0.3 * z), y * (0.7 + 0.3 * z), z + 1], axis=1)
    squeezed = np.stack([1.6 * x * (1 - 0.4 * np.cos(3 * z)), y, 0.55 * z - 0.4 * np.abs(x)], axis=1)
    positions = np.array([vertices * [0.8, 0.8, 1.2] + [0, 0, 1], falls, squeezed], np.float32)
    random = np.random.default_rng(7)
    start = random.uniform([-2, -0.05, -1.5], [2, 0.05, 1.5], (500, 3))
    points = np.stack([start, start + [0.3, 0, 0.8]], axis=1)
    found = cn.contain(positions, faces, points)

    figure, axes = plt.subplots(1, 3, figsize=(10, 3.7), constrained_layout=True)
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
        normals = found["crossing_normal"][now]
        colors = np.where(found["crossing_inward"][now], "black", "tab:orange")
        ax.quiver(places[:, 0], places[:, 2], normals[:, 0], normals[:, 2], color=colors, width=0.006, scale=12)
        ax.set(xlim=(-2.3, 2.3), ylim=(-1.6, 2.4), aspect="equal", title=f"time {time}: {inside.sum()} inside")
        ax.title.set_fontsize(10)
        ax.axis("off")
    return figure
