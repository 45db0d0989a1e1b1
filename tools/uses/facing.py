"""A cloth that falls, seen from far away: which faces show their front when, and the silhouette at one instant."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

import chronormal as cn

VIEWER = np.array([4.0, -5.0, 2.0], np.float32)


def draw():
    motion = cn.read(sample="eversion")
    positions, faces = np.asarray(motion.positions), np.asarray(motion.faces)
    found = cn.facing(positions, faces, direction=VIEWER, silhouettes=True)
    count = len(faces)
    length = np.bincount(found["face"], found["to"] - found["from"], minlength=count)
    # The picture plane: right, up, and towards the viewer.
    forward = VIEWER / np.linalg.norm(VIEWER)
    right = np.cross([0, 0, 1], forward)
    right /= np.linalg.norm(right)
    frame = np.stack([right, np.cross(forward, right), forward], axis=1)
    figure, axes = plt.subplots(1, 3, figsize=(9, 3.4), constrained_layout=True)
    for ax, t in zip(axes, (0.3, 0.5, 0.7)):
        seen = ((1 - t) * positions[0] + t * positions[1]) @ frame
        order = np.argsort(seen[faces].mean(axis=1)[:, 2])
        collection = PolyCollection(seen[faces[order]][:, :, :2], array=length[order], cmap="coolwarm", edgecolors="face",
                                    linewidths=0.2, clim=(0, 1), rasterized=True)
        ax.add_collection(collection)
        open_edges = (found["silhouette_from"] <= t) & (t <= found["silhouette_to"])
        edges = seen[found["silhouette_vertices"][open_edges]][:, :, :2]
        ax.add_collection(LineCollection(edges, colors="black", linewidths=0.5))
        ax.autoscale()
        ax.set_aspect("equal")
        ax.axis("off")
        ax.set_title(f"t = {t}: {open_edges.sum():,} silhouette edges", fontsize=10)
    figure.colorbar(collection, ax=axes, label="share of the time that shows the front", shrink=0.8)
    return figure
