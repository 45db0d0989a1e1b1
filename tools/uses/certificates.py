"""Draws the picture of certificates in docs/uses.md: the error of linear interpolation on the worst face of `twist` over all
t, six samples that miss its largest value, and the certified bounds that enclose it.

    PYTHONPATH=build/release/python python3 tools/uses/certificates.py docs/pictures/certificates.svg
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import chronormal as cn  # noqa: E402

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


def draw(path):
    motion = cn.read(sample="twist")
    p0, p1 = motion.positions
    bounds = cn.certify(p0, p1, motion.faces, "linear")
    face = motion.faces[np.argmax(bounds["upper"])]
    worst = {name: float(values[np.argmax(bounds["upper"])]) for name, values in bounds.items()}
    times = np.linspace(0, 1, 401)
    matplotlib.rcParams["svg.hashsalt"] = "chronormal"
    figure, axes = plt.subplots(figsize=(7, 3.2))
    axes.axvspan(worst["from"], worst["to"], color="0.9", label="piece with the largest bound")
    axes.plot(times, errors(p0, p1, face, times), color="tab:blue", label="error of linear")
    axes.plot(SAMPLES, errors(p0, p1, face, SAMPLES), "o", color="tab:orange", label="6 samples")
    axes.axhline(worst["upper"], color="tab:red", lw=1, label=f"at most {worst['upper']:.2f} degrees")
    axes.plot(worst["at"], worst["lower"], "v", color="tab:green", label=f"at least {worst['lower']:.2f}")
    axes.set(xlabel="t", ylabel="degrees", xlim=(0, 1), ylim=(0, None))
    axes.legend(loc="lower center", fontsize=8)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    draw(sys.argv[1])
