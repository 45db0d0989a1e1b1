"""Packs the Blender add-on into a zip that Blender can install, together with the given programs.

    blender_addon.py OUT.zip [SYSTEM=FOLDER]...

SYSTEM is one of the systems that blender/program.py knows, such as linux-x64, and FOLDER has the program chronormal
for that system, and its licences in LICENSE and THIRD_PARTY if there are any. Equal files give equal bytes;
SOURCE_DATE_EPOCH is the time of all files.
"""

import os
import sys
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NAME = "chronormal_blender"  # the name of the Python package, and the id of the extension


def files(programs: dict[str, Path]) -> dict[str, Path]:
    """Returns the files of the zip, keyed by their names in the zip."""
    found = {path.name: path for path in (ROOT / "blender").iterdir() if path.suffix in (".py", ".toml")}
    found["LICENSE"] = ROOT / "LICENSE"
    for system, folder in programs.items():
        for path in folder.rglob("*"):
            inner = path.relative_to(folder)
            if path.is_file() and inner.parts[0] in ("chronormal", "chronormal.exe", "LICENSE", "THIRD_PARTY"):
                found[f"bin/{system}/{inner.as_posix()}"] = path
        if not any(name.startswith(f"bin/{system}/chronormal") for name in found):
            raise SystemExit(f"{folder} has no program chronormal")
    return found


def pack(out: Path, programs: dict[str, Path]) -> None:
    when = time.gmtime(int(os.environ.get("SOURCE_DATE_EPOCH", 315532800)))[:6]  # a zip cannot store a time before 1980
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, path in sorted(files(programs).items()):
            entry = zipfile.ZipInfo(f"{NAME}/{name}", when)
            entry.compress_type = zipfile.ZIP_DEFLATED
            is_program = name.startswith("bin/") and name.rsplit("/", 1)[-1].startswith("chronormal")
            entry.external_attr = (0o100755 if is_program else 0o100644) << 16
            archive.writestr(entry, path.read_bytes())


if __name__ == "__main__":
    pack(Path(sys.argv[1]), {system: Path(folder) for system, folder in (a.split("=", 1) for a in sys.argv[2:])})
