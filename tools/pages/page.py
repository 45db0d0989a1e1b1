"""Keeps the figures and pictures of a page of docs/ up to date, for the other scripts of this folder.

A page is written by hand, except for its tables, which are between <!-- NAME --> and <!-- end -->. Page.says()
checks the figures in the prose of the page. `tools/make_page NAME` writes tables and pictures anew. With --check, it
changes nothing. In both cases, the exit code is 1 if the page differs from the measurements.
"""

import os
import re
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PROGRAM = os.environ.get("CHRONORMAL_PROGRAM", str(ROOT / "build/release/chronormal"))
BLACK, BLUE, ORANGE, GREEN, PURPLE, SKY, RED, GREY = ("#000000", "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00",
                                                      "#8c8c8c")
plt.rcParams.update({"svg.hashsalt": "chronormal", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
                     "legend.frameon": False, "legend.fontsize": 8, "axes.titlesize": 10})


def grouped(value, decimals=0):
    return f"{value:,.{decimals}f}"


def scientific(value, decimals=0):
    """Formats a number like 3.1e-6. A number from 1 to 10 gets no exponent."""
    digits, exponent = f"{value:.{decimals}e}".split("e")
    return digits if int(exponent) == 0 else f"{digits}e{int(exponent)}"


def ratio(value):
    return "0" if value == 0 else scientific(value) if abs(value) < 1e-3 else f"{value:.3f}"


def percent(share, decimals=0):
    return f"{100 * share:.{decimals}f} %"


def table(heads, rows):
    """Returns a table in Markdown. Columns whose first cell is a number are aligned to the right."""
    rows = [[str(cell) for cell in row] for row in rows]
    widths = [max(len(cell) for cell in column) for column in zip(heads, *rows)]
    right = [re.match(r"\*{0,2}[-+<]?[\d.]", cell) is not None for cell in rows[0]]
    line = lambda cells: "| " + " | ".join(c.rjust(w) if r else c.ljust(w) for c, w, r in zip(cells, widths, right)) + " |"  # noqa: E731
    rule = "|" + "|".join("-" * (w + 1) + (":" if r else "-") for w, r in zip(widths, right)) + "|"
    return "\n".join([line(heads), rule, *map(line, rows)])


def save(figure, path):
    """Writes an SVG, or a PNG of 96 colours, whose file has a third of the size of a PNG with all colours."""
    if path.suffix == ".svg":
        return figure.savefig(path, metadata={"Date": None, "Creator": None})
    from PIL import Image
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
    picture.quantize(96, dither=Image.Dither.NONE).save(path, optimize=True)


def looks_alike(path, other):
    """Returns True if two pictures are equal up to rounding."""
    if path.suffix == ".svg":
        number = re.compile(r"-?\d+\.\d+")
        # Removes names that Matplotlib makes from hashes, since they differ from run to run.
        one, two = (re.sub(r"#?\b[mpCD][0-9a-f]+(?:_\d+)?\b", "", file.read_text()) for file in (path, other))
        if number.sub("", one) != number.sub("", two):
            return False
        numbers = [np.array(number.findall(text), float) for text in (one, two)]
        return len(numbers[0]) == len(numbers[1]) and np.abs(numbers[0] - numbers[1]).max() < 0.05
    one, two = plt.imread(path), plt.imread(other)
    return one.shape == two.shape and np.abs(one - two).mean() <= 0.005


class Page:
    def __init__(self, name):
        self.name, self.is_check = name, "--check" in sys.argv
        self.path = DOCS / f"{name}.md"
        self.text = self.path.read_text()
        self.faults = 0

    def fault(self, text):
        print(f"{self.path.relative_to(ROOT)}: {text}", file=sys.stderr)
        self.faults += 1

    def table(self, name, heads, rows):
        """Replaces the table between <!-- name --> and <!-- end --> in the page."""
        place = re.search(f"(?<=<!-- {name} -->\n).*?(?=<!-- end -->)", self.text, re.S)
        if place is None:
            return self.fault(f"it has no place <!-- {name} -->")
        now = table(heads, rows) + "\n"
        if self.is_check and place[0] != now:
            self.fault(f"the table {name} is now\n{now}")
        self.text = self.text[:place.start()] + now + self.text[place.end():]

    def says(self, *sentences):
        """Reports a fault unless the page has these sentences; line breaks do not matter."""
        for sentence in sentences:
            if " ".join(sentence.split()) not in " ".join(self.text.split()):
                self.fault(f"it must say: {sentence}")

    def requires(self, holds, claim):
        """Reports a fault unless `holds` is true. `claim` is the statement in the page that depends on it."""
        if not holds:
            self.fault(f"it no longer holds that {claim}")

    def picture(self, figure, file):
        """Saves a figure in docs/pictures."""
        with tempfile.TemporaryDirectory() as folder:
            save(figure, Path(folder) / file)
            plt.close(figure)
            self.take(Path(folder) / file)

    def take(self, drawn):
        """Copies a picture that was drawn elsewhere into docs/pictures."""
        there = DOCS / "pictures" / drawn.name
        if f"](pictures/{drawn.name})" not in self.text:
            self.fault(f"it does not show pictures/{drawn.name}")
        if not self.is_check:
            there.write_bytes(drawn.read_bytes())
        elif not looks_alike(drawn, there):
            self.fault(f"pictures/{drawn.name} looks different now")

    def finish(self):
        if not self.is_check:
            self.path.write_text(self.text)
        sys.exit(1 if self.faults else 0)
