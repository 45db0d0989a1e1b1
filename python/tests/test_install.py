"""Tests the package as users install it: a wheel, made by CMake, in a virtual environment.

CHRONORMAL_BUILD names a build folder with the libraries; without it this test is skipped, since it would compile
all of them.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import venv
from pathlib import Path

PYTHON = Path(__file__).resolve().parent.parent


@unittest.skipUnless(os.environ.get("CHRONORMAL_BUILD"), "CHRONORMAL_BUILD names no build folder")
class InstallTest(unittest.TestCase):
    def test_pip_makes_a_wheel_that_works_where_it_is_installed(self):
        with tempfile.TemporaryDirectory() as folder:
            environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
            pip = ["-m", "pip", "--disable-pip-version-check", "--no-input"]
            source = Path(folder, "source")  # a copy of the source, since pip builds in the folder of the source
            shutil.copytree(PYTHON, source / "python", ignore=shutil.ignore_patterns("build", "*.egg-info"))
            for name in ("CMakeLists.txt", "LICENSE"):
                shutil.copy(PYTHON.parent / name, source)
            subprocess.run([sys.executable, *pip, "wheel", "--quiet", "--no-build-isolation", "--no-deps", "--no-index",
                            "-w", folder, source / "python"], env=environment, check=True)
            (wheel,) = Path(folder).glob("chronormal-*.whl")
            self.assertRegex(wheel.name, r"^chronormal-[0-9.]+-cp3[0-9]+-cp3[0-9]+-linux_")
            place = Path(folder, "venv")
            venv.create(place, system_site_packages=True, with_pip=False)
            interpreter = place / "bin" / "python"
            subprocess.run([interpreter, *pip, "install", "--quiet", "--no-index", "--no-deps", wheel], env=environment,
                           check=True)
            script = ("import chronormal as cn; m = cn.read(sample='twist'); print(cn.__file__); "
                      "print(cn.curves(*m.positions, m.faces).unit_normals(0.5).shape)")
            output = subprocess.run([interpreter, "-c", script], env=environment, check=True, capture_output=True,
                                    text=True, cwd=folder).stdout
            self.assertIn(str(place), output)
            self.assertIn("(7700, 3)", output)
            for name in ("_chronormal.pyi", "py.typed", "LICENSE"):
                self.assertTrue(list(place.glob(f"lib/python3*/site-packages/chronormal/{name}")), name)


if __name__ == "__main__":
    unittest.main()
