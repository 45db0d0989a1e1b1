"""Builds the Python package with the CMake files of the project.

    pip install --no-build-isolation ./python     # in a venv with --system-site-packages, or where NumPy and pybind11 are

CHRONORMAL_BUILD names a build folder of the project, configured with CHRONORMAL_PYTHON=ON, whose libraries are used.
Without CHRONORMAL_BUILD, the library is compiled in the folder of setuptools. The licences of libraries that are
compiled in are packed from THIRD_PARTY in the build folder.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent.parent


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        build = os.environ.get("CHRONORMAL_BUILD")
        if build is None:
            build = Path(self.build_temp).resolve()
            options = ["-DCMAKE_BUILD_TYPE=Release", "-DCHRONORMAL_PYTHON=ON", "-DCHRONORMAL_PROGRAM=OFF",
                       "-DCHRONORMAL_C=OFF", "-DCHRONORMAL_INSTALL=OFF", f"-DPython_EXECUTABLE={sys.executable}"]
            generator = ["-G", "Ninja"] if shutil.which("ninja") else []
            subprocess.run(["cmake", "-S", ROOT, "-B", build, *generator, *options], check=True)
        # Pass a number of jobs, since make without a number starts every compiler at once.
        subprocess.run(["cmake", "--build", build, "--target", "_chronormal", "--parallel", str(os.cpu_count() or 1)], check=True)
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "LICENSE", target.parent)
        if Path(build, "THIRD_PARTY").is_dir():
            shutil.copytree(Path(build, "THIRD_PARTY"), target.parent / "THIRD_PARTY", dirs_exist_ok=True)
        shutil.copy(next(Path(build, "python", "chronormal").glob("_chronormal*.so")), target)


VERSION = re.search(r"project\(chronormal VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)

setup(
    name="chronormal",
    version=VERSION,
    description="Exact normals of triangle meshes that deform",
    license="MIT",
    packages=["chronormal"],
    package_data={"chronormal": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("chronormal._chronormal", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
    python_requires=">=3.9",
    install_requires=["numpy"],
    zip_safe=False,
)
