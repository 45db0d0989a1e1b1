"""Measures the program on ranks of MPI, and prints the tables of docs/scale.md, section MPI: the processor time of the rank
that takes most, of all ranks together, and the memory of the largest rank, by ranks and frames.

    tools/scale/ranks.py PROGRAM [FRAMES...]      PROGRAM was built with MPI; needs NumPy; frames: 60 240 960

Every rank has one thread, so that the processor time of the slowest rank is what a clock would show where each rank has a
processor of its own, whatever else this machine does."""

import os
import resource
import subprocess
import sys
import tempfile

SIDE = 320
COMMANDS = {"compare --schemes linear,quadratic --samples 3": "-o {}.json --json --no-times",
            "audit --samples 5": "-o {}.json --json", "sample --times keys": "-o {}.npy"}
RANKS = (1, 2, 3, 4)


def write_input(frames):
    """A sheet of SIDE x SIDE vertices that waves."""
    import numpy as np  # not in ranks, whose memory it would be
    y, x = np.mgrid[0:SIDE, 0:SIDE].astype(np.float32)
    corner = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
    faces = np.concatenate([np.stack([corner, corner + 1, corner + SIDE + 1], 1),
                            np.stack([corner, corner + SIDE + 1, corner + SIDE], 1)])
    with open("sheet.obj", "w") as file:
        np.savetxt(file, np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1), "v %g %g %g")
        np.savetxt(file, faces + 1, "f %d %d %d")
    with open("sheet.pc2", "wb") as file:
        file.write(b"POINTCACHE2\0" + np.array([1, SIDE * SIDE], "<i4").tobytes() + np.array([0, 1], "<f4").tobytes()
                   + np.array([frames], "<i4").tobytes())
        for k in range(frames):
            z = 2 * np.sin(0.7 * k + 0.1 * x + 0.05 * y)
            file.write(np.stack([x + 0.3 * np.sin(k + 0.5 * y), y, z], -1).astype("<f4").tobytes())


def measure_rank(command):
    """Runs a rank on one processor, and writes what it took where the run collects it."""
    rank = os.environ["OMPI_COMM_WORLD_RANK"]
    os.sched_setaffinity(0, {int(rank) % os.cpu_count()})
    code = subprocess.run(command).returncode
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(f"rank_{rank}", "w") as file:
        file.write(f"{used.ru_utime + used.ru_stime} {used.ru_maxrss}")
    return code


def run(program, command, ranks):
    """Returns (seconds of the slowest rank, seconds of all, MB of the largest), and checks the bytes."""
    name, options = command
    words = name.split()
    arguments = words[:1] + ["sheet.obj", "sheet.pc2"] + words[1:] + ["--force", "--quiet"]
    files = [arguments + options.format(stem).split() for stem in ("alone", "ranks")]
    if ranks == 1:
        subprocess.run([program] + files[0], check=True)
    mpirun = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-n", str(ranks)]
    subprocess.run(mpirun + [sys.executable, os.path.abspath(__file__), "--rank", program] + files[1], check=True)
    stem = options.split()[1]
    subprocess.run(["cmp", stem.format("alone"), stem.format("ranks")], check=True)
    used = [[float(number) for number in open(f"rank_{rank}").read().split()] for rank in range(ranks)]
    return max(u[0] for u in used), sum(u[0] for u in used), max(u[1] for u in used) * 1024 / 1e6


def main():
    program = os.path.abspath(sys.argv[1])
    frames = [int(word) for word in sys.argv[2:]] or [60, 240, 960]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        print("| frames | command | ranks | slowest rank, s | all ranks, s | largest rank, MB |")
        print("|---|---|---|---|---|---|")
        for count in frames:
            write_input(count)
            for command in COMMANDS.items():
                for ranks in RANKS:
                    slowest, everyone, memory = run(program, command, ranks)
                    print(f"| {count:,} | `{command[0]}` | {ranks} | {slowest:.1f} | {everyone:.1f} | {memory:.0f} |", flush=True)
        os.chdir("/")


if __name__ == "__main__":
    __file__ = os.path.abspath(__file__)
    sys.exit(measure_rank(sys.argv[2:]) if sys.argv[1] == "--rank" else main())
