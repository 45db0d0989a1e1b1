"""Measures the figures of docs/scale.md: time and memory of commands on sequences that are larger than the memory they may
take, and a picture of memory over the number of frames.

    scale.py               measures, and writes the tables between <!-- NAME --> and <!-- end --> and the picture
    scale.py --large GB    also writes a sequence of so many GB, and measures that; without it, its table stays
    scale.py --check       measures the tables but the large one, and ends with 1 where memory is more than the page says

Sequences are made on the spot, under --folder DIR or TMPDIR, and removed.
"""

import argparse
import pathlib
import struct
import subprocess
import sys
import tempfile

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = ROOT / "build/release/chronormal"
PAGE, PICTURE = ROOT / "docs/scale.md", ROOT / "docs/pictures/scale_memory.png"
BAKED, SMALL, WIDE = 224, 320, 1136  # vertices along a side: 50,176, 102,400 and 1,290,496 in all
MB = 1e6


def make_sheet(folder, side, frames, sways=False):
    """A square sheet with waves that run over it, as an OBJ file and so many frames of PC2, a frame a second. Where it sways, its
    vertices move sideways, too, so that their normals bend between the frames."""
    mesh, cache = folder / f"sheet_{side}.obj", folder / f"sheet_{side}_{frames}.pc2"
    x, y = np.meshgrid(np.linspace(0, 10, side), np.linspace(0, 10, side), indexing="ij")
    positions = np.empty((side * side, 3), "<f4")
    positions[:, 0], positions[:, 1] = x.ravel(), y.ravel()
    shape, slope = np.sin(1.3 * x + 0.4 * y).ravel(), np.cos(1.3 * x + 0.4 * y).ravel()
    with cache.open("wb") as out:
        out.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, side * side, 0, 1, frames))
        for frame in range(frames):
            angle = 0.11 * frame
            if sways:
                positions[:, 0] = (x + 0.3 * np.sin(y + 3 * angle)).ravel()
                positions[:, 1] = (y + 0.3 * np.cos(x + 2 * angle)).ravel()
            positions[:, 2] = np.cos(angle) * shape + np.sin(angle) * slope
            out.write(positions.tobytes())
    if not mesh.exists():
        corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)[None, :] + 1).ravel()
        with mesh.open("w") as out:
            for x_i, y_i, z_i in positions:
                out.write(f"v {x_i:.6g} {y_i:.6g} {z_i:.6g}\n")
            for a in corner:
                out.write(f"f {a} {a + side} {a + 1}\nf {a + 1} {a + side} {a + side + 1}\n")
    return mesh, cache


# A process of its own starts the command, since a process counts the memory of the one that it was forked from as its own.
MEASURE = """
import os, resource, sys, time
limit = int(sys.argv[1])
if limit: resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
begin = time.time()
nothing = os.open(os.devnull, os.O_WRONLY)
child = os.posix_spawnp(sys.argv[2], sys.argv[2:], os.environ, file_actions=[(os.POSIX_SPAWN_DUP2, nothing, 1)])
_, status, usage = os.wait4(child, 0)
if status: sys.exit(f"{sys.argv[2:]} ended with {status}")
print(time.time() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss)
"""


def measure(command, address_space=0):
    """Seconds by the clock, seconds of processors, and the peak of memory in MB, of a command that must succeed."""
    words = [sys.executable, "-S", "-E", "-c", MEASURE, str(address_space), *(str(word) for word in command)]
    out = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout
    clock, processor, kibibytes = (float(word) for word in out.split())
    return clock, processor, kibibytes * 1024 / MB


def run(folder, words, mesh, cache, address_space=0):
    """Runs a command of the program, with OUT in the folder where it has one, and removes that."""
    out = folder / ("out.glb" if words[0] == "bake" else "out")
    command = [PROGRAM, words[0], mesh, cache, "--quiet", *words[1:]]
    found = measure([*command, "-o", out], address_space)
    size = out.stat().st_size / MB
    out.unlink()
    return (*found, size)


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|---|" + "---|" * (len(head) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def seconds(value):
    return f"{value:.1f}" if value < 10 else f"{value:.0f}"


COMMANDS = {
    "`sample --times 11.5`": ["sample", "--times", "11.5", "--format", "npy"],
    "`sample --times keys` (24 times, 372 MB of normals)": ["sample", "--times", "keys", "--format", "npy"],
    "`sample --times keys --resume`": ["sample", "--times", "keys", "--format", "npy", "--resume"],
    "`audit --samples 5`": ["audit", "--samples", "5"],
    "`inspect`": ["inspect"],
    "`compare --schemes linear,quadratic --samples 3`": ["compare", "--schemes", "linear,quadratic", "--samples", "3"],
}


def commands(folder):
    """The table of commands on a sheet of 1.29 million vertices, under a limit of their address space."""
    mesh, cache = make_sheet(folder, WIDE, 24)
    rows = []
    for title, words in COMMANDS.items():
        _, processor, memory, _ = run(folder, words, mesh, cache, 1000 * 1000 * 1000)
        rows.append([title, seconds(processor), f"{memory:.0f}"])
    cache.unlink()
    return table(["command", "processor, s", "memory, MB"], rows)


