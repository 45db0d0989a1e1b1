"""A normal while a shutter is open, its mean, and what interpolation between its ends has as the mean."""

import matplotlib.pyplot as plt
import numpy as np

import chronormal as cn
from cones import EXACT, PLAIN, RIVAL, View, normals_at, soup, unit


def draw():
    figure, (sphere, histogram) = plt.subplots(1, 2, figsize=(9, 3.8))
    keyframes, faces = soup(0.6, 4000)
    found = cn.shutter(keyframes, faces)
    t = np.linspace(0, 1, 201)
    candidates = (found["half_angle"] < 50) & (found["ends_off"] > 8)
    face = np.flatnonzero(candidates)[np.argmax(found["ends_off"][candidates])]
    curve = np.stack([unit(normals_at(keyframes, x)[face]) for x in t])
    view = View(found["mean_unit"][face])
    sphere.plot(*view(curve).T, color="black", label="the normal while the shutter is open")
    sphere.scatter(*view(curve[::20]).T, color="black", s=10)
    sphere.plot(*view(found["mean_unit"][face][None]).T, "o", color=EXACT, label="mean of the unit normal")
    sphere.plot(*view(found["mean"][face][None]).T, "s", color=PLAIN, label="mean of n(t): by area")
    sphere.plot(*view(found["ends"][face][None]).T, "X", color=RIVAL, label="mean of lerp and nlerp of the ends")
    sphere.set(title="One face", xlabel="degrees", ylabel="degrees", aspect="equal")
    sphere.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), frameon=False, fontsize=8)

    for motion, shade in ((0.1, 0.45), (0.2, 0.7), (0.4, 1)):
        keyframes, faces = soup(motion, 4000)
        off = np.sort(cn.shutter(keyframes, faces)["ends_off"])
        histogram.plot(off, 100 * (1 - np.arange(len(off)) / len(off)), color=RIVAL, alpha=shade, label=f"motion of {motion}")
    histogram.set(title="How far lerp of the ends is off in the mean", xlabel="degrees from the mean unit normal",
                  ylabel="% of 4,000 triangles beyond", xscale="log", xlim=(0.01, 90))
    histogram.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    return figure
