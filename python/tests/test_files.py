"""Tests motions as arrays, reports as dicts, and bakes as bytes, and compares them with the output of the program.

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
from meshes import angle, vertex_normals

PROGRAM = os.environ.get("CHRONORMAL_PROGRAM")


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, check=True).stdout


class ReadTest(unittest.TestCase):
    def test_a_motion_is_arrays_that_curves_take(self):
        motion = cn.read(sample="twist")
        self.assertEqual(motion.positions.shape, (2, 7700, 3))
        self.assertIs(motion.positions, motion.positions)
        self.assertEqual((motion.kind, motion.times.tolist(), motion.segments.tolist()), ("sequence", [0, 1], [[0, 1]]))
        self.assertIn("15200 faces", repr(motion))
        curves = cn.curves(motion.positions[0], motion.positions[1], motion.faces)
        truth = vertex_normals(0.5 * (motion.positions[0].astype(float) + motion.positions[1]), motion.faces)
        self.assertLess(angle(curves.unit_normals(0.5), truth).max(), 2e-6)

    def test_files_are_read_by_name_and_from_bytes(self):
        text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 3 4\nf 2 5 3\n"
        with tempfile.TemporaryDirectory() as folder:
            for k in range(3):
                Path(folder, f"walk_{k}.obj").write_bytes(text.replace(b"2 0 0", f"2 0 {k}".encode()))
            motion = cn.read(folder, fps=2)
            self.assertEqual(motion.times.tolist(), [0, 0.5, 1])
            self.assertEqual(cn.read([Path(folder, "walk_0.obj"), Path(folder, "walk_2.obj")]).positions.shape, (2, 5, 3))
        offsets, corners = motion.faces
        self.assertEqual((offsets.tolist(), corners.tolist()), ([0, 4, 7], [0, 1, 2, 3, 1, 4, 2]))
        normals = cn.curves(motion.positions[0], motion.positions[1], motion.faces).unit_normals(1)
        np.testing.assert_array_equal(normals, motion.unit_normals([0.5])[0])
        mesh = cn.read(text)
        self.assertEqual((mesh.kind, mesh.positions.shape, mesh.unit_normals().shape), ("mesh", (1, 5, 3), (1, 5, 3)))

    def test_what_is_wrong_is_said_with_its_place(self):
        targets = cn.read(sample="bumps")
        for call, kind, words in (
                (lambda: cn.read("/no/such.obj"), OSError, "/no/such.obj: No such file"),
                (lambda: cn.read(b"v 0 0 0\nf 1 2 3\n"), ValueError, "line 2"),
                (lambda: cn.read(b"what is this"), (ValueError, OSError), "<bytes>"),
                (lambda: cn.read(), ValueError, "source: give files, bytes or a Motion"),
                (lambda: cn.read("a", sample="twist"), ValueError, "source"),
                (lambda: cn.read(sample="none"), ValueError, "none"),
                (lambda: cn.read([]), ValueError, ""),
                (lambda: cn.read(sample="twist", fps=0), ValueError, "fps"),
                (lambda: cn.read(sample="twist").unit_normals([2]), ValueError, "0 to 1"),
                (lambda: cn.read(sample="twist").unit_normals(), ValueError, "times: times are missing"),
                (lambda: targets.unit_normals([0]), ValueError, ""),
                (lambda: targets.unit_normals(weights=[[1, 2]]), ValueError, "weights|targets"),
                (lambda: targets.unit_normals(weights=[1, 2]), ValueError, r"weights: the shape must be .*but is \(2,\)"),
                (lambda: cn.audit(sample="twist", rule="none"), ValueError, "gltf, lerp"),
                (lambda: cn.audit(sample="twist", viewers="three"), ValueError, "glTF"),
                (lambda: cn.compare(sample="twist", schemes=["none"]), ValueError, "none"),
                (lambda: cn.compare(sample="twist", samples=1), ValueError, "at least 2"),
                (lambda: cn.bake(sample="twist", encode="harmless"), ValueError, "encode: the encoding of a sequence"),
                (lambda: cn.bake(sample="bumps"), ValueError, "targets"),
                (lambda: cn.errors(sample="twist", elements="faces"), ValueError, "elements"),
                (lambda: cn.errors(sample="twist", samples=100000), ValueError, "1 GiB")):
            with self.subTest(words=words), self.assertRaisesRegex(kind, words):
                call()

    def test_bytes_of_any_kind_are_refused_and_never_crash(self):
        glb, _ = cn.bake(sample="twist", encode="endpoint")
        random = np.random.default_rng(20260102)  # seeds everything that follows
        head = bytearray(glb[:4000])
        for _ in range(60):
            broken = bytearray(head)
            for at in random.integers(len(head), size=8):
                broken[at] = random.integers(256)
            for read in (cn.read, cn.inspect, cn.audit, cn.bake):
                with self.assertRaises((ValueError, OSError)):
                    read(bytes(broken))


class ReportTest(unittest.TestCase):
    def test_errors_have_what_the_audit_adds_up(self):
        report = cn.audit(sample="twist", samples=5)
        (table,) = cn.errors(sample="twist", samples=5)
        self.assertEqual(table.errors.shape, (5, 7700))
        self.assertAlmostEqual(float(np.nanmax(table.errors)), report["worst_degrees"], places=4)
        worst = report["worst_at"]
        row = table.times.tolist().index(worst["time"])
        self.assertEqual(np.nanargmax(table.errors[row]), worst["vertex"])
        self.assertAlmostEqual(float(np.nanmean(table.errors)), report["mean_degrees"], places=4)
        self.assertIn("5 samples of 7700, 39.12 degrees", repr(table))

    def test_errors_of_a_scheme_are_those_of_its_interpolation(self):
        motion = cn.read(sample="twist")
        curves = cn.curves(motion.positions[0], motion.positions[1], motion.faces)
        (table,) = cn.errors(sample="twist", scheme="slerp", samples=3)
        ends = curves.unit_normals([0, 1]).astype(np.float64)
        middle = ends[0] + ends[1]  # the direction of slerp at 1/2; only its length differs
        np.testing.assert_allclose(table.errors[1], curves.errors(0.5, middle), atol=1e-3)
        self.assertLess(table.errors[[0, 2]].max(), 1e-3)

    def test_a_bake_is_bytes_that_an_audit_passes(self):
        glb, report = cn.bake(sample="twist")
        self.assertEqual(glb[:4], b"glTF")
        self.assertEqual(report["bytes"], len(glb))
        self.assertLess(cn.audit(glb, tolerance=1)["worst_degrees"], 0.01)
        again, _ = cn.bake(glb)  # a baked file does not change when baked again
        self.assertEqual(cn.inspect(again)["gltf"]["meshes"], cn.inspect(glb)["gltf"]["meshes"])


@unittest.skipUnless(PROGRAM, "CHRONORMAL_PROGRAM names no program")
class ProgramTest(unittest.TestCase):
    def test_reports_are_those_of_the_program(self):
        sample = ("--sample", "twist", "--json")
        self.assertEqual(cn.audit(sample="twist", tolerance=50), json.loads(run("audit", *sample, "--tolerance", 50)))
        self.assertEqual(cn.inspect(sample="twist"), json.loads(run("inspect", *sample)))
        self.assertEqual(cn.compare(sample="twist", schemes=["linear", "circle"], tolerance=15),
                         json.loads(run("compare", *sample, "--no-times", "--schemes", "linear,circle", "--tolerance", 15)))
        self.assertEqual(cn.compare(sample="twist", schemes=["linear", "slerp"], elements="vertices"),
                         json.loads(run("compare", *sample, "--no-times", "--schemes", "linear,slerp", "--elements", "vertices")))

    def test_normals_have_the_bits_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            for elements in ("vertices", "faces", "corners"):
                file = Path(folder, elements + ".npy")
                run("sample", "--sample", "cloth", "--times", "0:0.1:4", "--elements", elements, "-o", file)
                motion = cn.read(sample="cloth")
                times = [float(t) for t in (np.arange(41) * 0.1)]
                with self.subTest(elements=elements):
                    written = np.load(file)
                    np.testing.assert_array_equal(motion.unit_normals(times, elements=elements), written)
                    curves = cn.curves(motion.positions[0], motion.positions[1], motion.faces, elements=elements)
                    np.testing.assert_array_equal(curves.unit_normals(times[:10]), written[:10])
            file = Path(folder, "pose.npy")
            weights = np.linspace(-0.5, 1, 12)
            run("sample", "--sample", "bumps", "--weights=" + ",".join(map(repr, weights.tolist())), "-o", file)
            np.testing.assert_array_equal(cn.read(sample="bumps").unit_normals(weights=[weights]), np.load(file))

    def test_errors_are_those_that_the_program_writes(self):
        with tempfile.TemporaryDirectory() as folder:
            run("audit", "--sample", "twist", "--samples", 3, "--errors", Path(folder, "e.npz"))
            (table,) = cn.errors(sample="twist", samples=3)
            with np.load(Path(folder, "e.npz")) as written:
                self.assertEqual(sorted(written), ["errors", "subjects", "times"])
                for name in written:
                    np.testing.assert_array_equal(getattr(table, name), written[name])


if __name__ == "__main__":
    unittest.main()
