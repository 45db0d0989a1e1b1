"""Runs a recipe of Conan 2 with replacements for the classes of Conan that the recipes in packaging/conan/ use.

    conan_stand_in.py RECIPE ARCHIVE VERSION FOLDER OPTION=VALUE...

Debian's libraries replace Conan's packages. FOLDER has the sources and the build that tests/dist/vcpkg.cmake leaves, so
files are not compiled twice. The script writes the package to FOLDER/package. It then builds the test_package of the
recipe, as package_info() describes, and runs it.
"""

import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tarfile
import types
from collections import defaultdict
from pathlib import Path

import yaml

ROOT = Path(__file__).resolve().parents[2]
ASKED = (ROOT / "cmake/product.cmake").read_text()


class Settings(types.SimpleNamespace):
    """The settings os, arch, compiler and build_type of this machine."""


class Component:
    def __init__(self):
        self.libs, self.system_libs, self.requires, self.properties = [], [], [], {}

    def set_property(self, name, value):
        self.properties[name] = value


class CppInfo(Component):
    def __init__(self):
        super().__init__()
        self.components = defaultdict(Component)


class ConanFile:
    def __init__(self, folder):
        self.requirements_made, self.cpp_info, self.folder = [], CppInfo(), Path(folder)
        self.settings = Settings(os="Linux", arch="x86_64", compiler="gcc", build_type="Release")

    def requires(self, reference):
        if not re.fullmatch(r"[a-z0-9_]+/(\d[\w.]*|\[[^\]]+\])", reference):
            sys.exit(f"{reference} is no reference to a package")
        self.requirements_made.append(reference.split("/")[0])

    def run(self, command, env=None):
        subprocess.run(command, shell=True, check=True)


def cmake_layout(conanfile, src_folder="."):
    conanfile.source_folder = conanfile.folder / "source" / src_folder
    conanfile.build_folder = conanfile.folder / "build"
    conanfile.package_folder = conanfile.folder / "package"
    conanfile.cpp = types.SimpleNamespace(build=types.SimpleNamespace(bindir=str(conanfile.build_folder)))


class CMakeToolchain:
    def __init__(self, conanfile):
        self.conanfile, self.cache_variables = conanfile, {}

    def generate(self):
        self.conanfile.cache_variables = self.cache_variables


class CMakeDeps:
    """Makes the files that find_package() reads, under the names that the project looks for."""

    def __init__(self, conanfile):
        self.conanfile, self.properties = conanfile, defaultdict(dict)

    def set_property(self, package, name, value):
        self.properties[package][name] = value

    def generate(self):
        for package in self.conanfile.requirements_made:
            names = self.properties[package]
            asks = re.search(rf"find_package\({names['cmake_file_name']}\b", ASKED)
            if not asks or names["cmake_target_name"] not in ASKED:
                sys.exit(f"the project asks for no {names} of {package}")
        # The recipe does not name the packages that only the program needs, nor the thread library, which comes with
        # the system.
        asked = {name for name in re.findall(r"find_package\((\w+)", ASKED)} - {"MPI", "CLI11", "fmt", "Threads"}
        given = {names["cmake_file_name"] for names in self.properties.values()}
        if asked != given:
            sys.exit(f"the project asks for {asked}, and the recipe names {given}")
        self.conanfile.names = self.properties


class CMake:
    def __init__(self, conanfile):
        self.conanfile = conanfile

    @staticmethod
    def cmake(*arguments):
        subprocess.run(["cmake", *arguments], check=True, stdout=subprocess.DEVNULL)

    def configure(self):
        values = {True: "ON", False: "OFF"}
        options = [f"-D{name}={values.get(value, value)}" for name, value in self.conanfile.cache_variables.items()]
        self.cmake("-G", "Ninja", "-S", self.conanfile.source_folder, "-B", self.conanfile.build_folder,
                   "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_INSTALL_LIBDIR=lib", *options)
        cache = (Path(self.conanfile.build_folder) / "CMakeCache.txt").read_text()
        for name in self.conanfile.cache_variables:
            if name.startswith("CHRONORMAL_") and f"\n{name}:BOOL=" not in cache:
                sys.exit(f"the project has no option {name}")

    def build(self):
        self.cmake("--build", self.conanfile.build_folder)

    def install(self):
        self.cmake("--install", self.conanfile.build_folder, "--prefix", self.conanfile.package_folder)


