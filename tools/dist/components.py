"""Finds the components that are compiled into the artefacts of ./run dist, from the builds themselves.

    components.py licences ARTEFACT FOLDER    copies Debian's texts of the licence of each component of an artefact
    components.py sbom VERSION FOLDER         prints a list of all files in FOLDER and their components, as SPDX 2.3

A component is a Debian source package or an npm package. Its code is in an artefact if the compiler read one of its
headers for the artefact (Ninja records the names of headers). A shared library is a component if the linker lists it
as needed.
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import uuid
import zipfile
from datetime import datetime, timezone
from pathlib import Path
from urllib.parse import quote

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
SOURCES = BUILD / "wasm-sources"

LIBRARIES = ["chronormal", "chronormal_io"]
# The artefacts of a release by their kinds. Each has the pattern of its file in dist/, its build folder, its CMake
# targets, and its purpose in terms of SPDX.
ARTEFACTS = {
    "arm64": ("chronormal-*-linux-arm64.tar.gz", "arm64", [*LIBRARIES, "chronormal_cli"], "APPLICATION"),
    "program": ("chronormal-*-linux-*.tar.gz", "dist", [*LIBRARIES, "chronormal_cli"], "APPLICATION"),
    "windows": ("chronormal-*-windows-x64.zip", "windows", [*LIBRARIES, "chronormal_cli", "chronormal_c"], "APPLICATION"),
    "wheel": ("chronormal-*.whl", "dist", [*LIBRARIES, "_chronormal"], "LIBRARY"),
    "deb": ("chronormal_*.deb", "source/*/build/program", [*LIBRARIES, "chronormal_cli", "chronormal_c"], "INSTALL"),
    "npm": ("chronormal-*.tgz", "wasm", [*LIBRARIES, "chronormal_cli"], "LIBRARY"),
    "page": ("chronormal-*.html", "wasm", [*LIBRARIES, "chronormal_cli"], "APPLICATION"),
    "blender": ("chronormal-blender-*.zip", None, [], "APPLICATION"),
    "header": ("chronormal_core.h", None, [], "SOURCE"),
    "core": ("chronormal_core.cpp", None, [], "SOURCE"),
    "site": ("chronormal-*-site.tar.gz", None, [], "ARCHIVE"),
    "source": ("chronormal-*.tar.gz", None, [], "SOURCE"),
}
# The artefacts that contain the components of the pages of web/.
WITH_PAGE = ("program", "arm64", "windows", "deb", "npm", "page")

# The artefacts whose programs the add-on for Blender contains. The keys are folders in the add-on. All other folders
# have the programs of the artefact "program".
BLENDER_PROGRAMS = {"linux-arm64": "arm64", "windows-x64": "windows"}

# The names that SPDX has for Debian's names of licences; and the licences of packages whose `copyright` names no
# licence for all files.
SPDX_NAMES = {
    "Apache-2": "Apache-2.0",
    "Apache-2.0": "Apache-2.0",
    "BSD-3-clause": "BSD-3-Clause",
    "BSD-3-Clause+CLA": "BSD-3-Clause",
    "Expat": "MIT",
    "Expat with embedded exception": "MIT",
    "Expat or Apache": "MIT OR Apache-2.0",
    "ZPL-2.1": "ZPL-2.1",
    "Zlib": "Zlib",
}
SPDX_LICENCES = {
    "gcc-12": "GPL-3.0-or-later WITH GCC-exception-3.1",
    "gcc-12-cross": "GPL-3.0-or-later WITH GCC-exception-3.1",
    "gcc-mingw-w64": "GPL-3.0-or-later WITH GCC-exception-3.1",
    "glibc": "LGPL-2.1-or-later",
    "cross-toolchain-base": "LGPL-2.1-or-later",  # glibc for another machine
    "emscripten": "(MIT OR NCSA) AND (Apache-2.0 WITH LLVM-exception)",  # includes musl and libc++
    "llvm-toolchain-14": "Apache-2.0 WITH LLVM-exception",
    "python3.11": "PSF-2.0",
}
NO_CODE = {"linux-libc-dev", "linux-libc-dev-arm64-cross"}  # the packages have only the numbers of system calls


def run(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


def owners(paths):
    """Returns the binary packages that own the files with these paths or patterns of paths."""
    if not paths:
        return set()
    found = subprocess.run(["dpkg", "-S", *sorted(paths)], capture_output=True, text=True)
    if found.returncode != 0:
        sys.exit(f"components.py: a linked library belongs to no Debian package: {found.stderr}")
    packages = {owner.strip() for line in found.stdout.splitlines() if not line.startswith("diversion")
                for owner in line.split(": ")[0].split(",")}
    return {package for package in packages if package.split(":")[0] not in NO_CODE}


class Component:
    """A Debian source package or an npm package, with its name, version, licence, URL, and the file that names its
    authors."""

    def __init__(self, name, version, copyright):
        self.name, self.version, self.copyright = name, version, copyright
        self.purl = f"pkg:deb/debian/{name}@{quote(version, safe=':~')}?arch=source&distro=bookworm"
        self.licence = SPDX_LICENCES.get(name)
        if self.licence is None:
            files = re.search(r"^Files:\s*\*.*?^License:\s*(.+?)$", Path(copyright).read_text(), re.M | re.S)
            self.licence = SPDX_NAMES.get(files.group(1).strip()) if files else None
        if self.licence is None:
            sys.exit(f"components.py: {copyright} names no licence for {name} that this script knows; add it to SPDX_NAMES")

    @staticmethod
    def of_package(package):
        name, version = run("dpkg-query", "-W", "-f", "${source:Package} ${source:Version}", package).split()
        return Component(name, version, f"/usr/share/doc/{package.split(':')[0]}/copyright")

    @staticmethod
    def of_sources(folder):
        name, version = (run("dpkg-parsechangelog", "-l", folder / "debian/changelog", "-S", field).strip()
                         for field in ("Source", "Version"))
        return Component(name, version, folder / "debian/copyright")

    @staticmethod
    def of_npm(name):
        locked = json.loads((ROOT / "web/package-lock.json").read_text())["packages"][f"node_modules/{name}"]
        component = object.__new__(Component)
        component.name, component.version, component.licence = name, locked["version"], locked["license"]
        component.purl = f"pkg:npm/{name}@{component.version}"
        component.copyright = ROOT / "web/node_modules" / name / "LICENSE"
        return component


def headers_of(build, targets):
    """Returns the headers outside of the project that the compiler read for the given CMake targets of a build."""
    headers, wanted = set(), False
    for line in run("ninja", "-C", build, "-t", "deps").splitlines():
        if ": #deps" in line:
            wanted = any(line.startswith(f"CMakeFiles/{target}.dir/") for target in targets)
        elif wanted and line.strip():
            path = Path(os.path.realpath(build / line.strip()))
            if not path.is_relative_to(ROOT) or path.is_relative_to(SOURCES):
                headers.add(path)
    return headers


def shared_libraries(artefact):
    """Returns patterns of the paths of the shared libraries that the binaries in an archive need."""
    needed = set()
    with tempfile.TemporaryDirectory() as folder:
        if artefact.suffix == ".deb":
            run("dpkg-deb", "-x", artefact, folder)
        else:
            shutil.unpack_archive(artefact, folder, "zip" if artefact.suffix == ".whl" else "gztar")
        inside = [path for path in Path(folder).rglob("*") if path.is_file() and not path.is_symlink()]
        for path in inside:
            with open(path, "rb") as file:
                if file.read(4) == b"\x7fELF":
                    needed.update(re.findall(r"NEEDED\s+(\S+)", run("objdump", "-p", path)))
        needed -= {path.name for path in Path(folder).rglob("*.so*")}
    known = dict(re.findall(r"^\s*(\S+) \(libc6,x86-64.*=> (\S+)$", run("/sbin/ldconfig", "-p"), re.M))
    paths = [Path(os.path.realpath(known[name])) for name in needed]
    # The folders /lib and /usr/lib are the same, so the pattern fits both.
    return {f"*/{path.parent.name}/{path.name}" for path in paths}


def components_of(kind, artefact=None):
    """Returns two lists: the components that are compiled in, and the components of the shared libraries that are
    needed."""
    if kind == "blender":
        with zipfile.ZipFile(artefact) as archive:
            systems = {name.split("/")[2] for name in archive.namelist() if "/bin/" in name}
        programs = (components_of(BLENDER_PROGRAMS.get(system, "program"))[0] for system in sorted(systems))
        return list({component.name: component for program in programs for component in program}.values()), []
    build, targets = ARTEFACTS[kind][1:3]
    if build is None:
        return [], []
    inside, folders = set(), set()
    (folder,) = BUILD.glob(build)
    for header in headers_of(folder, targets):
        if header.is_relative_to(SOURCES):
            folders.add(SOURCES / header.relative_to(SOURCES).parts[0])
        else:
            inside.add(str(header))
    components = {}
    for component in [*map(Component.of_sources, sorted(folders)), *map(Component.of_package, sorted(owners(inside)))]:
        components.setdefault(component.name, component)
    shared = {}
    if kind in ("wheel", "deb") and artefact is not None:
        for component in map(Component.of_package, sorted(owners(shared_libraries(artefact)))):
            shared.setdefault(component.name, component)
    if kind in WITH_PAGE:
        for name in json.loads((ROOT / "web/package.json").read_text())["dependencies"]:
            if name != "esbuild":  # esbuild writes the pages, but is not part of them
                components[name] = Component.of_npm(name)
    return ([component for name, component in sorted(components.items()) if name not in shared],
            [component for name, component in sorted(shared.items())])


def copy_licences(kind, folder):
    folder = Path(folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for component in components_of(kind)[0]:
        shutil.copyfile(component.copyright, folder / component.name)


def spdx_id(text):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", text)


def sbom(version, folder):
    packages, relations, made = {}, [], hashlib.sha256()
    lists = (".spdx.json", ".spdx.json.new", "SHA256SUMS")
    left = {path for path in Path(folder).iterdir() if not path.name.endswith(lists)}
    for kind, (pattern, _, _, purpose) in ARTEFACTS.items():
        for path in sorted(path for path in left if path.match(pattern)):
            left.remove(path)
            digest = hashlib.sha256(path.read_bytes()).hexdigest()
            made.update(digest.encode())
            this = spdx_id(f"File-{path.name}")
            packages[this] = {
                "SPDXID": this, "name": "chronormal", "versionInfo": version, "packageFileName": path.name,
                "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "primaryPackagePurpose": purpose,
                "licenseConcluded": "NOASSERTION", "licenseDeclared": "MIT", "copyrightText": "NOASSERTION",
                "checksums": [{"algorithm": "SHA256", "checksumValue": digest}],
            }
            relations.append(("SPDXRef-DOCUMENT", "DESCRIBES", this))
            for components, relation in zip(components_of(kind, path), ("STATIC_LINK", "DYNAMIC_LINK")):
                for component in components:
                    that = spdx_id(f"Component-{component.name}")
                    packages[that] = {
                        "SPDXID": that, "name": component.name, "versionInfo": component.version,
                        "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
                        "licenseConcluded": "NOASSERTION", "licenseDeclared": component.licence,
                        "copyrightText": "NOASSERTION",
                        "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                                          "referenceLocator": component.purl}],
                    }
                    relations.append((this, relation, that))
    if left:
        sys.exit(f"components.py: dist has files of a kind that this script does not know: {', '.join(sorted(path.name for path in left))}")
    time = datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), timezone.utc)
    json.dump({
        "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"chronormal-{version}",
        "documentNamespace": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_OID, made.hexdigest())}",
        "creationInfo": {"created": time.strftime("%Y-%m-%dT%H:%M:%SZ"),
                         "creators": ["Tool: chronormal tools/dist/components.py"]},
        "packages": list(packages.values()),
        "relationships": [{"spdxElementId": a, "relationshipType": kind, "relatedSpdxElement": b}
                          for a, kind, b in relations],
    }, sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    {"licences": copy_licences, "sbom": sbom}[sys.argv[1]](*sys.argv[2:])
