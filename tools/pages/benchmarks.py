"""Makes the tables and pictures of docs/benchmarks.md from bench/results/*.json, which `./run bench --json` measured.

If a run lacks a row, the script ends with a KeyError, so that a missing baseline is noticed.
"""

import json
import math

from page import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, RED, ROOT, SKY, Page, grouped, percent, plt, scientific

RESULTS = ROOT / "bench" / "results"
MAIN = "epyc-zen4-2cores"


class Run:
    """The results that were measured on one machine."""

    def __init__(self, name):
        self.data = json.loads((RESULTS / f"{name}.json").read_text())
        self.rows = {(r["group"], r["name"], r["size"], r["order"]): r for r in self.data["rows"]}

    def ns(self, group, name, size="45k", order="grid"):
        return self.rows[group, name, size, order]["median_ns"]


def text(ns):
    return f"{ns:.2f}" if ns < 10 else grouped(ns)


SIZES = [("45k", "grid"), ("1M", "grid"), ("10M", "shuffled")]
LIBRARIES = {"plain C++ loop": ("plain C++ loop",) * 2, "Eigen": ("Eigen loop",) * 2,
             "CGAL": ("CGAL compute_face_normals", "CGAL compute_vertex_normals"),
             "OpenMesh": ("OpenMesh update_face_normals", "OpenMesh calc_vertex_normal_correct"),
             "VTK": ("VTK vtkPolyDataNormals", "VTK vtkTriangleMeshPointNormals")}
OURS = {"recompute in float32": "recompute in float32", "recompute": "recompute", "prepare exact curves": "prepare exact",
        "evaluate exact curves": "exact to float3", "prepare compact curves": "prepare compact", "evaluate compact curves": "compact to float3",
        "(a loop that only moves as many bytes)": "bare loop as exact"}


def normals(page, run):
    rows = []
    for title, names in (LIBRARIES | {title: (name,) * 2 for title, name in OURS.items()}).items():
        cells = []
        for group, name in zip(("faces", "vertices"), names):
            for size, order in SIZES:
                # Measuring this row would take minutes, so it is left out.
                missing = name.startswith("CGAL") and group == "vertices" and order == "shuffled"
                cells.append("-" if missing else text(run.ns(group, name, size, order)))
        rows.append([title, *cells])
    sizes = ["45 k", "1 M", "10 M shuffled"]
    page.table("normals", ["ns per element", *(f"{of}, {size}" for of in ("faces", "vertices") for size in sizes)], rows)
    spreads = sorted(row["spread"] for row in run.rows.values())
    page.says(f"{percent(spreads[len(spreads) // 2], 1)} of the median for half of all rows")


def machines(page):
    rows = []
    for name in sorted(file.stem for file in RESULTS.glob("*.json")):
        run = Run(name)
        machine = run.data["machine"]
        cells = [run.ns("vertices", row, "1M") if ("vertices", row, "1M", "grid") in run.rows else None
                 for row in ("plain C++ loop", "recompute in float32", "recompute", "prepare exact", "exact to float3", "compact to float3")]
        title = f"{name} ({machine['instruction_set'].replace('AVX3', 'AVX-512')}), {machine['date']}"
        rows.append([title, *("-" if c is None else text(c) for c in cells)])
    page.table("machines", ["ns per vertex, 1 M", "plain loop", "recompute in float32", "recompute", "prepare exact", "exact", "compact"],
               rows)


def frames(page, run):
    """Writes a table of break-even points. A break-even point is the smallest number of frames per segment for which
    preparing curves takes less time than computing the normals anew in each frame."""
    def cell(group, size, curves, anew):
        saved = run.ns(group, anew, size) - run.ns(group, f"{curves} to float3", size)
        return "never" if saved <= 0 else str(math.ceil(run.ns(group, f"prepare {curves}", size) / saved))
    meshes = {"grid, 45 k": ("vertices", "45k"),
              **{name: ("vertices of meshes", name) for name in ("thin", "varied", "dance", "face", "eversion")}}
    ways_of = [(curves, anew) for anew in ("recompute", "recompute in float32") for curves in ("exact", "compact")]
    page.table("frames", ["curves win from frame", *(f"{curves}, against {anew.replace('recompute in ', '')}" for curves, anew in ways_of)],
               [[title, *(cell(*place, *way) for way in ways_of)] for title, place in meshes.items()])


def memory(page, run):
    found = {(a["path"], a["mesh"]): a for a in run.data["accuracies"] if a["of"] == "vertices"}
    rows = []
    for title, path in (("exact (1e-6)", "exact to float3"), ("compact (1e-3)", "compact 0.001 to float3"), ("tolerance 1e-2", "compact 0.01 to float3"),
                        ("exact, octahedral results", "exact to octahedral"), ("exact, rgb10a2 results", "exact to rgb10a2")):
        grid, eversion = found[path, "grid"], found[path, "eversion"]
        rows.append([title, f"{grid['bytes']:.0f}", f"{eversion['bytes']:.0f}", scientific(grid["bound_rad"], 1),
                     scientific(grid["mean_rad"]), scientific(max(grid["max_rad"], eversion["max_rad"]), 1)])
    page.table("memory", ["curves of a vertex", "bytes", "bytes, eversion", "promised error", "average error", "worst error"], rows)


