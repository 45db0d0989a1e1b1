"""Times normals by the package, and by NumPy that recomputes them from positions. Both are verified before they are
timed.

    PYTHONPATH=build/release/python python3 tools/pages/python_bench.py [--faces 1000000]
"""

import argparse
import time

import numpy as np

import chronormal as cn


def sheet(faces):
    """Returns a square sheet of about `faces` triangles with a wave that runs through it: (p0, p1, faces)."""
    side = int(np.sqrt(faces / 2))
    y, x = np.divmod(np.arange((side + 1) ** 2), side + 1)
    x, y = x / side, y / side
    p0 = np.stack([x, y, 0.1 * np.sin(9 * x)], axis=1).astype(np.float32)
    p1 = np.stack([x + 0.05 * y, y, 0.1 * np.sin(9 * x + 3 * y)], axis=1).astype(np.float32)
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).reshape(-1)
    quads = np.stack([first, first + 1, first + side + 2, first + side + 1], axis=1)
    return p0, p1, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32)


def recompute(p0, p1, faces, t, add):
    """Computes vertex normals at t as NumPy users usually do."""
    p = (1 - t) * p0 + t * p1
    a, b, c = (p[faces[:, i]] for i in range(3))
    normals = add(faces, np.cross(b - a, c - a), len(p))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return normals


def add_at(faces, normals, count):
    sums = np.zeros((count, 3), dtype=normals.dtype)
    for corner in range(3):
        np.add.at(sums, faces[:, corner], normals)
    return sums


def add_by_bincount(faces, normals, count):
    corners, weights = faces.reshape(-1), np.repeat(normals, 3, axis=0)
    return np.stack([np.bincount(corners, weights[:, i], count) for i in range(3)], axis=1)


def seconds(work, repeats):
    """Returns the fastest and the median time of some runs, in seconds, after one run that warms up the caches."""
    work()
    times = [time.perf_counter()]
    for _ in range(repeats):
        work()
        times.append(time.perf_counter())
    return np.diff(times).min(), np.median(np.diff(times))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--faces", type=int, default=1_000_000)
    p0, p1, faces = sheet(parser.parse_args().faces)
    t, start = np.float32(0.3), time.perf_counter()
    curves = cn.curves(p0, p1, faces, weld=False, threads=1)
    prepare, out = time.perf_counter() - start, np.empty_like(p0)
    truth = recompute(p0.astype(np.float64), p1.astype(np.float64), faces, np.float64(t), add_by_bincount)
    rows = {"NumPy, np.add.at": (lambda: recompute(p0, p1, faces, t, add_at), 5),
            "NumPy, np.bincount": (lambda: recompute(p0, p1, faces, t, add_by_bincount), 15),
            "curves.unit_normals": (lambda: curves.unit_normals(t, out=out), 201),
            "the same, all cores": (lambda: curves.unit_normals(t, out=out, threads=0), 201)}
    for name, (work, _) in rows.items():
        worst = np.abs(work() - truth).max()
        assert worst < 1e-3, f"{name} is off by {worst}"
    measured = {name: seconds(*row) for name, row in rows.items()}
    baseline = min(fastest for name, (fastest, _) in measured.items() if "NumPy" in name)
    print(f"{len(faces):,} faces, {len(p0):,} vertices; prepared once in {1e3 * prepare:.0f} ms, {curves.bytes / 1e6:.1f} MB\n")
    print("| normals of all vertices | fastest, ms | median, ms | times NumPy |\n|---|---|---|---|")
    for name, (fastest, median) in measured.items():
        print(f"| {name} | {1e3 * fastest:.2f} | {1e3 * median:.2f} | {baseline / fastest:.1f} |")

    ring, small = np.arange(16), np.random.default_rng(1).random((16, 3), dtype=np.float32)
    curves = cn.curves(small, 2 * small[::-1], np.stack([ring, (ring + 1) % 16, (ring + 5) % 16], axis=1))
    out, call = np.empty((16, 3), dtype=np.float32), curves.unit_normals
    fastest, median = seconds(lambda: [call(0.3, out) for _ in range(10_000)], 51)
    print(f"\na call for 16 vertices: {1e2 * fastest:.2f} microseconds, median {1e2 * median:.2f}")


if __name__ == "__main__":
    main()
