"""Draws the pictures of docs/python.md by the code of that page, into docs/pictures.

    pictures.py            writes them
    pictures.py --check    draws them elsewhere, and ends with 1 where one looks different
"""

import os
import re
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.image  # noqa: E402
import numpy as np  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent.parent
PICTURES = ROOT / "docs" / "pictures"


def draw():
    """Runs the blocks ```python of the page one after the other, in this folder."""
    blocks = re.findall(r"^```python\n(.*?)^```$", (ROOT / "docs" / "python.md").read_text(), re.M | re.S)
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    return sorted(Path(".").glob("*.png"))


def main():
    is_check = sys.argv[1:] == ["--check"]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        drawn = draw()
        assert len(drawn) == 3, drawn
        different = 0
        for picture in drawn:
            there = PICTURES / picture.name
            if not is_check:
                there.write_bytes(picture.read_bytes())
                continue
            now, before = matplotlib.image.imread(picture), matplotlib.image.imread(there)
            if now.shape != before.shape or np.abs(now - before).mean() > 0.002:
                print(f"{there} looks different now: tools/make_python_pictures draws it", file=sys.stderr)
                different += 1
        os.chdir("/")
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main()
