"""Writes the table of js/README.md: time and memory of the npm package beside the native program, and sizes.

    CHRONORMAL_DATA=FOLDER npm.py PROGRAM PACKAGE TARBALL README

Each is a process of its own, and its time is that of all processors together, start included: the package has one
thread, the program one for each processor.
"""

import gzip
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

DATA = pathlib.Path(os.environ["CHRONORMAL_DATA"])
SUZANNE = DATA / "rigs/blender_suzanne_two_keys.glb"
STRESS = DATA / "gltf/MorphStressTest/glTF/MorphStressTest.gltf"
DANCE = DATA / "sequences/rumba_13"
FACE = DATA / "rigs/ict_capture.glb"
OUT = ["-o", "out.glb"]

# What is measured: its words, the arguments, and how often; the least time counts.
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


def peak_memory(process, peak):
    """Looks at the most memory that a process has used, until it has ended. (What wait4() says begins with our own.)"""
    while True:
        try:
            found = re.search(r"VmHWM:\s+(\d+) kB", pathlib.Path(f"/proc/{process.pid}/status").read_text())
        except OSError:
            return
        if not found:
            return
        peak[0] = max(peak[0], int(found[1]) * 1024)
        time.sleep(0.02)


def measured(command, folder):
    """Seconds of all processors and bytes of memory at most that a command takes."""
    peak = [0]
    child = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    watcher = threading.Thread(target=peak_memory, args=(child, peak))
    watcher.start()
    _, status, used = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    watcher.join()
    if child.returncode != 0:
        raise SystemExit(f"{command}: exit code {child.returncode}")
    return used.ru_utime + used.ru_stime, peak[0]


def least(command, times):
    results = []
    for _ in range(times):
        with tempfile.TemporaryDirectory() as folder:
            results.append(measured(command, folder))
    return min(seconds for seconds, _ in results), max(memory for _, memory in results)


def seconds_text(seconds):
    return f"{seconds:.2f}" if seconds < 10 else f"{seconds:.0f}"


def main():
    program, package, tarball, readme = (pathlib.Path(word).resolve() for word in sys.argv[1:])
    script = package / "bin/chronormal.js"
    rows = []
    for words, arguments, times in CASES:
        native = least([program, *arguments], times)
        wasm = least(["node", script, *arguments], times)
        rows.append((words, seconds_text(native[0]), seconds_text(wasm[0]), f"{wasm[0] / native[0]:.1f}",
                     f"{native[1] / 1e6:.0f}", f"{wasm[1] / 1e6:.0f}"))
        print(*rows[-1], sep=" | ", flush=True)
    module = (package / "src/program.wasm").read_bytes()
    node = subprocess.run(["node", "--version"], capture_output=True, text=True, check=True).stdout.strip()
    lines = [
        f"The module is {len(module) / 1e6:.2f} MB, {len(gzip.compress(module, 9)) / 1e6:.2f} MB when gzipped; the package, with its",
        f"picture, {tarball.stat().st_size / 1e6:.2f} MB. Seconds are those of all processors together, start included, by Node.js {node}; MB are",
        "the most that was used.",
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