FRAMES = [24, 80, 240, 800, 2400]
OVER_FRAMES = {
    "sample": ["sample", "--times", "0:0.23:23", "--format", "npy"],
    "compare": ["compare", "--schemes", "linear", "--samples", "2"],
    "audit": ["audit", "--samples", "2"],
}


def over_frames(folder, is_check):
    """The table and the picture of memory over the number of frames, for a sheet of 102,400 vertices."""
    memory = {name: [] for name in OVER_FRAMES}
    for frames in FRAMES:
        mesh, cache = make_sheet(folder, SMALL, frames)
        for name, words in OVER_FRAMES.items():
            memory[name].append(run(folder, words, mesh, cache)[2])
        cache.unlink()
    if not is_check:
        figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
        sizes = [12 * SMALL * SMALL * frames / MB for frames in FRAMES]
        axes.plot(FRAMES, sizes, "--", color="0.6", label="the file")
        for name, values in memory.items():
            axes.plot(FRAMES, values, "o-", label=name)
        axes.set(xscale="log", yscale="log", xlabel="frames", ylabel="MB", title="Memory of a run")
        axes.legend()
        figure.savefig(PICTURE, dpi=120)
    rows = [[f"{frames:,}", f"{12 * SMALL * SMALL * frames / MB:,.0f}", *(f"{memory[name][i]:.0f}" for name in OVER_FRAMES)]
            for i, frames in enumerate(FRAMES)]
    return table(["frames", "file, MB", *(f"`{name}`, MB" for name in OVER_FRAMES)], rows)


def bakes(folder):
    """The table of bakes over the number of frames, under `ulimit -v 1000000`, for a sheet of 50,176 vertices."""
    rows = []
    for frames in [24, 240, 1000]:
        mesh, cache = make_sheet(folder, BAKED, frames, sways=True)
        _, processor, memory, size = run(folder, ["bake", "--encode", "exact", "--no-audit"], mesh, cache, 1000000 * 1024)
        rows.append([f"{frames:,}", f"{cache.stat().st_size / MB:,.0f}", f"{size:,.0f}", seconds(processor), f"{memory:.0f}"])
        cache.unlink()
    return table(["frames", "file, MB", "`.glb`, MB", "processor, s", "memory, MB"], rows)


def large(folder, gigabytes):
    """The table of one large sequence, under `ulimit -v 1000000`, beside cat."""
    frames = int(gigabytes * 1e9 / (12 * WIDE * WIDE))
    mesh, cache = make_sheet(folder, WIDE, frames)
    size = cache.stat().st_size / 1e9
    limit = 1000000 * 1024
    rows = []

    def add(title, found):
        clock, processor, memory = found[:3]
        print(title, found, flush=True)
        rows.append([title, seconds(clock), seconds(processor), f"{memory:.0f}"])

    add("`cat FILE >/dev/null`", measure(["cat", cache]))
    add("`cat FILE >COPY`", measure(["sh", "-c", f"cat {cache} >{folder / 'copy'}"]))
    (folder / "copy").unlink()
    add("`sample --times 0:7:LAST` (every 7th keyframe)", run(folder, ["sample", "--times", f"0:7:{frames - 1}", "--format", "npy"], mesh, cache, limit))
    add("`sample --times keys`", run(folder, ["sample", "--times", "keys", "--format", "npy"], mesh, cache, limit))
    add("`compare --schemes linear --samples 2`", run(folder, ["compare", "--schemes", "linear", "--samples", "2"], mesh, cache, limit))
    add("`audit --samples 2`", run(folder, ["audit", "--samples", "2"], mesh, cache, limit))
    cache.unlink()
    head = [f"{frames:,} frames, {size:.1f} GB", "clock, s", "processor, s", "memory, MB"]
    return table(head, rows)


def memory_of(text):
    """The last number of each row of a table, by its first cell."""
    rows = [row.strip("| ").split(" | ") for row in text.splitlines()[2:]]
    return {row[0]: [float(cell.replace(",", "")) for cell in row[1:]] for row in rows}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--large", type=float)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--folder")
    options = parser.parse_args()
    page = PAGE.read_text()
    with tempfile.TemporaryDirectory(dir=options.folder) as name:
        folder = pathlib.Path(name)
        tables = {}
        if options.large:
            tables["large"] = large(folder, options.large)
        tables["frames"] = over_frames(folder, options.check)
        tables["commands"] = commands(folder)
        tables["bakes"] = bakes(folder)
    more = 0
    for name, measured in tables.items():
        begin, end = f"<!-- {name} -->\n", "\n<!-- end -->"
        there = page.split(begin)[1].split(end)[0]
        page = page.replace(begin + there + end, begin + measured + end)
        if not options.check:
            continue
        before, now = memory_of(there), memory_of(measured)
        # Memory depends a little on how far threads are; a frame of the wide sheet has 15 MB.
        first = 2 if name == "frames" else -1
        for row, values in now.items():
            for was, found in zip(before.get(row, values)[first:], values[first:]):
                if found > 1.25 * was + 32:
                    print(f"{row} takes {found:.0f} MB, and {PAGE} says {was:.0f} MB: tools/make_scale measures it", file=sys.stderr)
                    more += 1
    if not options.check:
        PAGE.write_text(page)
    sys.exit(1 if more else 0)


if __name__ == "__main__":
    main()
