"""Draws the pictures of docs/uses.md: each module beside this one has a function draw() that returns a figure of matplotlib.

    pictures.py            writes docs/pictures/uses_NAME.png for every NAME.py
    pictures.py --check    draws them elsewhere, and ends with 1 where one looks different
"""

import importlib
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.image  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

HERE = Path(__file__).resolve().parent
PICTURES = HERE.parent.parent / "docs" / "pictures"


def save(figure, path):
    """Writes a PNG of 96 colours, a third of the size of one with all."""
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
    picture.quantize(96, dither=Image.Dither.NONE).save(path, optimize=True)


def main():
    is_check = sys.argv[1:] == ["--check"]
    different = 0
    for name in sorted(file.stem for file in HERE.glob("*.py") if file.stem != "pictures"):
        figure = importlib.import_module(name).draw()
        there = PICTURES / f"uses_{name}.png"
        if not is_check:
            save(figure, there)
            continue
        with tempfile.TemporaryDirectory() as folder:
            drawn = Path(folder) / there.name
            save(figure, drawn)
            now, before = matplotlib.image.imread(drawn), matplotlib.image.imread(there)
        if now.shape != before.shape or np.abs(now - before).mean() > 0.002:
            print(f"{there} looks different now: tools/make_uses draws it", file=sys.stderr)
            different += 1
        plt.close(figure)
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