def get(conanfile, url, sha256, strip_root):
    name = Path(conanfile.archive).name
    if not url.endswith("/" + name) or not strip_root:
        sys.exit(f"{url} is not {name}")
    with tarfile.open(conanfile.archive) as archive:
        archive.extractall(conanfile.folder / "source")
    conanfile.source_folder = conanfile.folder / "source" / name.removesuffix(".tar.gz")


def copy(conanfile, pattern, src, dst):
    Path(dst).mkdir(parents=True, exist_ok=True)
    for path in Path(src).glob(pattern):
        shutil.copy(path, dst)


def check_min_cppstd(conanfile, standard):
    if standard != 20:
        sys.exit("the project is C++20")


def module(name, **members):
    made = types.ModuleType(name)
    made.__dict__.update(members)
    sys.modules[name] = made


class ConanInvalidConfiguration(Exception):
    pass


module("conan", ConanFile=ConanFile)
module("conan.errors", ConanInvalidConfiguration=ConanInvalidConfiguration)
module("conan.tools")
module("conan.tools.build", check_min_cppstd=check_min_cppstd, can_run=lambda conanfile: True)
module("conan.tools.cmake", CMake=CMake, CMakeDeps=CMakeDeps, CMakeToolchain=CMakeToolchain, cmake_layout=cmake_layout)
module("conan.tools.files", copy=copy, get=get, rmdir=lambda conanfile, path: shutil.rmtree(path, ignore_errors=True))


def recipe_in(path, folder):
    spec = importlib.util.spec_from_file_location("recipe", path)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    (kind,) = ConanFile.__subclasses__()[-1:]
    return kind(folder)


def config_of(recipe):
    """Returns the file that CMakeDeps generates from package_info() for users of the package."""
    lines, targets = [], {}
    for name, component in recipe.cpp_info.components.items():
        targets[name] = component.properties["cmake_target_name"]
    for name, component in recipe.cpp_info.components.items():
        links = list(component.system_libs)
        for required in component.requires:
            if required in targets:
                links.append(targets[required])
                continue
            package = required.split("::")[0]
            if package not in recipe.requirements_made:
                sys.exit(f"{package} is no requirement")
            names = recipe.names[package]
            lines.append(f"find_package({names['cmake_file_name']} REQUIRED)")
            links.append(names["cmake_target_name"])
        (library,) = component.libs
        lines += [f"add_library({targets[name]} STATIC IMPORTED)",
                  f"set_target_properties({targets[name]} PROPERTIES",
                  f"  IMPORTED_LOCATION {recipe.package_folder}/lib/lib{library}.a",
                  f"  INTERFACE_INCLUDE_DIRECTORIES {recipe.package_folder}/include",
                  f"  INTERFACE_LINK_LIBRARIES \"{';'.join(links)}\")"]
    return "\n".join(lines) + "\n"


def main(folder_of_recipe, archive, version, folder, *options):
    folder_of_recipe, folder = Path(folder_of_recipe), Path(folder)
    recipe = recipe_in(folder_of_recipe / "conanfile.py", folder)
    recipe.archive, recipe.version = archive, version
    recipe.conan_data = yaml.safe_load((folder_of_recipe / "conandata.yml").read_text())
    recipe.options = types.SimpleNamespace(**recipe.default_options)
    for option in options:
        name, value = option.split("=")
        if json.loads(value) not in recipe.__class__.options[name]:
            sys.exit(f"{name} cannot be {value}")
        setattr(recipe.options, name, json.loads(value))
    recipe.layout()
    recipe.requirements()
    recipe.validate()
    recipe.source()
    recipe.generate()
    recipe.build()
    shutil.rmtree(recipe.package_folder, ignore_errors=True)
    recipe.package()
    recipe.package_info()
    if "find_package(Threads" in ASKED and "pthread" not in recipe.cpp_info.components["core"].system_libs:
        sys.exit("the project asks for threads, and the recipe does not link them")
    if not (recipe.package_folder / "licenses/LICENSE").is_file():
        sys.exit("the package has no licence")

    test = recipe_in(folder_of_recipe / "test_package/conanfile.py", folder / "test")
    test.tested_reference_str = f"{recipe.name}/{version}"
    test.requirements()
    test.layout()
    test.source_folder = folder_of_recipe / "test_package"
    test.build_folder.mkdir(parents=True, exist_ok=True)
    name = recipe.cpp_info.properties["cmake_file_name"]
    (test.build_folder / f"{name}-config.cmake").write_text(config_of(recipe))
    test.cache_variables = {f"{name}_DIR": test.build_folder}
    test.build()
    test.test()


if __name__ == "__main__":
    main(*sys.argv[1:])
