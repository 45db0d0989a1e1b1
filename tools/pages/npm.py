"""Writes the table of js/README.md: time and memory of the npm package beside the native program, and sizes.

    CHRONORMAL_DATA=FOLDER npm.py PROGRAM PACKAGE TARBALL README

Each measurement runs in a process of its own. Its time is the sum over all processors, including the start, since the
package has one thread and the program has one for each processor.
"""

import gzip
import os
import pathlib
import subprocess
import sys
import tempfile

DATA = pathlib.Path(os.environ["CHRONORMAL_DATA"])
SUZANNE, FACE = DATA / "rigs/blender_suzanne_two_keys.glb", DATA / "rigs/ict_capture.glb"
STRESS, DANCE = DATA / "gltf/MorphStressTest/glTF/MorphStressTest.gltf", DATA / "sequences/rumba_13"
OUT = ["-o", "out.glb"]

# The calls that are measured: their name, their arguments, and the number of runs, of which the fastest counts.
CASES = [
    ("`--version`: the start alone", ["--version"], 5),
    ("`audit` of MorphStressTest", ["audit", STRESS], 3),
    ("`bake` of MorphStressTest", ["bake", STRESS, *OUT], 3),
    ("`audit` of a head of 15,744 triangles", ["audit", SUZANNE], 2),
    ("`bake` of it", ["bake", SUZANNE, *OUT], 1),
    ("`bake` of it, `--encode exact`", ["bake", SUZANNE, "--encode", "exact", *OUT], 2),
    ("`bake` of a dance: 13 keyframes, 25,472 triangles", ["bake", DANCE, *OUT], 2),
    ("`audit` of a captured face: 57 targets, 52,220 triangles", ["audit", FACE], 1),
]


# The command is started from this small process, because a process also counts the memory that its parent had at the
# fork.
MEASURE = """
import os, sys
nothing = os.open(os.devnull, os.O_WRONLY)
quiet = [(os.POSIX_SPAWN_DUP2, nothing, 1), (os.POSIX_SPAWN_DUP2, nothing, 2)]
_, status, used = os.wait4(os.posix_spawnp(sys.argv[1], sys.argv[1:], os.environ, file_actions=quiet), 0)
if status: sys.exit(f"{sys.argv[1:]} ended with {status}")
print(used.ru_utime + used.ru_stime, 1024 * used.ru_maxrss)
"""


def measured(command, folder):
    """Returns the seconds that a command takes, summed over all processors, and its largest memory in bytes."""
    words = [sys.executable, "-S", "-E", "-c", MEASURE, *map(str, command)]
    return [float(word) for word in subprocess.run(words, cwd=folder, check=True, capture_output=True, text=True).stdout.split()]


def least(command, times):
    results = []
    for _ in range(times):
        with tempfile.TemporaryDirectory() as folder:
            results.append(measured(command, folder))
    return min(seconds for seconds, _ in results), max(memory for _, memory in results)


def main():
    program, package, tarball, readme = (pathlib.Path(word).resolve() for word in sys.argv[1:])
    script = package / "bin/chronormal.js"
    rows = []
    for words, arguments, times in CASES:
        native = least([program, *arguments], times)
        wasm = least(["node", script, *arguments], times)
        seconds = [f"{value:.2f}" if value < 10 else f"{value:.0f}" for value in (native[0], wasm[0])]
        rows.append((words, *seconds, f"{wasm[0] / native[0]:.1f}",
                     f"{native[1] / 1e6:.0f}", f"{wasm[1] / 1e6:.0f}"))
        print(*rows[-1], sep=" | ", flush=True)
    module = (package / "src/program.wasm").read_bytes()
    node = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True).stdout.strip()
    lines = [
        f"The module is {len(module) / 1e6:.2f} MB, {len(gzip.compress(module, 9)) / 1e6:.2f} MB when gzipped. The package, with its",
        f"picture, is {tarball.stat().st_size / 1e6:.2f} MB. Seconds are processor time on all cores, start included, with Node.js {node}. MB are",
        "the largest amount of memory in use.",
        "",
        "| what | program: seconds | package: seconds | times | program: MB | package: MB |",
        "|---|---|---|---|---|---|",
        *("| " + " | ".join(row) + " |" for row in rows),
    ]
    begin, end = "<!-- figures -->\n", "<!-- end of figures -->"
    text = readme.read_text()
    before, after = text.split(begin)[0], text.split(end)[1]
    readme.write_text(before + begin + "\n".join(lines) + "\n" + end + after)


main()
