#!/usr/bin/env python3
"""Compares the program for another system, which an emulator runs, with the program of this machine: files, texts and
exit codes must be equal. ./test --full machines runs this script for each system.

    CHRONORMAL_PROGRAM  the program of this machine
    CHRONORMAL_OTHER    the words that start the other program: "wine build/windows/chronormal.exe"
    CHRONORMAL_BITS     the words that start the tests of equal bits (cmake/bits.cmake)
    CHRONORMAL_SYSTEM   "windows" or "arm64"
"""
import os
import pathlib
import pty
import re
import select
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = os.environ["CHRONORMAL_PROGRAM"]
OTHER = shlex.split(os.environ["CHRONORMAL_OTHER"])
BITS = shlex.split(os.environ["CHRONORMAL_BITS"])
SYSTEM = os.environ["CHRONORMAL_SYSTEM"]
WINDOWS = SYSTEM == "windows"
ENVIRONMENT = {**os.environ, "WINEDEBUG": "-all", "NO_COLOR": "", "COLUMNS": "80"}
ENVIRONMENT.pop("DISPLAY", None)

TRIANGLES = ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n")


def setUpModule():
    """Starts Wine's server before the tests. If a tested program started the server, the server would keep the pipes
    of that program open."""
    if WINDOWS:
        quiet = {"env": ENVIRONMENT, "stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL,
                 "stderr": subprocess.DEVNULL}
        subprocess.run(["wineserver", "-p"], **quiet)
        subprocess.run(["wineboot"], **quiet, check=True)
        unittest.addModuleCleanup(subprocess.run, ["wineserver", "-k"], **quiet)


def run(words, folder, **more):
    return subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env={**ENVIRONMENT, **more.pop("env", {})}, timeout=600, **more)


