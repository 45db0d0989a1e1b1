"""A flat sheet that is pushed over itself: when each of its faces has no area."""

import matplotlib.pyplot as plt
import numpy as np

import chronormal as cn


def sheet(size):
    x, y = np.meshgrid(np.linspace(0, 1, size + 1), np.linspace(0, 1, size + 1))
    corner = np.arange(size * (size + 1)).reshape(size, size + 1)[:, :-1].ravel()
    quads = np.stack([corner, corner + 1, corner + size + 2, corner + size + 1], axis=1)
    return x.ravel(), y.ravel(), np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def draw():
    x, y, faces = sheet(80)
    push = 0.42 * np.sin(2 * np.pi * x) * np.sin(np.pi * y)
    positions = np.array([np.stack([x, y, 0 * x], axis=1), np.stack([x + push, y, 0 * x], axis=1)], np.float32)
    found = cn.collapse(positions, faces)
    when = np.full(len(faces), np.nan)
    when[found["face"]] = found["upper"]
    figure, axes = plt.subplots(1, 2, figsize=(8, 3.9), constrained_layout=True)
    for ax, moved, title in zip(axes, positions, ("where it was at t = 0", "where it is at t = 1")):
        ax.tripcolor(moved[:, 0], moved[:, 1], faces, facecolors=np.zeros(len(faces)), cmap="Greys", vmin=-1, vmax=3)
        shown = np.isfinite(when)
        image = ax.tripcolor(moved[:, 0], moved[:, 1], faces[shown], facecolors=when[shown], cmap="viridis", vmin=0.3,
                             vmax=1)
        ax.set_title(title, fontsize=10)
        ax.set_aspect("equal")
        ax.axis("off")
    figure.colorbar(image, ax=axes, label="t of the collapse", shrink=0.8)
    figure.suptitle(f"{len(found['face']):,} of {len(faces):,} faces turn over on the way; grey ones never", fontsize=11)
    return figure
