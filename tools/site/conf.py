"""Configures Sphinx for the site (tools/site/make), which shows the pages of the repository as they are, with a
navigation.

The source folder is the repository itself, so that links between pages, and from pages to files, mean what they mean
there.
"""

import re
from pathlib import Path

import furo

ROOT = Path(__file__).resolve().parents[2]

project = "chronormal"
copyright = "the chronormal authors, MIT licence"
version = release = re.search(r"project\(chronormal VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)

extensions = ["myst_parser"]
root_doc = "README"
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "js/README.md", "packaging/README.md",
                    "docs/**.md"]
myst_heading_anchors = 4
highlight_language = "none"
# The theme is furo, a package of Debian. The theme is dark or light, works on phones, and its search needs no server.
# In Debian's style sheet, only a button makes pages dark, because sassc dropped the rules for systems that are set to
# dark. The lines below pass the dark colours to the theme once more.
html_theme = "furo"
STYLES = (Path(furo.__file__).parent / "theme/furo/static/styles/furo.css").read_text()
DARK = STYLES[STYLES.index('body[data-theme="dark"] {'):STYLES.index(".only-light {\n      display")]
html_theme_options = {"dark_css_variables": dict(re.findall(r"--([\w-]+): ([^;]+);", DARK))}
html_title = f"chronormal {version}"
templates_path = ["templates"]
SIDEBAR = ("brand", "search", "scroll-start", "navigation")
html_sidebars = {"**": [*(f"sidebar/{part}.html" for part in SIDEBAR), "api.html", "sidebar/scroll-end.html"]}
pygments_style = "default"
html_copy_source = html_show_sourcelink = False
html_show_sphinx = False

# The groups of the navigation. The group Results also gets all pages of docs/ that are in no other group.
GROUPS = {
    "Getting started": ["docs/artists", "docs/web", "docs/simulation", "docs/cpp", "docs/python"],
    "Reference": ["docs/cli", "docs/formats", "docs/stability", "The npm package <js/README>"],
    "Results": [],
    "Theory and code": ["docs/theory", "docs/architecture", "docs/decisions/README"],
    "Project": ["CONTRIBUTING", "packaging/README", "SECURITY", "CHANGELOG"],
}


def navigation():
    """Returns the tables of contents as text. The tables are hidden at the end of the first page."""
    placed = {page for pages in GROUPS.values() for page in pages}
    pages = [f"docs/{path.stem}" for path in sorted((ROOT / "docs").glob("*.md"))]
    groups = GROUPS | {"Results": [page for page in pages if page not in placed]}
    tables = []
    for caption, entries in groups.items():
        tables.append("\n".join(["```{toctree}", ":hidden:", f":caption: {caption}", "", *entries, "```"]))
    return "\n\n".join(tables)


def add_navigation(app, page, source):
    if page == root_doc:
        source[0] += "\n\n" + navigation() + "\n"
    elif page == "docs/decisions/README":
        entries = sorted(path.stem for path in (ROOT / "docs/decisions").glob("0*.md"))
        source[0] += "\n\n" + "\n".join(["```{toctree}", ":hidden:", "", *entries, "```"]) + "\n"


def setup(app):
    app.connect("source-read", add_navigation)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
