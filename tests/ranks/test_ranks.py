"""Tests the program under mpirun: with any number of ranks, the output has the same bytes as with one process. If a
rank fails or dies, the run ends, the message names the rank, and no files are left behind. CHRONORMAL_PROGRAM names the
program, which must be built with MPI."""

import array
import math
import os
import signal
import struct
import subprocess
import tempfile
import time
import unittest

PROGRAM = os.environ["CHRONORMAL_PROGRAM"]
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n"]
COUNTS = (1, 2, 3, 4, 9)  # numbers of ranks; the motion has six segments


def write_mesh(path, side):
    with open(path, "w") as file:
        for y in range(side):
            for x in range(side):
                file.write(f"v {x} {y} 0\n")
        for y in range(side - 1):
            for x in range(side - 1):
                first = y * side + x + 1
                file.write(f"f {first} {first + 1} {first + side + 1} {first + side}\n")


def pose(side, time):
    numbers = array.array("f")
    for y in range(side):
        for x in range(side):
            numbers.extend((x + 0.3 * math.sin(time + y * 0.5), y, 2 * math.sin(0.7 * time + 0.4 * x + 0.2 * y)))
    return numbers.tobytes()


def write_cache(path, side, poses):
    with open(path, "wb") as file:
        file.write(b"POINTCACHE2\0" + struct.pack("<iiffi", 1, side * side, 0, 1, len(poses)))
        for numbers in poses:
            file.write(numbers)


def is_rank(process, rank):
    """Tells whether a process is the given rank of a run."""
    try:
        with open(f"/proc/{process}/environ", "rb") as file:
            return f"OMPI_COMM_WORLD_RANK={rank}".encode() in file.read().split(b"\0")
    except OSError:
        return False


class RanksTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        os.chdir(cls.folder.name)
        write_mesh("small.obj", 12)
        write_cache("small.pc2", 12, [pose(12, k) for k in range(7)])
        # Inputs whose keyframes take up to 64 MiB stay in memory. The keyframes of large.pc2 take more.
        side, poses = 200, [pose(200, k) for k in range(5)]
        write_mesh("large.obj", side)
        write_cache("large.pc2", side, poses * 30)
        write_cache("broken.pc2", side, poses * 30 + [struct.pack("<f", math.nan) * (3 * side * side)])

    @classmethod
    def tearDownClass(cls):
        os.chdir("/")
        cls.folder.cleanup()

    def setUp(self):
        self.before = sorted(os.listdir("."))

    def run_program(self, arguments, ranks=None, text=True):
        command = (MPIRUN + [str(ranks)] if ranks else []) + [PROGRAM] + arguments.split()
        return subprocess.run(command, capture_output=True, text=text, timeout=120)

    def assert_nothing_is_left(self):
        self.assertEqual(sorted(os.listdir(".")), self.before)

    def test_any_number_of_ranks_prints_the_bytes_of_one_process(self):
        for command in ("compare small.obj small.pc2 --json --no-times",
                        "compare small.obj small.pc2 --no-times --elements vertices --tolerance 5",
                        "compare small.obj small.pc2 --csv --no-times --schemes slerp,quadratic",
                        "audit small.obj small.pc2",
                        "audit small.obj small.pc2 --json --tolerance 0.5"):
            alone = self.run_program(command, text=False)
            for ranks in COUNTS:
                with self.subTest(command=command, ranks=ranks):
                    run = self.run_program(command, ranks, text=False)
                    self.assertEqual((run.returncode, run.stdout), (alone.returncode, alone.stdout), run.stderr)

    def test_each_rank_of_an_audit_reads_its_own_segments_alone(self):
        # All ranks need the largest length of a normal, but only the last rank may read the invalid keyframe.
        run = self.run_program("audit large.obj broken.pc2 --no-weld --samples 2 -o x.txt", 3)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("rank 2: broken.pc2", run.stderr)
        self.assertEqual(run.stderr.count("chronormal"), 1, run.stderr)

    def test_measured_times_are_left_out(self):
        alone = self.run_program("compare small.obj small.pc2 --no-times")
        self.assertEqual(self.run_program("compare small.obj small.pc2", 2).stdout, alone.stdout)

    def test_a_result_in_a_file_is_that_of_one_process(self):
        self.run_program("audit small.obj small.pc2 --json -o alone.json")
        run = self.run_program("audit small.obj small.pc2 --json -o ranks.json", 3)
        self.assertEqual((run.returncode, run.stdout), (0, ""))
        self.assert_same_files("alone.json", "ranks.json")

    def assert_same_files(self, alone, ranks):
        with open(alone, "rb") as one, open(ranks, "rb") as other:
            self.assertEqual(one.read(), other.read(), ranks)
        os.remove(ranks)
        if alone not in self.before:
            self.addCleanup(lambda: os.path.exists(alone) and os.remove(alone))

    def test_samples_are_one_file_with_the_bytes_of_one_process(self):
        for what in ("--times 0:0.25:6", "--times 0,0,6,3.5,1 --elements corners --weighting angle"):
            for kind in ("npy", "npz"):
                arguments = f"sample small.obj small.pc2 {what} --force -o"
                self.assertEqual(self.run_program(f"{arguments} alone.{kind}").returncode, 0)
                for ranks in COUNTS:
                    with self.subTest(what=what, kind=kind, ranks=ranks):
                        run = self.run_program(f"{arguments} ranks.{kind}", ranks)
                        self.assertEqual(run.returncode, 0, run.stderr)
                        self.assert_same_files(f"alone.{kind}", f"ranks.{kind}")
        self.doCleanups()
        self.assert_nothing_is_left()

    def test_meshes_are_the_files_of_one_process(self):
        for kind in ("ply", "obj"):
            self.assertEqual(self.run_program(f"sample small.obj small.pc2 --times 0:1:6 -o alone_%d.{kind}").returncode, 0)
            for ranks in COUNTS:
                run = self.run_program(f"sample small.obj small.pc2 --times 0:1:6 -o ranks_%d.{kind}", ranks)
                self.assertEqual(run.returncode, 0, run.stderr)
                for i in range(7):
                    self.assert_same_files(f"alone_{i}.{kind}", f"ranks_{i}.{kind}")
        self.doCleanups()
        self.assert_nothing_is_left()

    def test_normals_without_a_direction_are_counted_over_all_ranks(self):
        write_cache("flat.pc2", 12, [struct.pack("<f", 0.0) * 432] * 7)
        self.addCleanup(os.remove, "flat.pc2")
        alone = self.run_program("sample small.obj flat.pc2 --times 0:1:6 -o flat.npy --force")
        run = self.run_program("sample small.obj flat.pc2 --times 0:1:6 -o flat.npy --force", 3)
        self.addCleanup(os.remove, "flat.npy")
        self.assertIn("of 1,008 normals of vertices, 1,008 are written as (0, 0, 0)", alone.stderr)
        self.assertEqual(run.stderr, alone.stderr)

    def test_what_ranks_cannot_divide_is_refused_once(self):
        for arguments in ("inspect small.obj small.pc2", "convert small.obj small.pc2 -o x.npz", "bake small.obj small.pc2 -o x.glb",
                          "compare small.obj small.pc2 --each", "compare small.obj small.pc2 --shard 1/2",
                          "compare small.obj small.pc2 --errors x.npz", "compare small.obj small.pc2 --truth 2",
                          "audit small.obj small.pc2 --errors x.npz", "audit face.glb", "audit --sample bumps",
                          "sample small.obj small.pc2 --times 1 --shard 1/2 -o x.npy",
                          "sample small.obj small.pc2 --times 1 -o -", "sample small.obj - --times 1 -o x.npy",
                          "compare small.obj small.pc2 --nonsense"):
            with self.subTest(arguments=arguments):
                run = self.run_program(arguments, 3)
                self.assertEqual(run.returncode, 2, run.stderr)
                self.assertEqual(run.stderr.count("chronormal " + arguments.split()[0] + ":"), 1, run.stderr)
                self.assertEqual(run.stdout, "")
                self.assert_nothing_is_left()

    def test_help_and_version_are_printed_once(self):
        self.assertRegex(self.run_program("--version", 3).stdout, r"\Achronormal [0-9.]+ with MPI\n\Z")
        self.assertEqual(self.run_program("compare --help", 3).stdout, self.run_program("compare --help").stdout)

    def test_commands_that_ranks_do_not_divide_run_on_one_rank(self):
        alone = self.run_program("inspect small.obj small.pc2")
        run = self.run_program("inspect small.obj small.pc2", 1)
        self.assertEqual((run.returncode, run.stdout), (0, alone.stdout))

    def test_mpi_is_not_started_without_mpirun(self):
        broken = {**os.environ, "OMPI_MCA_pml": "none", "OMPI_MCA_ess": "none"}  # MPI_Init() fails with these settings
        command = [PROGRAM] + "compare small.obj small.pc2 --json --no-times".split()
        run = subprocess.run(command, capture_output=True, text=True, timeout=60, env=broken)
        self.assertEqual((run.returncode, run.stderr), (0, ""))

    def test_an_error_of_one_rank_ends_all_with_its_number_and_its_exit_code(self):
        for arguments in ("compare large.obj broken.pc2 --samples 2 --schemes linear -o x.txt",
                          "sample large.obj broken.pc2 --times keys -o x.npy",
                          "sample large.obj broken.pc2 --times 145:1:150 -o x_%d.ply"):
            with self.subTest(arguments=arguments):
                run = self.run_program(arguments, 3)
                self.assertEqual(run.returncode, 3, run.stderr)
                self.assertRegex(run.stderr, r"chronormal (compare|sample): rank 2: broken.pc2")
                self.assertEqual(run.stderr.count("chronormal"), 1, run.stderr)
                self.assert_nothing_is_left()

    def test_a_file_that_ends_early_is_an_error_said_once(self):
        with open("large.pc2", "rb") as whole, open("short.pc2", "wb") as short:
            short.write(whole.read(1000000))
        self.addCleanup(os.remove, "short.pc2")
        run = self.run_program("audit large.obj short.pc2", 4)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertEqual(run.stderr.count("short.pc2"), 1, run.stderr)

    def begin_long_run(self, cache):
        """Starts a run on three ranks that writes two gigabytes. Returns as soon as all ranks are writing."""
        arguments = f"sample large.obj {cache} --times 0:0.033:149 -q -o long.npy"
        run = subprocess.Popen(MPIRUN + ["3", PROGRAM] + arguments.split(), stderr=subprocess.PIPE, stdout=subprocess.PIPE,
                               text=True)
        self.addCleanup(lambda: run.poll() is None and run.kill())
        last_row = 3 * 40000 * 4 * 4516 * 2 // 3  # byte at which the rows of the last rank begin
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline and run.poll() is None:
            for name in os.listdir("."):
                if name.startswith(".chronormal") and os.path.getsize(name) > last_row:
                    return run
            time.sleep(0.01)
        self.fail("the run did not begin: " + run.communicate()[1])

    def test_a_rank_that_is_killed_ends_the_run_and_leaves_nothing(self):
        for victim in range(3):
            with self.subTest(victim=victim):
                run = self.begin_long_run("large.pc2")
                with open(f"/proc/{run.pid}/task/{run.pid}/children") as file:
                    process, = [int(child) for child in file.read().split() if is_rank(child, victim)]
                os.kill(process, signal.SIGKILL)
                errors = run.communicate(timeout=60)[1]
                self.assertEqual(run.returncode, 128 + signal.SIGKILL, errors)
                self.assertRegex(errors, rf"process rank {victim} .* exited on signal 9")
                self.assertNotIn("chronormal", errors)
                self.assert_nothing_is_left()

    def test_a_run_that_is_interrupted_leaves_nothing(self):
        run = self.begin_long_run("large.pc2")
        run.send_signal(signal.SIGINT)
        run.communicate(timeout=60)
        self.assertNotEqual(run.returncode, 0)
        self.assert_nothing_is_left()

    def test_a_file_that_is_cut_while_it_is_read_ends_the_run_and_leaves_nothing(self):
        with open("large.pc2", "rb") as whole, open("cut.pc2", "wb") as cut:
            cut.write(whole.read())
        self.before.append("cut.pc2")
        self.before.sort()
        run = self.begin_long_run("cut.pc2")
        os.truncate("cut.pc2", 1000000)
        errors = run.communicate(timeout=60)[1]
        self.assertEqual(run.returncode, 1, errors)
        self.assertRegex(errors, "rank [012]: cut.pc2: another program has shortened the file")
        self.assertEqual(errors.count("chronormal"), 1, errors)
        self.assert_nothing_is_left()
        os.remove("cut.pc2")

    def test_a_full_disk_ends_the_run_and_leaves_nothing(self):
        for output in ("x.npy", "x.npz", "x_%d.ply"):
            with self.subTest(output=output):
                mpirun = " ".join(MPIRUN + ["3", PROGRAM])
                script = (f"mount -t tmpfs -o size=20m none {self.id()} && {{ {mpirun} sample large.obj large.pc2 "
                          f"--times keys -o {self.id()}/{output}; echo exit code $?; ls -A {self.id()}; }}")
                os.mkdir(self.id())
                self.addCleanup(lambda: os.path.isdir(self.id()) and os.rmdir(self.id()))
                run = subprocess.run(["unshare", "--map-root-user", "--mount", "sh", "-c", script], capture_output=True,
                                     text=True, timeout=120)
                os.rmdir(self.id())
                self.assertEqual(run.stdout, "exit code 1\n", run.stderr)
                self.assertRegex(run.stderr, "chronormal sample: rank [012]: .*No space left on device")
                self.assertEqual(run.stderr.count("No space"), 1, run.stderr)

    def test_a_rank_without_memory_says_so_with_its_number(self):
        # The limit on memory leaves room for MPI, which takes some hundred megabytes of address space. The files are as
        # sparse as the program accepts.
        count = 40000000
        with open("huge.ply", "wb") as file:
            file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n"
                       "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n".encode())
            file.write(bytes(12 * count // 90))
            file.seek(12 * count - 12 * count // 90, os.SEEK_CUR)
            file.write(struct.pack("<Biii", 3, 0, 1, 2))
        with open("huge.pc2", "wb") as file:
            file.write(b"POINTCACHE2\0" + struct.pack("<iiffi", 1, count, 0, 1, 3))
            file.write(bytes(3 * 12 * count // 90))
            file.truncate(32 + 3 * 12 * count)
        self.addCleanup(os.remove, "huge.ply")
        self.addCleanup(os.remove, "huge.pc2")
        self.before = sorted(os.listdir("."))
        script = f"ulimit -v 1200000; exec {PROGRAM} sample huge.ply huge.pc2 --times 0,1,2 -o x.npy"
        run = subprocess.run(MPIRUN + ["2", "bash", "-c", script], capture_output=True, text=True, timeout=120)
        self.assertEqual(run.returncode, 1, run.stderr)
        self.assertRegex(run.stderr, "chronormal: rank [01]: out of memory")
        self.assert_nothing_is_left()


if __name__ == "__main__":
    unittest.main()
