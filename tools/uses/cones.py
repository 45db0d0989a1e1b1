"""A normal that leaves the cone of its two ends, in the cone of the interval; and how many random triangles do that."""

import matplotlib.pyplot as plt
import numpy as np

import chronormal as cn

EXACT, RIVAL, PLAIN = "#1b7837", "#c2410c", "#555555"


def unit(vectors):
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def normals_at(keyframes, t):
    """n(t) of triangles that share nothing, (F, 3)."""
    corners = ((1 - t) * keyframes[0].astype(float) + t * keyframes[1]).reshape(-1, 3, 3)
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def soup(motion, count, seed=3):
    """Random triangles whose corners move by up to `motion` times their size."""
    random = np.random.default_rng(seed)
    start = random.uniform(-0.5, 0.5, (3 * count, 3))
    end = start + random.uniform(-motion, motion, (3 * count, 3))
    return np.stack([start, end]).astype(np.float32), np.arange(3 * count).reshape(-1, 3)


class View:
    """A part of the sphere around an axis, flattened so that distances from the axis are angles in degrees."""

    def __init__(self, axis):
        self.axis = unit(np.asarray(axis, float))
        helper = np.eye(3)[np.abs(self.axis).argmin()]
        self.right = unit(np.cross(helper, self.axis))
        self.up = np.cross(self.axis, self.right)

    def __call__(self, directions):
        directions = unit(np.asarray(directions, float))
        across = np.stack([directions @ self.right, directions @ self.up], axis=-1)
        sine = np.linalg.norm(across, axis=-1, keepdims=True)
        angle = np.degrees(np.arctan2(sine[..., 0], directions @ self.axis))[..., None]
        return np.where(sine > 0, across / np.where(sine > 0, sine, 1) * angle, 0)

    def circle(self, axis, half_angle):
        turn = np.linspace(0, 2 * np.pi, 181)
        other = View(axis)
        rim = np.cos(half_angle) * other.axis + np.sin(half_angle) * (
            np.cos(turn)[:, None] * other.right + np.sin(turn)[:, None] * other.up)
        return self(rim)


def draw():
    figure, (sphere, bars) = plt.subplots(1, 2, figsize=(9, 4.2), width_ratios=(1.1, 1))
    keyframes, faces = soup(0.6, 400)
    t = np.linspace(0, 1, 201)
    curves = np.stack([unit(normals_at(keyframes, x)) for x in t])
    ends = unit(curves[0] + curves[-1])
    of_ends = np.arccos(np.clip((curves[0] * ends).sum(-1), -1, 1))
    off = np.arccos(np.clip((curves * ends).sum(-1), -1, 1)).max(axis=0) - of_ends
    found = cn.cones(keyframes, faces)
    # A face that leaves the cone of its ends clearly, and whose own cone is not too wide to look at.
    face = np.argmax(np.where((found["half_angle"] < 40) & (np.degrees(of_ends) > 8), off, -1))
    view = View(found["axis"][face])
    sphere.plot(*view.circle(view.axis, np.arcsin(found["sine"][face])).T, color=EXACT, label="cone of the interval")
    sphere.plot(*view.circle(ends[face], of_ends[face]).T, color=RIVAL, linestyle="--", label="cone of the two ends")
    sphere.plot(*view(curves[:, face]).T, color="black", label="the normal, t from 0 to 1")
    sphere.plot(*view(curves[[0, -1], face]).T, "o", color="black", markersize=4)
    sphere.set(title="One face", xlabel="degrees", ylabel="degrees", aspect="equal")
    sphere.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), frameon=False, fontsize=8)

    motions = [0.05, 0.1, 0.2, 0.4, 0.7, 1]
    outside, none = [], []
    for motion in motions:
        keyframes, faces = soup(motion, 4000)
        curves = np.stack([unit(normals_at(keyframes, x)) for x in np.linspace(0, 1, 65)])
        ends = unit(curves[0] + curves[-1])
        limit = np.arccos(np.clip((curves[0] * ends).sum(-1), -1, 1))
        outside.append(100 * (np.arccos(np.clip((curves * ends).sum(-1), -1, 1)).max(axis=0) > limit + 1e-6).mean())
        found = cn.cones(keyframes, faces)
        cosine = np.clip((curves * unit(found["axis"].astype(float))).sum(-1), -1, 1).min(axis=0)
        none.append(100 * (np.degrees(np.arccos(cosine)) > found["half_angle"] + 1e-5).mean())
    assert max(none) == 0, none
    bars.plot(motions, outside, "o--", color=RIVAL, label="cone of the two ends")
    bars.plot(motions, none, "o-", color=EXACT, label="cone of the interval")
    bars.set(title="Faces that leave their cone on the way", xlabel="motion of the corners / size of the triangle",
             ylabel="% of 4,000 random triangles", ylim=(-2, None))
    bars.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    return figure
