"""Draws the pictures of docs/python.md with the code of that page."""

import os
import re
import tempfile
from pathlib import Path

from page import Page, plt


def main():
    page, names = Page("python"), {}
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        plt.rcdefaults()  # the style that matplotlib has for a reader by default
        for block in re.findall(r"^```python\n(.*?)^```$", page.text, re.M | re.S):
            exec(compile(block, "docs/python.md", "exec"), names)
        drawn = sorted(Path(folder).glob("*.png"))
        page.requires(len(drawn) == 3, "its code draws three pictures")
        for picture in drawn:
            page.take(picture)
        os.chdir("/")
    page.finish()


if __name__ == "__main__":
    main()
