"""Tests curved paths: normals of their pieces against cross products on the curves, and reports against those of the
program.

CHRONORMAL_PROGRAM names the program; without it, tests that need it are skipped.
"""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import chronormal as cn
from meshes import QUADS, angle, face_normals, unit, vertex_normals

PROGRAM = os.environ.get("CHRONORMAL_PROGRAM")
FACES = np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])
TIMES = np.array([0, 0.5, 1.25, 2])


def turning_sheet():
    """Return keyframes (4, 12, 3) of a bent sheet that turns and swells."""
    random = np.random.default_rng(20261123)
    places = np.array([[x, y, 0] for y in range(3) for x in range(4)]) + 0.2 * random.standard_normal((12, 3))
    turned = [np.stack([np.cos(t) * places[:, 0] + np.sin(t) * places[:, 2], (1 + 0.2 * t) * places[:, 1],
                        np.cos(t) * places[:, 2] - np.sin(t) * places[:, 0]], axis=1) for t in TIMES]
    return np.array(turned, dtype=np.float32)


def slopes(keys):
    """Return the velocity at each keyframe, per second: the slope of the polynomial through the keyframe and its two
    neighbours, or, at both ends, through the nearest four keyframes."""
    result = []
    for k in range(len(keys)):
        nearest = slice(0, 4) if k in (0, len(keys) - 1) else slice(k - 1, k + 2)
        places = keys[nearest].reshape(-1, 36).astype(float)
        coefficients = np.polyfit(TIMES[nearest] - TIMES[k], places, len(places) - 1)
        result.append(coefficients[-2].reshape(12, 3))
    return np.array(result)


def on_cubic(keys, velocities, time):
    """Return the positions at a time on the cubic Hermite spline through the keyframes, with the given velocities."""
    k = min(np.searchsorted(TIMES, time, side="right") - 1, len(TIMES) - 2)
    h = TIMES[k + 1] - TIMES[k]
    t = (time - TIMES[k]) / h
    p, v = keys.astype(float), np.asarray(velocities, dtype=float)
    return ((2 * t**3 - 3 * t**2 + 1) * p[k] + (3 * t**2 - 2 * t**3) * p[k + 1]
            + h * (t**3 - 2 * t**2 + t) * v[k] + h * (t**3 - t**2) * v[k + 1])


class PathsTest(unittest.TestCase):
    def test_normals_of_pieces_are_those_of_cross_products_on_the_curve_within_the_tolerance(self):
        keys = turning_sheet()
        given = slopes(keys) + 0.5
        for path, velocities in (("catmull-rom", slopes(keys)), ("hermite", given)):
            counts = []
            for text, tolerance in ((path, 0.01), (path + ":0.5", 0.5)):
                positions, times = cn.cut(keys, FACES, TIMES, text, given if path == "hermite" else None)
                counts.append(len(times))
                self.assertEqual((positions.dtype, positions.shape), (np.float32, (len(times), 12, 3)))
                self.assertEqual((times[0], times[-1]), (0, 2))
                for time in np.linspace(0, 2, 41):
                    k = min(np.searchsorted(times, time, side="right") - 1, len(times) - 2)
                    t = (time - times[k]) / (times[k + 1] - times[k])
                    shown = (1 - t) * positions[k].astype(float) + t * positions[k + 1]
                    places = on_cubic(keys, velocities, time)
                    off = np.degrees(angle(unit(face_normals(shown, FACES)), unit(face_normals(places, FACES))).max())
                    self.assertLess(off, tolerance + 1e-3)
            self.assertGreater(counts[0], 2 * counts[1])
        positions, times = cn.cut(keys, FACES, TIMES, "linear")
        np.testing.assert_array_equal(positions, keys)
        np.testing.assert_array_equal(times, TIMES)

    def test_what_is_wrong_is_said_with_its_place(self):
        keys = turning_sheet()
        for call, words in ((lambda: cn.cut(keys, FACES, path="round"), "path: there is no path 'round'"),
                            (lambda: cn.cut(keys, FACES, path="hermite"), "no keyframe has them"),
                            (lambda: cn.cut(keys, FACES, velocities=keys[:2]), r"velocities: the shape must be .*but is \(2, 12, 3\)"),
                            (lambda: cn.cut(keys, FACES, TIMES[::-1]), "keyframe|time"),
                            (lambda: cn.cut(keys[0], FACES), r"positions: the shape"),
                            (lambda: cn.cut(keys, FACES, velocities=keys * np.nan, path="hermite"), "velocity"),
                            (lambda: cn.audit(sample="twist", path="round"), "path: there is no path 'round'"),
                            (lambda: cn.read(sample="bumps", path="catmull-rom"), "only for sequences of keyframes"),
                            (lambda: cn.audit(cn.bake(sample="twist")[0], path="catmull-rom"), "glTF")):
            with self.subTest(words=words), self.assertRaisesRegex(ValueError, words):
                call()


