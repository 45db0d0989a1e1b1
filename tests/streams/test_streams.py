"""Tests the memory of commands that read a sequence one keyframe at a time. The memory must not grow with the number of
keyframes."""

import os
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

PROGRAM = os.environ["CHRONORMAL_PROGRAM"]
SIDE = 320  # vertices along a side of the sheet; a keyframe then has 1.2 MB
COMMANDS = {
    "sample": ["--times", "0:0.23:23", "--format", "npy"],
    "compare": ["--schemes", "linear", "--samples", "2"],
    "audit": ["--samples", "2"],
    "inspect": [],
}
# A small process starts the command, since at a fork the memory of the parent also counts for the child.
MEASURE = """
import os, sys
nothing = os.open(os.devnull, os.O_WRONLY)
child = os.posix_spawnp(sys.argv[1], sys.argv[1:], os.environ, file_actions=[(os.POSIX_SPAWN_DUP2, nothing, 1)])
_, status, usage = os.wait4(child, 0)
if status: sys.exit(f"{sys.argv[1:]} ended with {status}")
print(usage.ru_maxrss)
"""


def write_sheet(folder, frames):
    """Writes a sheet over which waves run: an OBJ file, and a PC2 file with one keyframe per second."""
    x, y = np.meshgrid(np.linspace(0, 10, SIDE), np.linspace(0, 10, SIDE), indexing="ij")
    corner = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel() + 1
    faces = np.concatenate([np.stack([corner, corner + SIDE, corner + 1], 1), np.stack([corner + 1, corner + SIDE, corner + SIDE + 1], 1)])
    with (folder / "sheet.obj").open("w") as out:
        np.savetxt(out, np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1), "v %g %g %g")
        np.savetxt(out, faces, "f %d %d %d")
    with (folder / f"{frames}.pc2").open("wb") as out:
        out.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, SIDE * SIDE, 0, 1, frames))
        for k in range(frames):
            sways = x + 0.3 * np.sin(y + 0.33 * k), y + 0.3 * np.cos(x + 0.22 * k), np.sin(1.3 * x + 0.4 * y + 0.11 * k)
            out.write(np.stack(sways, -1).astype("<f4").tobytes())


class Streams(unittest.TestCase):
    def test_memory_does_not_grow_with_the_number_of_keyframes(self):
        few, many = 80, 320  # numbers of keyframes: 98 MB and 393 MB, since 64 MiB may stay in memory
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for frames in (few, many):
                write_sheet(folder, frames)
            for command, options in COMMANDS.items():
                megabytes = {}
                for frames in (few, many):
                    out = folder / "out"
                    words = [PROGRAM, command, folder / "sheet.obj", folder / f"{frames}.pc2", "--quiet", *options, "-o", out]
                    found = subprocess.run([sys.executable, "-S", "-E", "-c", MEASURE, *map(str, words)], check=True, stdout=subprocess.PIPE)
                    megabytes[frames] = int(found.stdout) / 1000
                    out.unlink()
                print(command, megabytes)
                with self.subTest(command):
                    self.assertLess(megabytes[many], megabytes[few] + 16)


if __name__ == "__main__":
    unittest.main()
