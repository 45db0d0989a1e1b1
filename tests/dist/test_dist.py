"""Tests the files that ./run dist makes: programs run on a bare system, and all files match the lists beside them.

The variable CHRONORMAL_DIST names the folder of the results. Each skipped test prints its reason. A missing file is an
error.
"""

import hashlib
import json
import math
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tarfile
import tempfile
import unittest
import zipfile
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import yaml

ROOT = Path(__file__).resolve().parents[2]
DIST = Path(os.environ.get("CHRONORMAL_DIST", ROOT / "dist"))
VERSION = re.search(r"project\(chronormal VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
SEED = int(os.environ.get("CHRONORMAL_SEED", "20261126"))
# The system libraries that the wheels use. PEP 513 and its successors allow all of them in a manylinux wheel.
MANYLINUX = {"libc.so.6", "libm.so.6", "libstdc++.so.6", "libgcc_s.so.1", "libpthread.so.0", "ld-linux-x86-64.so.2"}


def run(*command, codes=(0,), **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode not in codes:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def artefact(pattern):
    found = sorted(DIST.glob(pattern))
    if len(found) != 1:
        raise AssertionError(f"{DIST} has {len(found)} files {pattern}")
    return found[0]


def random_glb(draw):
    """Returns the bytes of a GLB: a bumpy sheet with one or two targets, all with normals, and an animation of the
    weights."""
    side, targets, keys = draw.randint(3, 12), draw.randint(1, 2), draw.randint(2, 4)
    arrays, views, accessors = b"", [], []

    def add(values, code, kind, width, component):
        nonlocal arrays
        views.append({"buffer": 0, "byteOffset": len(arrays), "byteLength": len(values) * struct.calcsize(code)})
        count = len(values) // width
        accessor = {"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind}
        if kind == "VEC3" or width == 1 and code == "f":
            columns = [values[i::width] for i in range(width)]
            accessor |= {"min": [min(column) for column in columns], "max": [max(column) for column in columns]}
        accessors.append(accessor)
        arrays += struct.pack(f"<{len(values)}{code}", *values)
        arrays += bytes(-len(arrays) % 4)
        return len(accessors) - 1

    def float32(value):
        return struct.unpack("<f", struct.pack("<f", value))[0]

    def vectors(scale, flat):
        return [float32((corner if flat else 0) + scale * draw.uniform(-1, 1)) for y in range(side) for x in range(side)
                for corner in (x, y, 0)]

    def unit_vectors():
        result = []
        for _ in range(side * side):
            x, y = draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5)
            result += map(float32, (x, y, math.sqrt(1 - x * x - y * y)))
        return result

    corners = [a for y in range(side - 1) for x in range(side - 1)
               for a in (y * side + x, y * side + x + 1, (y + 1) * side + x, y * side + x + 1, (y + 1) * side + x + 1,
                         (y + 1) * side + x)]
    def attributes(positions, normals):
        return {"POSITION": add(positions, "f", "VEC3", 3, 5126), "NORMAL": add(normals, "f", "VEC3", 3, 5126)}

    primitive = {"attributes": attributes(vectors(0.2, True), unit_vectors()),
                 "indices": add(corners, "H", "SCALAR", 1, 5123),
                 "targets": [attributes(vectors(0.8, False), vectors(0.3, False)) for _ in range(targets)]}
    times = add([float32(0.5 * key) for key in range(keys)], "f", "SCALAR", 1, 5126)
    weights = add([float32(draw.uniform(0, 1)) for _ in range(keys * targets)], "f", "SCALAR", 1, 5126)
    text = json.dumps({
        "asset": {"version": "2.0"}, "buffers": [{"byteLength": len(arrays)}], "bufferViews": views,
        "accessors": accessors,
        "meshes": [{"primitives": [primitive]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0,
        "animations": [{"samplers": [{"input": times, "output": weights}],
                        "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}],
    }).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(arrays), 0x004E4942) + arrays
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


class Unpacked(unittest.TestCase):
    """Tests that unpack an artefact of the release into a separate folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class Program(Unpacked):
    def setUp(self):
        super().setUp()
        with tarfile.open(artefact("chronormal-*-linux-x86_64.tar.gz")) as archive:
            archive.extractall(self.folder)
        (self.unpacked,) = self.folder.iterdir()
        self.root = self.folder / "root"
        self.root.mkdir()
        shutil.copy(self.unpacked / "chronormal", self.root)

    def alone(self, *arguments, codes=(0,)):
        """Runs the program in a folder that contains only the program and its files: no libraries, /proc, /dev or
        /tmp."""
        enter = [*([] if os.geteuid() == 0 else ["unshare", "--map-root-user"]), "chroot"]
        if subprocess.run([*enter, "/", "true"], capture_output=True).returncode != 0:
            self.skipTest("chroot is refused: it takes root, or the right to be root in a namespace")
        return run(*enter, self.root, "/chronormal", *arguments, codes=codes, env={"PATH": os.environ["PATH"]})

    def test_needs_no_library_and_no_loader(self):
        self.assertNotIn("NEEDED", run("objdump", "-p", self.root / "chronormal"))
        self.assertNotIn("INTERP", run("readelf", "-lW", self.root / "chronormal"))
        # The program is position-independent, so the system may load it at any address.
        self.assertIn("DYN", run("readelf", "-hW", self.root / "chronormal"))

    def test_runs_in_an_empty_root(self):
        self.assertEqual(self.alone("--version").split()[1], VERSION)
        (self.root / "face.glb").write_bytes(random_glb(random.Random(SEED)))
        audit = json.loads(self.alone("audit", "face.glb", "--json"))
        self.alone("bake", "face.glb", "-o", "right.glb")
        self.alone("report", "face.glb", "-o", "face.html")
        self.assertIn("<!doctype html>", (self.root / "face.html").read_text().lower())
        again = json.loads(self.alone("audit", "right.glb", "--json"))
        self.assertGreater(audit["mean_degrees"], 2 * again["mean_degrees"])
        files = sorted(path.name for path in self.root.iterdir())
        self.assertEqual(files, ["chronormal", "face.glb", "face.html", "right.glb"])

    def test_writes_the_bytes_of_the_program_in_the_debian_package(self):
        run("dpkg-deb", "-x", artefact("*.deb"), self.folder / "deb")
        draw = random.Random(SEED)
        print(f"seed {SEED} ", end="", file=sys.stderr)
        for case in range(12):
            with self.subTest(case=case):
                (self.root / "in.glb").write_bytes(random_glb(draw))
                options = draw.choice([[], ["--for", "three"], ["--encode", "exact"], ["--tolerance", "0.1"]])
                bake = ["bake", "in.glb", "--force", *options, "-o"]
                said = self.alone(*bake, "static.glb", codes=(0, 4))  # exit code 4: the error exceeds the tolerance
                other = run(self.folder / "deb/usr/bin/chronormal", *bake, "other.glb", codes=(0, 4), cwd=self.root)
                self.assertEqual(said.replace("static.glb", "other.glb"), other)
                written = [(self.root / name).read_bytes() for name in ("static.glb", "other.glb")]
                self.assertEqual(written[0], written[1], options)

    def test_says_whose_work_is_inside(self):
        texts = {path.name: path.read_text() for path in (self.unpacked / "THIRD_PARTY").iterdir()}
        for name, words in {"zlib": "Gailly", "draco": "Apache", "highway": "Apache", "meshoptimizer": "Kapoulkine",
                            "pugixml": "Kapoulkine", "glibc": "Lesser General Public License", "fmtlib": "Zverovich",
                            "cli11": "Schreiner", "nlohmann-json3": "Lohmann", "three": "three.js",
                            "uplot": "Sorokin"}.items():
            self.assertIn(words, texts[name])
        self.assertIn("MIT License", (self.unpacked / "LICENSE").read_text())


class Source(Unpacked):
    def test_has_the_files_of_the_commit_and_the_same_bytes_again(self):
        archive = artefact(f"chronormal-{VERSION}.tar.gz")
        with tarfile.open(archive) as opened:
            files = sorted(member.name for member in opened if not member.isdir())
        tracked = run("git", "ls-tree", "-r", "--name-only", "-z", "HEAD", cwd=ROOT).split("\0")[:-1]
        self.assertEqual(files, sorted(f"chronormal-{VERSION}/{name}" for name in tracked))
        # Makes the archive again in a clone of the repository. The two archives must have the same bytes.
        copy = self.folder / "clone"
        run("git", "clone", "-q", ROOT, copy)
        run(copy / "run", "dist", "source")
        self.assertEqual((copy / "dist" / archive.name).read_bytes(), archive.read_bytes())

    def test_is_what_the_debian_package_was_built_of(self):
        built = ROOT / "build/source" / f"chronormal-{VERSION}"
        self.assertEqual(run(built / "build/program/chronormal", "--version").split()[1], VERSION)
        with tarfile.open(artefact(f"chronormal-{VERSION}.tar.gz")) as opened:
            for member in opened:
                if member.isfile():
                    here = (ROOT / "build/source" / member.name).read_bytes()
                    self.assertEqual(opened.extractfile(member).read(), here, member.name)


class Deb(Unpacked):
    def setUp(self):
        super().setUp()
        self.deb = artefact("*.deb")
        run("dpkg-deb", "-x", self.deb, self.folder)

    def test_runs_and_finds_its_page(self):
        program = self.folder / "usr/bin/chronormal"
        self.assertEqual(run(program, "--version").split()[1], VERSION)
        run(program, "report", "--sample", "twist", "-o", self.folder / "twist.html")

    def test_names_its_version_and_what_it_needs(self):
        self.assertEqual(run("dpkg-deb", "-f", self.deb, "Version").strip(), VERSION)
        needs = run("dpkg-deb", "-f", self.deb, "Depends")
        for name in re.findall(r"NEEDED\s+(\S+)", run("objdump", "-p", self.folder / "usr/bin/chronormal")):
            file = os.path.basename(os.path.realpath(f"/lib/x86_64-linux-gnu/{name}"))
            self.assertIn(run("dpkg", "-S", f"*/x86_64-linux-gnu/{file}").split(":")[0], needs)


class Others(Unpacked):
    """Tests the programs for systems that this machine can only emulate. tests/machines runs these programs."""

    def test_windows_gets_programs_that_need_only_windows(self):
        with zipfile.ZipFile(artefact("chronormal-*-windows-x64.zip")) as archive:
            archive.extractall(self.folder)
        (unpacked,) = self.folder.iterdir()
        for name in "chronormal.exe", "chronormal_c.dll":
            needed = re.findall(r"DLL Name: (\S+)", run("x86_64-w64-mingw32-objdump", "-p", unpacked / name))
            self.assertGreater(len(needed), 0)
            self.assertLessEqual({dll.lower() for dll in needed},
                                 {"kernel32.dll", "msvcrt.dll", "shell32.dll", "user32.dll", "advapi32.dll"}, name)
        self.assertTrue((unpacked / "chronormal_c.h").exists() and (unpacked / "chronormal_c.dll.a").exists())
        self.check_inside(unpacked / "chronormal.exe", "mingw-w64")

    def check_inside(self, program, library):
        """Checks that the page of reports is in the program, since the archive has no file for it. `library` is the
        library for C."""
        page = (ROOT / "build/share/chronormal/report.html").read_bytes()
        self.assertTrue(page in program.read_bytes(), f"{program.name} has no page for reports")
        licences = {path.name for path in (program.parent / "THIRD_PARTY").iterdir()}
        self.assertLessEqual({library, "zlib", "draco", "highway", "meshoptimizer", "pugixml", "three"}, licences)

    def test_arm_gets_a_program_that_needs_no_library(self):
        with tarfile.open(artefact("chronormal-*-linux-arm64.tar.gz")) as archive:
            archive.extractall(self.folder)
        (unpacked,) = self.folder.iterdir()
        text = run("readelf", "-hldW", unpacked / "chronormal")
        self.assertIn("AArch64", text)
        self.assertNotIn("NEEDED", text)
        self.assertNotIn("INTERP", text)
        self.check_inside(unpacked / "chronormal", "cross-toolchain-base")


class Blender(Unpacked):
    """Tests the zip of the add-on, which tests/viewers/blender_addon.test.mjs uses in Blender."""

    def setUp(self):
        super().setUp()
        with zipfile.ZipFile(artefact(f"chronormal-blender-{VERSION}.zip")) as archive:
            self.names = set(archive.namelist())
            archive.extractall(self.folder)
        self.addon = self.folder / "chronormal_blender"

    def test_is_one_folder_with_the_files_of_the_repository(self):
        for path in (ROOT / "blender").iterdir():
            if path.suffix in (".py", ".toml"):
                self.assertEqual((self.addon / path.name).read_bytes(), path.read_bytes(), path.name)
        outside = {name for name in self.names if not name.startswith("chronormal_blender/")}
        self.assertEqual(outside, set())
        self.assertFalse([name for name in self.names if "__pycache__" in name])
        self.assertEqual((self.addon / "LICENSE").read_bytes(), (ROOT / "LICENSE").read_bytes())

    def test_has_the_released_program_and_whose_work_is_in_it(self):
        with tarfile.open(artefact("chronormal-*-linux-x86_64.tar.gz")) as archive:
            archive.extractall(self.folder / "program")
        (released,) = (self.folder / "program").iterdir()
        shipped = self.addon / "bin/linux-x64"
        self.assertEqual((shipped / "chronormal").read_bytes(), (released / "chronormal").read_bytes())
        licences = {path.name for path in (released / "THIRD_PARTY").iterdir()}
        self.assertEqual({path.name for path in (shipped / "THIRD_PARTY").iterdir()}, licences)
        (shipped / "chronormal").chmod(0o755)
        self.assertEqual(run(shipped / "chronormal", "--version").split()[1], VERSION)

    def test_has_the_programs_of_other_systems(self):
        for system, name in ("linux-arm64", "chronormal"), ("windows-x64", "chronormal.exe"):
            self.assertTrue((self.addon / "bin" / system / name).exists(), system)
            self.assertGreater(len(list((self.addon / "bin" / system / "THIRD_PARTY").iterdir())), 5)

    def test_has_the_version_of_the_project(self):
        self.assertIn(f'version = "{VERSION}"\n', (self.addon / "blender_manifest.toml").read_text())
        self.assertIn(f'"version": ({VERSION.replace(".", ", ")})', (self.addon / "__init__.py").read_text())


class Links(HTMLParser):
    """Collects the links of a page, the files that it loads, and its anchors."""

    def __init__(self, path):
        super().__init__()
        self.links, self.loaded, self.places = [], [], set()
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (name == "name" and tag == "a"):
                self.places.add(value)
            elif name in ("href", "src") and value:
                (self.links if tag == "a" else self.loaded).append(value)


class Site(Unpacked):
    """Tests the site: its pages and the reference of the headers, as files on the disk."""

    def setUp(self):
        super().setUp()
        with tarfile.open(artefact(f"chronormal-{VERSION}-site.tar.gz")) as archive:
            archive.extractall(self.folder)
        (self.site,) = self.folder.iterdir()

    def test_links_lead_somewhere_and_nothing_is_loaded_from_elsewhere(self):
        pages = {path: Links(path) for path in self.site.rglob("*.html")}
        self.assertGreater(len(pages), 100)
        for path, page in pages.items():
            for link in page.loaded:
                self.assertNotRegex(link, r"^(\w+:)?/", path)
            for link in [*page.links, *page.loaded]:
                if re.match(r"\w+:", link):
                    continue
                name, _, place = unquote(link).partition("#")
                name = name.partition("?")[0]
                target = (path.parent / name).resolve() if name else path
                self.assertTrue(target.is_file(), f"{path} links to {link}")
                if place and target in pages and place != "top":
                    self.assertIn(place, pages[target].places, f"{path} links to {link}")
        for path in self.site.rglob("*.css"):
            self.assertNotRegex(path.read_text(), r"@import url\(/|url\(.?https?:", path)

    def test_has_every_page_and_header(self):
        for path in [*ROOT.glob("docs/*.md"), *ROOT.glob("docs/decisions/*.md")]:
            self.assertTrue((self.site / path.relative_to(ROOT)).with_suffix(".html").is_file(), path)
        headers = {re.sub("_8h(_source)?$", "", path.stem) for path in (self.site / "api").glob("*_8h.html")}
        for path in (ROOT / "include").rglob("*.h"):
            self.assertIn(path.stem.replace("_", "__"), {name.split("_2")[-1] for name in headers}, path)

    def test_can_be_searched_without_a_server(self):
        self.assertTrue((self.site / "searchindex.js").read_text().startswith("Search.setIndex("))
        self.assertIn("meshlet", (self.site / "searchindex.js").read_text())
        classes = (self.site / "api/search").glob("classes_*.js")
        self.assertTrue(any("MeshNormals" in path.read_text() for path in classes))

    def test_follows_a_system_that_is_dark(self):
        for name in ("index.html", "docs/cli.html"):
            after = (self.site / name).read_text().partition("prefers-color-scheme: dark")[2]
            self.assertIn("--color-background-primary", after.partition("</style>")[0])

    def test_is_not_made_where_a_link_or_a_comment_is_wrong(self):
        wrong = {"docs/cli.md": "[nothing](nothing.md)", "include/chronormal/core/views.h": "/// \\param nothing"}
        for file, line in wrong.items():
            copy = self.folder / Path(file).name
            run("git", "clone", "-q", "--depth=1", f"file://{ROOT}", copy)
            with (copy / file).open("a") as opened:
                opened.write(f"\n{line}\n" + "void f(int a);\n" * file.endswith(".h"))
            with self.assertRaisesRegex(AssertionError, "nothing"):
                run(copy / "tools/site/make", copy / "made")


class Wheel(Unpacked):
    def test_is_for_other_linuxes_by_what_it_needs(self):
        wheel = artefact("*.whl")
        python = f"cp{sys.version_info.major}{sys.version_info.minor}"
        glibc = run("getconf", "GNU_LIBC_VERSION").split()[1]
        system = f"manylinux_{glibc.replace('.', '_')}_x86_64"
        self.assertEqual(wheel.name, f"chronormal-{VERSION}-{python}-{python}-{system}.whl")
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(self.folder)
        (module,) = self.folder.rglob("*.so")
        self.assertLessEqual(set(re.findall(r"NEEDED\s+(\S+)", run("objdump", "-p", module))), MANYLINUX)
        used = re.findall(r"GLIBC_([0-9.]+)", run("objdump", "-T", module))
        newest = max(tuple(map(int, version.split("."))) for version in used)
        self.assertLessEqual(newest, tuple(map(int, glibc.split("."))))
        self.assertIn("zlib", {path.name for path in (self.folder / "chronormal/THIRD_PARTY").iterdir()})

    def test_computes_in_a_fresh_environment(self):
        # The virtual environment can also use the packages of the system, one of which is NumPy.
        run(sys.executable, "-m", "venv", "--system-site-packages", self.folder / "venv")
        python = self.folder / "venv/bin/python"
        run(python, "-m", "pip", "install", "-q", "--no-index", "--no-deps", artefact("*.whl"))
        home = run(python, "-c", "import chronormal; print(chronormal.__file__)", cwd=self.folder).strip()
        self.assertTrue(home.startswith(str(self.folder)), home)
        environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1", "CHRONORMAL_BUILD": str(self.folder),
                                    "CHRONORMAL_PROGRAM": str(ROOT / "build/dist/chronormal")}
        for name in ("test_curves.py", "test_paths.py", "test_process.py"):
            run(python, ROOT / "python/tests" / name, cwd=self.folder, env=environment)


class Lists(Unpacked):
    def setUp(self):
        super().setUp()
        self.list = json.loads(artefact("*.spdx.json").read_text())

    def linked_with(self, pattern, relation):
        """Returns the names and versions of the components that the SPDX list has for an artefact."""
        packages = {package["SPDXID"]: package for package in self.list["packages"]}
        (this,) = [key for key, package in packages.items() if package.get("packageFileName") == artefact(pattern).name]
        linked = [packages[link["relatedSpdxElement"]] for link in self.list["relationships"]
                  if (link["spdxElementId"], link["relationshipType"]) == (this, relation)]
        return {package["name"]: package["versionInfo"] for package in linked}

    def test_sums_are_right_sorted_and_of_all_files(self):
        run("sha256sum", "--check", "--strict", "--quiet", "SHA256SUMS", cwd=DIST)
        names = [line.split("  ", 1)[1] for line in (DIST / "SHA256SUMS").read_text().splitlines()]
        self.assertEqual(names, sorted(path.name for path in DIST.iterdir() if path.name != "SHA256SUMS"))

    def test_components_are_listed_as_spdx_2_3_has_it(self):
        whole = self.list
        head = (whole["spdxVersion"], whole["dataLicense"], whole["SPDXID"])
        self.assertEqual(head, ("SPDX-2.3", "CC0-1.0", "SPDXRef-DOCUMENT"))
        self.assertRegex(whole["documentNamespace"], r"^urn:uuid:[0-9a-f-]{36}$")
        self.assertRegex(whole["creationInfo"]["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertRegex(whole["creationInfo"]["creators"][0], r"^(Tool|Person|Organization): ")
        names = {whole["SPDXID"]}
        licences = {"MIT", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD-3-Clause", "Zlib", "NCSA", "PSF-2.0",
                    "LGPL-2.1-or-later", "GPL-3.0-or-later WITH GCC-exception-3.1", "ZPL-2.1"}
        for package in whole["packages"]:
            self.assertRegex(package["SPDXID"], r"^SPDXRef-[A-Za-z0-9.-]+$")
            self.assertNotIn(package["SPDXID"], names)
            names.add(package["SPDXID"])
            self.assertTrue(package["name"] and package["versionInfo"])
            self.assertEqual((package["downloadLocation"], package["filesAnalyzed"]), ("NOASSERTION", False))
            declared = re.split(r" (?:AND|OR) ", re.sub("[()]", "", package["licenseDeclared"]))
            self.assertLessEqual(set(declared), licences)
            for reference in package.get("externalRefs", []):
                kind = (reference["referenceCategory"], reference["referenceType"])
                self.assertEqual(kind, ("PACKAGE-MANAGER", "purl"))
                purl = r"^pkg:(deb/debian|npm)/[a-z0-9.+-]+@[A-Za-z0-9.:~%-]+(\?|$)"
                self.assertRegex(reference["referenceLocator"], purl)
        for link in whole["relationships"]:
            self.assertLessEqual({link["spdxElementId"], link["relatedSpdxElement"]}, names)
            self.assertIn(link["relationshipType"], {"DESCRIBES", "STATIC_LINK", "DYNAMIC_LINK"})

    def test_every_file_is_described_by_its_checksum(self):
        listed = {package["packageFileName"]: package["checksums"] for package in self.list["packages"]
                  if "packageFileName" in package}
        made = {path.name: [{"algorithm": "SHA256", "checksumValue": hashlib.sha256(path.read_bytes()).hexdigest()}]
                for path in DIST.iterdir() if not path.name.endswith(("SHA256SUMS", ".spdx.json"))}
        self.assertEqual(listed, made)

    def test_the_static_program_has_what_its_own_strings_say(self):
        inside = self.linked_with("*-linux-x86_64.tar.gz", "STATIC_LINK")
        self.assertEqual(self.linked_with("*-linux-x86_64.tar.gz", "DYNAMIC_LINK"), {})
        with tarfile.open(artefact("*-linux-x86_64.tar.gz")) as archive:
            program = archive.extractfile(next(m for m in archive if m.name.endswith("/chronormal"))).read()
        zlib = re.search(rb" inflate ([0-9.]+) Copyright", program).group(1).decode()
        self.assertIn(zlib, inside["zlib"])
        libraries = {"draco", "highway", "meshoptimizer", "pugixml", "zlib", "fmtlib", "cli11", "nlohmann-json3"}
        self.assertLessEqual(libraries | {"glibc", "gcc-12", "three", "uplot"}, set(inside))
        self.assertNotIn("onetbb", inside)

    def test_the_debian_package_needs_what_it_is_said_to_link(self):
        shared = self.linked_with("*.deb", "DYNAMIC_LINK")
        depends = re.split(r"[,|] ?", run("dpkg-deb", "-f", artefact("*.deb"), "Depends").strip())
        names = [re.split(r"[ :]", name)[0] for name in depends]
        sources = {run("dpkg-query", "-W", "-f", "${source:Package}", name) for name in names}
        self.assertEqual(set(shared), sources)
        for name in sources:
            self.assertNotIn(name, self.linked_with("*.deb", "STATIC_LINK"))


class Packaging(Unpacked):
    """Tests the vcpkg port and the Conan recipe, with replacements for vcpkg and Conan."""

    def setUp(self):
        super().setUp()
        self.archive = artefact(f"chronormal-{VERSION}.tar.gz")
        # The port and the recipe share one build folder, which is emptied if the archive of sources changes. Files of
        # another archive could have the same times, so the build would not notice the difference.
        self.build = ROOT / "build/packaging"
        known = self.build / "archive"
        if not known.exists() or known.read_bytes() != self.archive.read_bytes():
            shutil.rmtree(self.build, ignore_errors=True)
            self.build.mkdir(parents=True)
            shutil.copyfile(self.archive, known)
        # Users get the feature io by default. By default, these tests leave the feature out, since compiling it takes
        # minutes.
        self.with_io = os.environ.get("CHRONORMAL_PACKAGING_IO") == "1"

    def test_versions_are_that_of_the_project(self):
        self.assertEqual(json.loads((ROOT / "packaging/vcpkg/chronormal/vcpkg.json").read_text())["version"], VERSION)
        for name, key in {"conandata.yml": "sources", "config.yml": "versions"}.items():
            self.assertEqual(list(yaml.safe_load((ROOT / "packaging/conan" / name).read_text())[key]), [VERSION])

    def test_a_foreign_project_uses_what_the_port_installs(self):
        run("cmake", f"-DARCHIVE={self.archive}", f"-DPORT_FOLDER={ROOT}/packaging/vcpkg/chronormal",
            f"-DVERSION={VERSION}", f"-DFOLDER={self.build}", f"-DFEATURES={'io' if self.with_io else ''}",
            "-P", ROOT / "tests/dist/vcpkg.cmake")
        moved = self.folder / "moved"
        shutil.copytree(self.build / "packages", moved)
        run("cmake", "-G", "Ninja", "-S", ROOT / "tests/install", "-B", self.folder / "build", "-DFROM=port",
            f"-DSOURCE={ROOT}", f"-DVERSION={VERSION}", f"-DCMAKE_PREFIX_PATH={moved}")
        run("cmake", "--build", self.folder / "build")
        self.assertIn("normal of vertex 0", run(self.folder / "build/core"))

    def test_the_recipe_packages_what_its_test_package_uses(self):
        said = run(sys.executable, ROOT / "tests/dist/conan_stand_in.py", ROOT / "packaging/conan", self.archive,
                   VERSION, self.build, f"with_io={'true' if self.with_io else 'false'}")
        self.assertIn("-0.707107 0.707107", said)


class Workflow(unittest.TestCase):
    def test_calls_the_script_that_the_project_runs(self):
        job = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())["jobs"]["debian-12"]
        self.assertEqual(job["container"], "debian:12")
        script = job["steps"][-1]["run"]
        self.assertTrue(os.access(ROOT / script, os.X_OK))


if __name__ == "__main__":
    unittest.main(verbosity=2)