@unittest.skipUnless(PROGRAM, "CHRONORMAL_PROGRAM names no program")
class ProgramPathsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        keys = turning_sheet()
        self.file = self.folder / "sheet.npz"
        np.savez(self.file, positions=keys, faces=FACES, times=TIMES, velocities=(slopes(keys) + 0.5).astype(np.float32))

    def run_program(self, *arguments):
        return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, check=True).stdout

    def test_reports_and_files_are_those_of_the_program(self):
        for path in ("catmull-rom", "hermite"):
            arguments = (self.file, "--path", path, "--json")
            with self.subTest(path=path):
                self.assertEqual(cn.audit(self.file, path=path), json.loads(self.run_program("audit", *arguments)))
                self.assertEqual(cn.compare(self.file, path=path, schemes=["linear", "slerp"], certify=True),
                                 json.loads(self.run_program("compare", *arguments, "--no-times", "--schemes", "linear,slerp",
                                                             "--certify")))
                glb, report = cn.bake(self.file, path=path)
                written = self.folder / f"{path}.glb"
                self.run_program("bake", self.file, "--path", path, "-o", written)
                self.assertEqual(glb, written.read_bytes())
                self.assertEqual((report["path"], report["encoding"]), (path, "exact"))
                sampled = self.folder / f"{path}.npy"
                self.run_program("sample", self.file, "--path", path, "--times", "0,0.3,1.9", "-o", sampled)
                normals = cn.read(self.file, path=path).unit_normals([0, 0.3, 1.9])
                np.testing.assert_array_equal(normals, np.load(sampled))

    def test_errors_are_those_of_the_one_scheme_that_was_asked_for(self):
        (table,) = cn.errors(self.file, scheme="linear", path="catmull-rom", samples=5)
        report = cn.compare(self.file, schemes=["linear"], path="catmull-rom", samples=5, elements="vertices")
        self.assertAlmostEqual(float(np.nanmax(table.errors)), report["schemes"][0]["max_degrees"], places=4)
        (audited,) = cn.errors(self.file, path="catmull-rom")
        self.assertGreater(np.nanmax(audited.errors), 1e-6)

    def test_velocities_of_ply_files_are_read_and_those_of_half_of_them_refused(self):
        keys = turning_sheet()
        velocities = slopes(keys) + 0.5
        for names in (("vx", "vy", "vz"), ("velocity_x", "velocity_y", "velocity_z")):
            for k, (p, v) in enumerate(zip(keys, velocities.astype(np.float32))):
                properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", *names))
                rows = "".join(" ".join(repr(float(c)) for c in row) + "\n" for row in np.hstack([p, v]))
                corners = "".join(f"3 {a} {b} {c}\n" for a, b, c in FACES)
                (self.folder / f"sheet_{k}.ply").write_text(
                    f"ply\nformat ascii 1.0\nelement vertex 12\n{properties}element face 12\n"
                    f"property list uchar int vertex_indices\nend_header\n{rows}{corners}")
            files = [self.folder / f"sheet_{k}.ply" for k in range(4)]
            motion = cn.read(files)
            np.testing.assert_array_equal(motion.velocities, velocities.astype(np.float32))
            _, times = cn.cut(keys, FACES, None, "hermite", velocities)
            np.testing.assert_array_equal(cn.read(files, path="hermite").times, times)
            self.run_program("convert", self.folder / "sheet_*.ply", "--force", "-o", self.folder / "again.npz")
            np.testing.assert_array_equal(cn.read(self.folder / "again.npz").velocities, velocities.astype(np.float32))
            self.assertIsNone(cn.read(sample="twist").velocities)
        half = self.folder / "sheet_2.ply"
        half.write_text(half.read_text().replace("velocity_", "speed_"))
        with self.assertRaisesRegex(ValueError, r"frame 2 \(sheet_2.ply\): the file has no velocities"):
            cn.read(files)


if __name__ == "__main__":
    unittest.main()