def ways(page, run):
    names = {"one t, float3": "exact to float3", "one t, three planes": "exact to planes", "one t, octahedral (4 bytes)": "exact to octahedral",
             "one t, rgb10a2 (4 bytes)": "exact to rgb10a2", "8 t in one pass, per t": "exact to float3, 8 t", "one t, two threads": "exact to float3, 2 threads", "prepare, two threads": "prepare exact, 2 threads"}
    two_sizes(page, run, "ways", "ns per vertex, exact curves", "vertices", names)


def two_sizes(page, run, place, head, group, names):
    page.table(place, [head, "45 k", "1 M"], [[title, *(text(run.ns(group, name, size)) for size in ("45k", "1M"))] for title, name in names.items()])


def schemes(page, run):
    rows = []
    for quality in run.data["qualities"]:
        name = quality["scheme"]
        if quality["mesh"] == "twist" and ("schemes", name, "45k", "grid") in run.rows:
            error = lambda v: f"{v:.3f}" if v >= 1e-3 else scientific(v)  # noqa: E731
            rows.append([f"`{name}`", text(run.ns("schemes", name)), f"{quality['bytes']:.0f}", error(quality["mean_degrees"]), error(quality["max_degrees"])])
    page.table("schemes", ["scheme", "ns", "bytes", "average error, degrees", "worst"], rows)


def blends(page, run):
    ways_of = ["chosen", "chosen in float32", "recompute in float32", "recompute", "plain C++ loop", "linear sum"]
    rows = [[f"{active} of {of}" + (", dense" if of == 5 else ""),
             *(text(run.ns("blend" if of == 100 else "dense blend", f"{active} of {of}: {way}")) for way in ways_of)]
            for active, of in ((1, 100), (4, 100), (16, 100), (52, 100), (100, 100), (1, 5), (5, 5))]
    page.table("blends", ["active targets", "`MeshNormals`", "in float32", *ways_of[2:]], rows)


def commands(page):
    data = json.loads((RESULTS / "commands" / f"{MAIN}.json").read_text())
    rows = []
    for source in data["inputs"]:
        by_name = {row["name"]: row for row in source["rows"]}
        reading = by_name["reading it as a motion"]["cpu_s"]
        for name, row in by_name.items():
            if name not in ("memcpy, with its memory", "a copy of what bake wrote"):
                title = f"{source['title'].split(',')[0]}, {source['bytes'] / 1e6:,.0f} MB: {name}"
                rows.append([title, f"{row['wall_s']:.2f}", f"{row['cpu_s']:.2f}", f"{row['cpu_s'] / reading:.1f}"])
    page.table("commands", ["command", "seconds", "of processors", "times reading"], rows)


def draw(page, run):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
    lines = {"VTK": (PURPLE, "v"), "CGAL": (ORANGE, "s"), "OpenMesh": (SKY, "D"), "Eigen": (GREY, "x"),
             "plain C++ loop": (BLACK, "^"), "recompute": (RED, "s"), "recompute in float32": (RED, "o"), "evaluate exact curves": (BLUE, "o"), "evaluate compact curves": (GREEN, "D")}
    for title, (colour, mark) in lines.items():
        name = LIBRARIES[title][1] if title in LIBRARIES else OURS[title]
        points = [run.rows["vertices", name, size, "grid"] for size in ("15k", "45k", "1M", "10M")]
        left.plot([p["elements"] for p in points], [p["median_ns"] for p in points], mark + "-", color=colour, ms=4, label=title,
                  fillstyle="none" if title == "recompute in float32" else "full")
    left.set(title="a vertex normal at one t", xlabel="vertices", ylabel="nanoseconds", xscale="log", yscale="log", ylim=(0.3, 2e4))
    left.legend(ncol=2, loc="upper left")
    shown = range(1, 31)
    for title, name, prepare, colour in (("plain C++ loop", "plain C++ loop", None, BLACK), ("recompute", "recompute", None, RED),
                                         ("recompute in float32", "recompute in float32", None, ORANGE),
                                         ("exact curves", "exact to float3", "prepare exact", BLUE),
                                         ("compact curves", "compact to float3", "prepare compact", GREEN)):
        once = run.ns("vertices", prepare) if prepare else 0
        right.plot(shown, [run.ns("vertices", name) + once / k for k in shown], color=colour, label=title)
    right.set(title="a vertex and frame, 45 k vertices, preparation included", xlabel="frames of a segment", ylim=(0, 22), xlim=(1, 30))
    right.legend()
    page.picture(figure, "benchmarks.svg")


def main():
    page, run = Page("benchmarks"), Run(MAIN)
    for measure in (normals, frames, memory, ways, schemes, blends, draw):
        measure(page, run)
    machines(page)
    commands(page)
    page.finish()


if __name__ == "__main__":
    main()
