"""Tests events that may crash a process or make it hang: signals, forks, pickles, names, numbers that are too large,
and memory that is both read and written.

All random numbers follow from SEED.
"""

import copy
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import chronormal as cn
from meshes import sheet

SEED = 49
PATIENCE = 60  # seconds, enough for a busy machine


def objects():
    """Return one object of each class, in a dict by the name of the class."""
    p0, p1, faces = sheet()
    deltas = np.stack([p1 - p0, p0])
    return {"Curves": cn.curves(p0, p1, faces), "Blend": cn.blend(p0, deltas, faces), "Motion": cn.read(sample="twist")}


class Enough(Exception):
    pass


def raise_enough(*_):
    raise Enough


def wavy(frames, size, seed=SEED):
    """Return a sheet of size x size vertices that moves: positions (frames, V, 3) and faces."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(size), np.arange(size))
    grid = np.stack([x, y, 0 * x], axis=-1).reshape(1, -1, 3).astype(np.float32)
    corner = (np.arange(size - 1)[:, None] * size + np.arange(size - 1)).reshape(-1)
    faces = np.stack([corner, corner + 1, corner + size + 1, corner + size], axis=-1)
    return grid + 0.3 * random.standard_normal((frames, size * size, 3)).astype(np.float32), faces


class SignalTest(unittest.TestCase):
    def setUp(self):
        self.before = signal.signal(signal.SIGALRM, raise_enough)

    def tearDown(self):
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, self.before)

    def is_ended(self, call, after):
        """Return True if a signal arrives before the end of the call and ends the call."""
        try:
            signal.setitimer(signal.ITIMER_REAL, after)
            call()
            signal.setitimer(signal.ITIMER_REAL, 0)
        except Enough:
            return True
        return False

    def test_calls_that_take_hours_end_with_a_signal(self):
        positions, faces = wavy(3, 30)
        twist, curves = cn.read(sample="twist"), cn.curves(positions[0], positions[1], faces)
        deltas = positions[1:] - positions[:1]
        glb, _ = cn.bake(sample="twist", encode="endpoint")
        many = np.linspace(0, 1, 2 * 10**5)
        out = np.empty((len(many), len(curves), 3), np.float32)  # takes memory only as rows are written
        for name, call in {
                "audit": lambda: cn.audit(glb, samples=10**6, viewers="all"),
                "compare": lambda: cn.compare(sample="eversion", samples=10**6),
                "compare vertices": lambda: cn.compare(sample="eversion", samples=10**6, elements="vertices"),
                "certificates": lambda: cn.compare(sample="eversion", samples=10**6, certify=True),
                "pieces": lambda: [cn.cut(positions, faces) for _ in range(10**6)],
                "curves": lambda: [curves.unit_normals(many, out=out) for _ in range(1000)],
                "a blend": lambda: [cn.blend(positions[0], deltas, faces) for _ in range(10**6)],
                "a motion": lambda: twist.unit_normals(np.linspace(0, 1, 10**6), weighting="angle"),
                "questions": lambda: [cn.shutter(positions, faces) for _ in range(10**6)]}.items():
            with self.subTest(name):
                self.assertTrue(self.is_ended(call, 0.2))

    def test_a_call_that_was_ended_at_any_moment_leaves_others_as_they_are(self):
        positions, faces = wavy(3, 60)
        twist = cn.read(sample="twist")
        curves = cn.curves(*positions[:2], faces)
        calls = [lambda: cn.audit(sample="twist", samples=801), lambda: cn.compare(sample="twist", samples=101, certify=True),
                 lambda: cn.errors(sample="twist", scheme="linear", samples=200), lambda: cn.bake(sample="twist"),
                 lambda: cn.inspect(sample="twist"), lambda: cn.certify(*twist.positions, twist.faces, "slerp", threads=1),
                 lambda: cn.curves(*positions[:2], faces, weighting="angle"), lambda: cn.cut(positions, faces),
                 lambda: curves.unit_normals(np.linspace(0, 1, 100)), lambda: cn.collapse(positions, faces),
                 lambda: cn.facing(positions, faces, eye=[0, 0, 9], silhouettes=True), lambda: cn.cones(positions, faces),
                 lambda: cn.shutter(positions, faces)]
        random = np.random.default_rng(SEED)
        expected, report = curves.unit_normals(0.25), cn.audit(sample="twist")
        ended = sum(self.is_ended(calls[random.integers(len(calls))], random.uniform(0.01, 0.3)) for _ in range(40))
        self.assertGreater(ended, 5)
        np.testing.assert_array_equal(curves.unit_normals(0.25), expected)
        self.assertEqual(cn.audit(sample="twist"), report)

    def test_ctrl_c_ends_a_program(self):
        code = "import chronormal as cn; print('begun', flush=True); cn.compare(sample='eversion', samples=10**6)"
        # A shell that runs the tests in the background makes all programs ignore Ctrl+C, so this program stops ignoring
        # it.
        program = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        self.assertEqual(program.stdout.readline(), b"begun\n")
        time.sleep(0.5)
        program.send_signal(signal.SIGINT)
        try:
            _, words = program.communicate(timeout=PATIENCE)
        finally:
            program.kill()
        self.assertEqual(program.returncode, -signal.SIGINT)
        self.assertIn(b"KeyboardInterrupt", words)

    def test_a_handler_may_compute_but_with_what_it_interrupts(self):
        positions, faces = wavy(2, 100)
        curves, other = cn.curves(*positions, faces), cn.curves(*positions, faces)
        said = []

        def handler(*_):
            said.append(other.unit_normals(0.5))
            try:
                curves.unit_normals(0.5)
            except ValueError as error:
                said.append(str(error))

        signal.signal(signal.SIGALRM, handler)
        until, times = time.monotonic() + PATIENCE, np.full(300, 0.5)
        while len(said) < 2 and time.monotonic() < until:
            said.clear()
            signal.setitimer(signal.ITIMER_REAL, 0.001)
            rows = curves.unit_normals(times, threads=1)
            # On a fast machine the call ends before the signal arrives, and the handler runs between two calls. The
            # work is therefore doubled each time.
            times = np.full(min(2 * len(times), 10_000), 0.5)
        np.testing.assert_array_equal(said[0], rows[0])
        self.assertIn("a signal handler cannot use the object whose computation it interrupts; use the object after the computation has ended", said[1])


@unittest.skipUnless(hasattr(os, "fork"), "this system has no fork()")
class ForkTest(unittest.TestCase):
    def test_a_child_computes_while_other_threads_of_its_parent_do(self):
        positions, faces = wavy(3, 40)
        made = [cn.curves(positions[0], positions[1], faces),
                cn.blend(positions[0], positions[1:] - positions[:1], faces)]
        asked = [0.5, [0.5, 0.25]]

        def results():
            found = [one.unit_normals(at, threads=0) for one, at in zip(made, asked)]
            found.append(cn.curves(positions[0], positions[1], faces, weighting="angle", threads=0).unit_normals(0.5))
            found.append(cn.shutter(positions, faces)["mean"])
            return found

        expected = results()
        stop = threading.Event()

        def compute(one, at):
            while not stop.is_set():
                one.unit_normals(np.full((50, *np.shape(at)), at), threads=0)

        def prepare():
            while not stop.is_set():
                cn.curves(positions[0], positions[1], faces, threads=0).next(positions[1], positions[2])

        threads = [threading.Thread(target=compute, args=pair) for pair in zip(made, asked)] + [threading.Thread(target=prepare)]
        for thread in threads:
            thread.start()
        random = np.random.default_rng(SEED)
        try:
            for _ in range(10):
                time.sleep(random.uniform(0, 0.02))
                child = os.fork()
                if child == 0:
                    same = all(np.array_equal(a, b) for a, b in zip(results(), expected))
                    os._exit(0 if same else 1)
                until = time.monotonic() + PATIENCE
                while (status := os.waitpid(child, os.WNOHANG))[0] == 0 and time.monotonic() < until:
                    time.sleep(0.005)
                if status[0] == 0:
                    os.kill(child, signal.SIGKILL)
                    os.waitpid(child, 0)
                    self.fail("the child hangs")
                self.assertEqual(status[1], 0)
        finally:
            stop.set()
            for thread in threads:
                thread.join()

    def test_a_child_may_end_as_programs_do(self):
        # The next audit starts threads if there are several cores, so the process below forks while it has threads.
        self.assertEqual(cn.audit(sample="twist")["command"], "audit")
        child = multiprocessing.get_context("fork").Process(target=cn.audit, kwargs={"sample": "twist"})
        child.start()
        child.join(PATIENCE)
        self.assertEqual(child.exitcode, 0)


class PickleTest(unittest.TestCase):
    def test_what_keeps_no_positions_is_neither_pickled_nor_copied_and_says_so(self):
        for name, made in objects().items():
            if name == "Motion":
                continue  # python/tests/test_arrays.py pickles motions
            ways = [lambda made=made, p=p: pickle.dumps(made, p) for p in range(pickle.HIGHEST_PROTOCOL + 1)]
            ways += [lambda: copy.copy(made), lambda: copy.deepcopy(made), lambda: made.__reduce__(), lambda: made.__reduce_ex__(0)]
            for way in ways:
                with self.assertRaisesRegex(TypeError, f"cannot pickle '{name}' object"):
                    way()


class ArgumentTest(unittest.TestCase):
    def test_files_have_names_of_any_bytes(self):
        text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        random = np.random.default_rng(SEED)
        pieces = [b"a", b"\xff", b"\xc3\xa9", b"\xed\xb2\x80", b" ", b"\n", b"%", b"*", b"[", b"-", b"\\", b"\x01", b"\xf0\x9f\xa6\x8a"]
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(60):
                name = os.fsdecode(b"".join(pieces[i] for i in random.integers(len(pieces), size=random.integers(1, 5))))
                path = os.path.join(folder, name + ".obj")
                with open(path, "wb") as file:
                    file.write(text)
                mesh = cn.read(path)
                self.assertEqual(mesh.positions.shape, (1, 3, 3), ascii(name))
                self.assertIn("3 vertices", repr(mesh))
                self.assertEqual([str(each) for each in mesh.names], mesh.names)
                self.assertEqual(cn.inspect(os.fsencode(path) and [path])["command"], "inspect")
                os.remove(path)
                with self.assertRaises(OSError):
                    cn.read(path)
                with self.assertRaises(OSError):
                    cn.read(sample="twist", base=None) and cn.read([path], base=path)
        for wrong in ("a\0.obj", "\ud800.obj", ["a.obj", "\ud800.obj"]):
            with self.assertRaisesRegex(ValueError, "source.*cannot be the name of a file"):
                cn.read(wrong)

    def test_arguments_that_are_none_are_refused_in_words(self):
        curves, blend, motion = objects().values()
        p0, p1, faces = sheet()
        huge = 2**2000
        for call, kind, words in (
                (lambda: curves.unit_normals(huge), ValueError, "t: the number is too large"),
                (lambda: curves.unit_normals(-huge), ValueError, "t: the number is too large"),
                (lambda: curves.errors(huge, p0), ValueError, "t: the number is too large"),
                (lambda: cn.cut([p0, p1], faces, times=[0, huge]), ValueError, "times: the array must hold real numbers, best as float64"),
                (lambda: cn.contain([p0, p1], faces, [[huge, 0, 0]]), ValueError, "points: the array must hold real numbers, best as float64"),
                (lambda: cn.read(sample=5), TypeError, "sample: the value must be a string, not int"),
                (lambda: cn.read(sample=["twist"]), TypeError, "sample: the value must be a string, not list"),
                (lambda: cn.read(sample="\ud800"), ValueError, "sample: .* cannot be written as UTF-8"),
                (lambda: cn.read("a.glb", animation="\udcff"), ValueError, "animation: .* cannot be written as UTF-8"),
                (lambda: cn.read("a.glb", base=5), TypeError, "base: the value must be the name of a file, not int"),
                (lambda: cn.read(5), TypeError, "source: the value must be files, bytes or a Motion, not int"),
                (lambda: cn.read(["a.obj", 5]), TypeError, r"source\[1\]: the value must be the name of a file, not int"),
                (lambda: cn.read(sample="twist", fps=huge), ValueError, "fps: the number is too large"),
                (lambda: cn.read(sample="twist", fps=[1]), TypeError, "fps: the value must be a number, not list")):
            with self.subTest(words=words), self.assertRaisesRegex(kind, words):
                call()

    def test_no_argument_of_any_kind_ends_in_words_of_the_machinery(self):
        p0, p1, faces = sheet()
        curves, blend, motion = objects().values()
        pool = [None, True, -1, 5, 2**40, 2**2000, -2**2000, 0.5, float("nan"), float("inf"), "", "twist", "\ud800", "\udcff", "a\0b",
                b"\xff", b"", [], [5], ["\udcff"], (), {}, object(), p0, np.zeros(0), np.array("x"), [[2**2000]], 1j, lambda: 0, range(3)]
        calls = [
            (cn.curves, (p0, p1, faces), ("elements", "crease", "weighting", "tolerance", "weld", "threads")),
            (cn.cut, ([p0, p1], faces), ("times", "path", "velocities")),
            (cn.blend, (p0, [p1], faces), ("elements", "crease", "weld")),
            (cn.certify, (p0, p1, faces), ("scheme", "threads")),
            (cn.read, (), ("source", "sample", "base", "fps", "animation", "path")),
            (cn.audit, (), ("source", "rule", "weighting", "viewers", "samples", "tolerance", "sample", "fps", "animation", "path")),
            (cn.compare, (), ("schemes", "samples", "access", "elements", "crease", "tolerance", "sample", "path")),
            (cn.bake, (), ("source", "encode", "viewers", "weighting", "tolerance", "sample", "fps", "path")),
            (cn.facing, ([p0, p1], faces), ("times", "direction", "eye", "eye_to", "start", "end")),
            (cn.contain, ([p0, p1], faces), ("points", "times", "start", "end")),
            (cn.cones, ([p0, p1], faces), ("meshlets", "times")),
            (curves.unit_normals, (), ("t", "out", "threads")),
            (blend.unit_normals, (), ("weights", "out", "threads")), (motion.unit_normals, (), ("times", "weights", "elements")),
        ]
        random = np.random.default_rng(SEED)
        refused = 0
        for _ in range(1500):
            function, arguments, names = calls[random.integers(len(calls))]
            chosen = {names[i]: pool[random.integers(len(pool))] for i in random.integers(len(names), size=2)}
            try:
                function(*arguments, **chosen)
            except (TypeError, ValueError, OSError) as error:
                refused += 1
                self.assertNotRegex(str(error), "Unable to cast|codec can't|Error in")
            except Exception as error:
                self.fail(f"{function.__name__}(**{ascii(chosen)}): {error!r}")
        self.assertGreater(refused, 1000)


class MemoryTest(unittest.TestCase):
    def test_what_is_asked_may_lie_in_the_memory_that_is_written(self):
        curves, blend, _ = objects().values()
        random = np.random.default_rng(SEED)
        for _ in range(200):
            made = (curves, blend)[random.integers(2)]
            rows = int(random.integers(1, 9))
            asked = random.uniform(size=(rows, 2) if made is blend else rows)
            expected = made.unit_normals(asked)
            memory = np.zeros(2 * expected.nbytes + 2 * asked.nbytes, dtype=np.uint8)
            at, to = 8 * random.integers((memory.size - asked.nbytes) // 8), 4 * random.integers((memory.size - expected.nbytes) // 4)
            shared = memory[at:at + asked.nbytes].view(np.float64).reshape(asked.shape)
            out = memory[to:to + expected.nbytes].view(np.float32).reshape(expected.shape)
            shared[...] = asked
            np.testing.assert_array_equal(made.unit_normals(shared, out=out), expected)


if __name__ == "__main__":
    unittest.main()
