"""Tests motions as arrays, reports as dicts, and bakes as bytes, and compares them with the output of the program.

CHRONORMAL_PROGRAM names the program; without it, tests that need it are skipped.
"""

import itertools
import json
import os
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import chronormal as cn
from meshes import angle, sheet, vertex_normals

PROGRAM = os.environ.get("CHRONORMAL_PROGRAM")


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, check=True).stdout


def write_walk(folder, random):
    """Write three keyframes of a sheet whose triangles share no vertices, but meet at the same points."""
    folder.mkdir()
    p0, _, faces = sheet(int(random.integers(1000)))
    for k in range(3):
        points = (p0 + 0.2 * random.standard_normal(p0.shape))[faces].reshape(-1, 3).tolist()
        lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
        lines += [f"f {f + 1} {f + 2} {f + 3}" for f in range(0, len(points), 3)]
        Path(folder, f"walk_{k}.obj").write_text("\n".join(lines) + "\n", encoding="ascii")


def scaled(glb, scale):
    """Return a GLB whose node 0 has a scale."""
    size = struct.unpack_from("<I", glb, 12)[0]
    document = json.loads(glb[20:20 + size])
    document["nodes"][0]["scale"] = scale
    document["animations"][0]["name"] = "walk"
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = glb[20 + size:]
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest


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
                (lambda: cn.read(), ValueError, "source: give either files, bytes or a Motion"),
                (lambda: cn.read("a", sample="twist"), ValueError, "source"),
                (lambda: cn.read(sample="none"), ValueError, "none"),
                (lambda: cn.read([]), ValueError, "^source: the list has no files; give at least one file$"),
                (lambda: cn.compare(sample="twist", schemes="slrp"), ValueError, "there is no scheme 'slrp'"),
                (lambda: cn.read(sample="twist", fps=0), ValueError, "fps"),
                (lambda: cn.read(sample="twist").unit_normals([2]), ValueError, "0 to 1"),
                (lambda: cn.read(sample="twist").unit_normals(), ValueError, "times: the times are missing"),
                (lambda: targets.unit_normals([0]), ValueError, ""),
                (lambda: targets.unit_normals(weights=[[1, 2]]), ValueError, "weights|targets"),
                (lambda: targets.unit_normals(weights=[1, 2]), ValueError, r"weights: the shape must be .*but is \(2,\)"),
                (lambda: cn.audit(sample="twist", rule="none"), ValueError, "gltf, lerp"),
                (lambda: cn.audit(sample="twist", viewers="three"), ValueError, "glTF"),
                (lambda: cn.compare(sample="twist", schemes=["none"]), ValueError, "none"),
                (lambda: cn.compare(sample="twist", samples=1), ValueError, "at least 2"),
                (lambda: cn.bake(sample="twist", encode="smallest"), ValueError,
                 "encode: the encoding of a sequence must be harmless, exact, endpoint or keys"),
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
        self.assertEqual(cn.compare(sample="twist", schemes="linear,slerp", elements="vertices"),
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

    def assert_errors(self, table, file):
        with np.load(file) as written:
            np.testing.assert_array_equal(table.errors, written[f"{table.name}_errors" if table.name else "errors"])

    def test_options_of_a_sequence_reach_every_function(self):
        seed = 20261130
        print("  from seed", seed)
        random = np.random.default_rng(seed)
        for loop, weld in itertools.product((False, True), repeat=2):
            with self.subTest(loop=loop, weld=weld), tempfile.TemporaryDirectory() as folder:
                walk, errors, glb = Path(folder, "walk"), Path(folder, "e.npz"), Path(folder, "w.glb")
                write_walk(walk, random)
                reading = {"fps": int(random.integers(2, 31)), "loop": loop}
                motion = dict(reading, path=str(random.choice(["linear", "catmull-rom"])))
                given = [walk, "--fps", reading["fps"], *["--loop"] * loop]
                moving = [*given, "--path", motion["path"]]
                welding = ["--no-weld"] * (not weld)
                self.assertEqual(cn.inspect(walk, **reading), json.loads(run("inspect", *given, "--json")))
                self.assertEqual(cn.audit(walk, weld=weld, **motion), json.loads(run("audit", *moving, *welding, "--json")))
                schemes = ["--schemes", "linear", "--elements", "vertices", *welding]
                self.assertEqual(cn.compare(walk, schemes=["linear"], elements="vertices", weld=weld, **motion),
                                 json.loads(run("compare", *moving, *schemes, "--no-times", "--json")))
                run("bake", *moving, "-o", glb)
                self.assertEqual(cn.bake(walk, **motion)[0], glb.read_bytes())
                run("audit", *moving, *welding, "--errors", errors)
                self.assert_errors(cn.errors(walk, weld=weld, **motion)[0], errors)
                run("compare", *moving, *schemes, "--errors", errors, "--force")
                self.assert_errors(cn.errors(walk, scheme="linear", weld=weld, **motion)[0], errors)

    def test_a_sequence_takes_the_encodings_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            for encode in ("harmless", "exact", "endpoint", "keys"):
                with self.subTest(encode=encode):
                    glb = Path(folder, encode + ".glb")
                    run("bake", "--sample", "twist", "--encode", encode, "-o", glb)
                    self.assertEqual(cn.bake(sample="twist", encode=encode)[0], glb.read_bytes())

    def test_options_of_a_gltf_file_reach_every_function(self):
        seed = 20261131
        print("  from seed", seed)
        random = np.random.default_rng(seed)
        with tempfile.TemporaryDirectory() as folder:
            write_walk(Path(folder, "walk"), random)
            file, errors = Path(folder, "walk.glb"), Path(folder, "e.npz")
            file.write_bytes(scaled(cn.bake(Path(folder, "walk"))[0], random.uniform(0.5, 3, 3).tolist()))
            for animation, world in itertools.product((None, "walk"), (False, True)):
                with self.subTest(animation=animation, world=world):
                    named = [] if animation is None else ["--animation", animation]
                    placed = ["--world"] * world
                    self.assertEqual(cn.inspect(file, animation=animation, world=world),
                                     json.loads(run("inspect", file, *named, *placed, "--json")))
                    self.assertEqual(cn.compare(file, schemes=["linear"], animation=animation, world=world),
                                     json.loads(run("compare", file, *named, *placed, "--schemes", "linear", "--no-times",
                                                    "--json")))
                    self.assertEqual(cn.audit(file, animation=animation), json.loads(run("audit", file, *named, "--json")))
                    run("audit", file, *named, "--errors", errors, "--force")
                    self.assert_errors(cn.errors(file, animation=animation)[0], errors)

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
