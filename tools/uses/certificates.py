"""The error of linear interpolation on the worst face of `twist` over all t, samples that miss its largest value, and the
certified bounds that enclose it."""

import matplotlib.pyplot as plt
import numpy as np

import chronormal as cn

SAMPLES = np.linspace(0, 1, 6)


def errors(p0, p1, face, times):
    """Degrees between linear interpolation and the exact normal of one face."""
    def normal(t):
        a, b, c = ((1 - t) * p0[face] + t * p1[face]).astype(float)
        n = np.cross(b - a, c - a)
        return n / np.linalg.norm(n)
    result = []
    for t in times:
        shown, exact = (1 - t) * normal(0) + t * normal(1), normal(t)
        result.append(np.degrees(np.arctan2(np.linalg.norm(np.cross(shown, exact)), shown @ exact)))
    return np.array(result)


def draw():
    motion = cn.read(sample="twist")
    p0, p1 = motion.positions
    bounds = cn.certify(p0, p1, motion.faces, "linear")
    face = motion.faces[np.argmax(bounds["upper"])]
    worst = {name: float(values[np.argmax(bounds["upper"])]) for name, values in bounds.items()}
    times = np.linspace(0, 1, 401)
    figure, axes = plt.subplots(figsize=(7, 3.2), constrained_layout=True)
    axes.axvspan(worst["from"], worst["to"], color="0.9", label="piece with the largest bound")
    axes.plot(times, errors(p0, p1, face, times), color="tab:blue", label="error of linear")
    axes.plot(SAMPLES, errors(p0, p1, face, SAMPLES), "o", color="tab:orange", label="6 samples")
    axes.axhline(worst["upper"], color="tab:red", lw=1, label=f"at most {worst['upper']:.2f} degrees")
    axes.plot(worst["at"], worst["lower"], "v", color="tab:green", label=f"at least {worst['lower']:.2f}")
    axes.set(xlabel="t", ylabel="degrees", xlim=(0, 1), ylim=(0, None))
    axes.legend(loc="lower center", fontsize=8)
    return figure