def fixture(folder, *arguments):
    subprocess.run([PROGRAM, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def windows_name(path):
    """Returns the Windows name of a path on this machine. Wine shows the root folder as drive Z."""
    return "Z:" + str(path).replace("/", "\\")


class Machine(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="chronormal_machine_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def check_same(self, *arguments, output=None, folder=None):
        """Runs both programs, one after the other. Compares their texts, their exit codes, and the file that they
        write."""
        results = []
        for program in ([PROGRAM], OTHER):
            ran = run([*program, *arguments], folder or self.folder)
            written = None
            if output and (self.folder / output).exists():
                written = (self.folder / output).read_bytes()
                (self.folder / output).unlink()
            results.append((ran.returncode, ran.stdout.decode(), ran.stderr.decode(), written))
        here, there = results
        self.assertEqual(here[:3], there[:3])
        if output:
            self.assertIsNotNone(here[3])
        self.assertTrue(here[3] == there[3], f"{output}: the bytes differ")
        return here

    def make_walk(self, folder=""):
        (self.folder / folder).mkdir(exist_ok=True)
        fixture(self.folder, "convert", "--sample", "twist", "-o", os.path.join(folder, "walk_%d.obj"))

    def make_targets(self):
        fixture(self.folder, "convert", "--sample", "bumps", "-o", "bumps.glb")

    def in_terminal(self, words, **more):
        """Returns what a program prints in a terminal."""
        pid, terminal = pty.fork()
        if pid == 0:
            os.chdir(self.folder)
            os.execvpe(words[0], words, {**ENVIRONMENT, "TERM": "xterm", **more})
        text, ended = b"", False
        while True:
            # Wine keeps the terminal open after the program has ended, so the loop does not wait for the end of the
            # stream.
            if not select.select([terminal], [], [], 0.5)[0]:
                if ended:
                    break
                ended = os.waitpid(pid, os.WNOHANG)[0] != 0
                continue
            try:
                part = os.read(terminal, 65536)
            except OSError:
                break
            if not part:
                break
            text += part
        os.close(terminal)
        if not ended:
            os.waitpid(pid, 0)
        # Wine's console hides the cursor, and writes blanks by erasing cells and moving the cursor. The console also
        # ends each line twice.
        shown = re.sub("\x1b\\[\\?25[lh]", "", text.decode(errors="replace"))
        return re.sub("\x1b\\[K\x1b\\[(\\d*)C", lambda move: " " * int(move[1] or 1), shown)


class Same(Machine):
    def test_bits_are_golden_on_every_instruction_set(self):
        ran = run([*BITS, "--gtest_brief=1"], self.folder)
        self.assertEqual(ran.returncode, 0, ran.stdout.decode() + ran.stderr.decode())
        print(f"\n{SYSTEM}:", ran.stdout.decode().strip().splitlines()[-1], file=sys.stderr)

    def test_help_and_version_are_the_same_text(self):
        self.check_same("--version")
        self.check_same("help", "bake")

    def test_exit_codes_and_errors_are_those_of_the_contract(self):
        for name, text in zip("ab", TRIANGLES):
            (self.folder / f"{name}.obj").write_text(text)
        (self.folder / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
        (self.folder / "folder.npz").mkdir()
        (self.folder / "empty").mkdir()
        codes = [self.check_same(*words.split())[0] for words in (
            "compare a.obj b.obj --no-times", "compare nosuch.obj", "compare a.obj --bogus", "compare a.obj bad.obj",
            "audit a.obj b.obj --tolerance 0.001", "convert a.obj b.obj -o folder.npz", "convert a.obj b.obj -o no/x.npz",
            "inspect empty", "compare", "nonsense")]
        self.assertEqual(codes, [0, 1, 2, 3, 4, 1, 1, 3, 2, 2])

    def test_normals_of_a_sequence_are_the_same_bytes(self):
        self.make_walk("in")
        for elements in "faces", "vertices", "corners":
            self.check_same("sample", "in/walk_%d.obj", "--times", "0,0.3,1", "--elements", elements, "-o", "normals.npz", output="normals.npz")
        self.check_same("compare", "in/walk_%d.obj", "--no-times", "--json")

    def test_a_baked_file_is_the_same_bytes(self):
        self.make_targets()
        self.check_same("bake", "bumps.glb", "-o", "baked.glb", output="baked.glb")
        self.check_same("audit", "bumps.glb", "--json")

    def test_a_baked_sequence_is_the_same_bytes(self):
        self.make_walk()
        self.check_same("bake", "walk_0.obj", "walk_1.obj", "-o", "walk.glb", output="walk.glb")

    def test_a_report_and_its_data_are_the_same_bytes(self):
        self.make_targets()
        for name in "report.bin", "report.html":
            self.check_same("report", "bumps.glb", "-o", name, output=name)

    def test_formats_are_written_in_the_same_bytes(self):
        self.make_walk()
        for name in "out.npz", "out.pc2", "out.mdd":
            self.check_same("convert", "walk_0.obj", "walk_1.obj", "-o", name, output=name)

    def test_an_interrupted_run_goes_on(self):
        self.make_walk()
        self.check_same("compare", "walk_0.obj", "walk_1.obj", "--no-times", "--resume", "-o", "table.txt",
                        output="table.txt")
        self.assertEqual(sorted(os.listdir(self.folder)), ["walk_0.obj", "walk_1.obj"])

    def test_names_may_have_blanks_and_letters_of_all_languages(self):
        name = "Gänge und Läufe 走"
        self.make_walk(name)
        self.check_same("convert", f"{name}/walk_%d.obj", "-o", f"{name}/Übergang ж.npz",
                        output=f"{name}/Übergang ж.npz")
        self.check_same("inspect", f"{name}/walk_[01].obj")
        self.check_same("inspect", name)
        self.check_same("inspect", f"{name}/fehlt ß.npz")

    def test_an_output_that_exists_is_kept_without_force(self):
        self.make_walk()
        (self.folder / "kept.npz").write_bytes(b"kept")
        self.assertEqual(self.check_same("convert", "walk_0.obj", "walk_1.obj", "-o", "kept.npz")[0], 1)
        self.assertEqual((self.folder / "kept.npz").read_bytes(), b"kept")
        ran = run([*OTHER, "convert", "walk_0.obj", "walk_1.obj", "--force", "-o", "kept.npz"], self.folder)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        fixture(self.folder, "convert", "walk_0.obj", "walk_1.obj", "-o", "new.npz")
        self.assertEqual((self.folder / "kept.npz").read_bytes(), (self.folder / "new.npz").read_bytes())

    def test_a_pipe_carries_the_same_bytes_both_ways(self):
        self.make_walk()
        fixture(self.folder, "convert", "walk_0.obj", "walk_1.obj", "-o", "walk.npz")
        whole = (self.folder / "walk.npz").read_bytes()
        # In binary data, the program must not treat CR, LF and Ctrl-Z as special.
        self.assertTrue(b"\x1a" in whole and b"\n" in whole)
        with open(self.folder / "walk.npz", "rb") as file:
            ran = subprocess.run([*OTHER, "inspect", "-"], stdin=file, cwd=self.folder, env=ENVIRONMENT,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        with open(self.folder / "walk.npz", "rb") as file:
            here = subprocess.run([PROGRAM, "inspect", "-"], stdin=file, cwd=self.folder, env=ENVIRONMENT,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual((ran.returncode, ran.stdout, ran.stderr), (here.returncode, here.stdout, here.stderr))
        self.assertNotIn(b"\r", ran.stdout)
        self.make_targets()
        there = run([*OTHER, "bake", "bumps.glb", "-q", "-o", "-"], self.folder).stdout
        self.assertEqual(there, run([PROGRAM, "bake", "bumps.glb", "-q", "-o", "-"], self.folder).stdout)
        self.assertGreater(len(there), 1000)

    def test_a_full_disk_is_an_error_and_leaves_nothing(self):
        disk = self.folder / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], stderr=subprocess.PIPE)
        if mounted.returncode != 0:
            self.skipTest("only root may mount a small disk: " + mounted.stderr.decode())
        try:
            self.make_walk()
            code, _, errors, _ = self.check_same("convert", "walk_0.obj", "walk_1.obj", "-o", "disk/walk.npz")
            self.assertEqual(code, 1)
            self.assertIn("No space left on device", errors)
            self.assertEqual(os.listdir(disk), [])
        finally:
            subprocess.run(["umount", disk], check=True)

    def test_a_terminal_shows_colours_unless_it_must_not(self):
        coloured = self.in_terminal([*OTHER, "inspect", "nosuch.obj"])
        self.assertIn("nosuch.obj: No such file or directory", coloured)
        self.assertIn("\x1b[1;31m", coloured)
        plain = self.in_terminal([*OTHER, "inspect", "nosuch.obj"], NO_COLOR="1")
        self.assertIn("nosuch.obj: No such file or directory", plain)
        self.assertNotIn("\x1b[1;31m", plain)
        forced = run([*OTHER, "inspect", "nosuch.obj"], self.folder, env={"CLICOLOR_FORCE": "1"})
        self.assertIn(b"\x1b[1;31m", forced.stderr)


@unittest.skipUnless(WINDOWS, "for Windows alone")
class Windows(Machine):
    @classmethod
    def setUpClass(cls):
        cls.tools = pathlib.Path(tempfile.mkdtemp(prefix="chronormal_tools_"))
        cls.addClassCleanup(shutil.rmtree, cls.tools, ignore_errors=True)
        cls.helper = cls.tools / "helper.exe"
        subprocess.run(["x86_64-w64-mingw32-gcc-posix", "-municode", "-O1", "-o", cls.helper,
                        ROOT / "tests/machines/windows_helper.c"], check=True)

    def test_a_backslash_stands_between_folders(self):
        self.make_walk("in")
        here = run([PROGRAM, "inspect", "in/walk_%d.obj"], self.folder).stdout.decode()
        for name in r"in\walk_%d.obj", r"in\walk_*.obj", r"i?\walk_[0-9].obj":
            there = run([*OTHER, "inspect", name], self.folder)
            self.assertEqual(there.returncode, 0, there.stderr)
            self.assertEqual(there.stdout.decode().splitlines()[2:], here.splitlines()[2:])
        ran = run([*OTHER, "convert", r"in\walk_%d.obj", "-o", r"in\new_%d.obj"], self.folder)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertEqual((self.folder / "in/new_1.obj").read_bytes(), (self.folder / "in/walk_1.obj").read_bytes())

    def test_a_drive_begins_a_path(self):
        self.make_walk()
        ran = run([*OTHER, "convert", windows_name(self.folder / "walk_%d.obj"), "-o",
                   windows_name(self.folder / "out.npz")], "/")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        fixture(self.folder, "convert", "walk_0.obj", "walk_1.obj", "-o", "here.npz")
        self.assertEqual((self.folder / "out.npz").read_bytes(), (self.folder / "here.npz").read_bytes())

    def test_letters_match_in_either_case(self):
        self.make_walk()
        self.assertEqual(run([*OTHER, "inspect", "WALK_*.OBJ"], self.folder).returncode, 0)

    def test_nul_is_a_device(self):
        self.make_walk()
        self.assertEqual(run([*OTHER, "convert", "walk_0.obj", "walk_1.obj", "-o", "NUL"], self.folder).returncode, 2)
        self.assertEqual(run([*OTHER, "inspect", "NUL"], self.folder).returncode, 1)

    def test_a_file_in_use_is_not_replaced(self):
        self.make_walk()
        (self.folder / "held.npz").write_bytes(b"held")
        holder = subprocess.Popen(["wine", self.helper, "hold", "held.npz"], cwd=self.folder, env=ENVIRONMENT,
                                  stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        try:
            self.assertEqual(holder.stdout.readline().strip(), b"held")
            ran = run([*OTHER, "convert", "walk_0.obj", "walk_1.obj", "--force", "-o", "held.npz"], self.folder)
            self.assertEqual(ran.returncode, 1)
            self.assertIn(b"held.npz: another program is using this file", ran.stderr)
        finally:
            holder.communicate(b"\n")
        self.assertEqual((self.folder / "held.npz").read_bytes(), b"held")
        self.assertEqual(sorted(os.listdir(self.folder)), ["held.npz", "walk_0.obj", "walk_1.obj"])

    def test_ctrl_c_removes_temporary_files(self):
        self.make_walk()
        # Only a program that has a console receives keys, so a helper starts the program in a console and presses
        # Ctrl-C.
        shown = self.in_terminal(["wine", self.helper, "break", windows_name(pathlib.Path(OTHER[-1]).resolve()), "sample",
                                  "walk_0.obj", "walk_1.obj", "--times", "0:0.00001:1", "-q", "-o", "normals.npz"])
        self.assertIn("C000013A", shown)
        self.assertIn("chronormal: interrupted (Ctrl-C)", shown)
        self.assertEqual(sorted(os.listdir(self.folder)), ["walk_0.obj", "walk_1.obj"])

    def test_the_library_for_c_is_a_dll(self):
        build = pathlib.Path(OTHER[-1]).resolve().parent
        program = self.tools / "frame_loop.exe"
        subprocess.run(["x86_64-w64-mingw32-gcc-posix", "-o", program, "-I", ROOT / "include",
                        ROOT / "examples/frame_loop.c", build / "chronormal_c.dll.a"], check=True)
        shutil.copy(build / "chronormal_c.dll", self.tools)
        ran = run(["wine", program], self.folder)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        # Vertex 2 rises by t. The normals of its two triangles are (0, -t, 1) and (-t, 0, 1), whose sum is (-t, -t, 2).
        self.assertEqual([re.sub(r"-(?=0\.0+\b)", "", line) for line in ran.stdout.decode().split("\r\n")],
                         ["t = 0.0: the normal of vertex 2 is (0.000, 0.000, 1.000)",
                          "t = 0.5: the normal of vertex 2 is (-0.236, -0.236, 0.943)",
                          "t = 1.0: the normal of vertex 2 is (-0.408, -0.408, 0.816)", ""])


@unittest.skipIf(WINDOWS, "signals are those of POSIX systems")
class Posix(Machine):
    def test_a_signal_removes_temporary_files(self):
        self.make_walk()
        process = subprocess.Popen([*OTHER, "sample", "walk_0.obj", "walk_1.obj", "--times", "0:0.00001:1", "-o", "normals.npz"],
                                   cwd=self.folder, stderr=subprocess.PIPE, env=ENVIRONMENT)
        while process.poll() is None and not list(self.folder.glob(".chronormal-*")):
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        errors = process.communicate()[1]
        self.assertIn(process.returncode, (-signal.SIGINT, 128 + signal.SIGINT))
        self.assertIn(b"interrupted (SIGINT)", errors)
        self.assertEqual(sorted(os.listdir(self.folder)), ["walk_0.obj", "walk_1.obj"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
